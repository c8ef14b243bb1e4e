// Level sets and shells as OpenVDB knows them. A level set is a float grid in world units, whose inactive voxels are
// the background, negative inside, and whose tree has tiles where a node has one value.
#include <openvdb/tools/Prune.h>
#include <openvdb/tools/SignedFloodFill.h>

#include "core/copy_product.h"
#include "io/openvdb/grid_map.h"
#include "io/openvdb/shell_values.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/vdb_format.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/openvdb.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw Error(ErrorCode::usage, "write", std::string(what) + " must have a value for each active voxel");
}

VdbFloatGrid::Ptr grid_of(const LevelSet& level_set, const LevelSetWriteOptions& options) {
  const double voxel = level_set.frame.voxel_size;
  const View<const float> distance_vox = level_set.distance_vox.view();
  const IndexSpace index = level_set.frame.index_space();
  auto grid = make_voxel_grid<VdbFloatGrid>(
      options.name.c_str(), float(level_set.band_vox * voxel), level_set.voxels,
      [&](int64_t, int, int64_t i) { return float(double(distance_vox[i]) * voxel); }, index.first);
  openvdb::tools::signedFloodFill(grid->tree());
  openvdb::tools::pruneLevelSet(grid->tree());
  const WorldPoint& zero = index.zero_world;
  grid->setTransform(transform_of_scales(openvdb::Vec3d(voxel), {zero.x, zero.y, zero.z}));
  grid->setGridClass(openvdb::GRID_LEVEL_SET);
  grid->setSaveFloatAsHalf(options.as_half);
  grid->setCreator(vdb_format::kCreator);
  return grid;
}

void check(const LevelSet& level_set) {
  if (level_set.distance_vox.size() != level_set.voxels.voxel_count()) refuse("LevelSet::distance_vox");
}

}  // namespace

void save_level_set(const std::string& path, const LevelSet& level_set_anywhere, const LevelSetWriteOptions& options) {
  const OnHost<LevelSet> level_set(level_set_anywhere);
  check(*level_set);
  check_level_set_write(*level_set, options);
  initialize_openvdb();
  openvdb::MetaMap meta;
  meta.insertMeta(vdb_format::kKeyCreator, openvdb::StringMetadata(vdb_format::kCreator));
  write_vdb_file(path, {[&] { return grid_of(*level_set, options); }}, meta, options.overwrite);
}

openvdb::FloatGrid::Ptr to_openvdb(const LevelSet& level_set_anywhere, const LevelSetWriteOptions& options) {
  const OnHost<LevelSet> level_set(level_set_anywhere);
  check(*level_set);
  check_level_set_write(*level_set, options);
  initialize_openvdb();
  return grid_of(*level_set, options);
}

openvdb::GridPtrVec to_openvdb(const Shell& shell_anywhere, const LatticeFrame& frame) {
  const OnHost<Shell> on_host(shell_anywhere);
  const Shell& shell = *on_host;
  if (shell.closest_site.size() != shell.voxels.voxel_count()) refuse("Shell::closest_site");
  if (shell.distance_sq_vox.size() != shell.voxels.voxel_count()) refuse("Shell::distance_sq_vox");
  initialize_openvdb();
  openvdb::GridPtrVec grids{
      make_voxel_grid<VdbFloatGrid>(kShellDistance, shell_background(shell, frame), shell.voxels,
                                    shell_distances(shell, frame)),
      make_voxel_grid<VdbIntGrid>(vdb_format::kClosestSite, -1, shell.voxels, closest_sites(shell)),
      make_voxel_grid<VdbIntGrid>(vdb_format::kDistanceSq, -1, shell.voxels, squared_distances(shell))};
  for (const openvdb::GridBase::Ptr& grid : grids) {
    grid->setTransform(lattice_transform(frame));
    grid->setCreator(vdb_format::kCreator);
  }
  return grids;
}

}  // namespace isoshell
