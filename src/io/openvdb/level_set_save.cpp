// Level sets as OpenVDB knows them: a float grid in world units, whose inactive voxels are the background, negative
// inside, and whose tree has tiles where a node has one value.
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include "core/copy_product.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/vdb_format.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell {
namespace {

openvdb::GridBase::Ptr grid_of(const LevelSet& level_set, const LevelSetWriteOptions& options) {
  const double voxel = level_set.frame.voxel_size;
  const View<const float> distance_vox = level_set.distance_vox.view();
  auto grid =
      make_voxel_grid<VdbFloatGrid>(options.name.c_str(), float(level_set.band_vox * voxel), level_set.voxels,
                                    [&](int64_t, int, int64_t i) { return float(double(distance_vox[i]) * voxel); });
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::tools::pruneLevelSet(grid->tree());
  grid->setTransform(lattice_transform(level_set.frame));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setSaveFloatAsHalf(options.as_half);
  grid->setCreator(vdb_format::kCreator);
  return grid;
}

}  // namespace

void save_level_set(const std::string& path, const LevelSet& level_set_anywhere, const LevelSetWriteOptions& options) {
  const OnHost<LevelSet> level_set_here(level_set_anywhere);
  const LevelSet& level_set = *level_set_here;
  if (level_set.distance_vox.size() != level_set.voxels.voxel_count())
    throw Error(ErrorCode::usage, "write", "LevelSet::distance_vox must have a value for each active voxel");
  initialize_openvdb();
  openvdb::MetaMap meta;
  meta.insertMeta(vdb_format::kKeyCreator, openvdb::StringMetadata(vdb_format::kCreator));
  write_vdb_file(path, {[&] { return grid_of(level_set, options); }}, meta, options.overwrite);
}

}  // namespace isoshell
