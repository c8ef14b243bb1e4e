// Writing volumes of labels as grids of .vdb files.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>

#include "io/openvdb/grid_map.h"
#include "io/openvdb/label_names.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "isoshell/error.h"
#include "isoshell/io/label_file.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse_use(const std::string& path, const std::string& what) {
  throw Error(ErrorCode::usage, "write", path + ": " + what);
}

void check_size(const std::string& path, const LabelVolume& volume) {
  const auto& size = volume.size_vox;
  if (*std::min_element(size.begin(), size.end()) < 1) refuse_use(path, "the volume has no voxels");
  const double voxels = double(size[0]) * size[1] * size[2];
  if (voxels != double(volume.labels.size()))
    refuse_use(path, "the volume has " + std::to_string(volume.labels.size()) + " labels for " +
                         std::to_string(size[0]) + " x " + std::to_string(size[1]) + " x " + std::to_string(size[2]) +
                         " voxels; give one a voxel");
}

openvdb::math::Transform::Ptr transform_of(const std::string& path, const LabelVolume& volume) {
  try {
    if (is_invertible(lattice_map(volume.step_world, volume.origin_world)))
      return transform_of(volume.step_world, volume.origin_world);
  } catch (const openvdb::Exception&) {
  }
  refuse_use(path, "a .vdb file cannot hold steps that span so little or no volume; scale them up");
}

/// Active voxels are those of the array, from (0, 0, 0) on.
VdbIntGrid::Ptr grid_of(const LabelVolume& volume, const std::string& name) {
  auto grid = new_vdb_grid<VdbIntGrid>(name.c_str(), volume.background);
  const auto& size = volume.size_vox;
  std::array<int64_t, 3> leaves{};
  for (size_t i = 0; i < 3; ++i) leaves[i] = (int64_t(size[i]) + 7) / 8;
  const auto leaf_at = [&](int64_t l) {
    const int64_t z = l % leaves[2], y = l / leaves[2] % leaves[1], x = l / leaves[2] / leaves[1];
    return Voxel{int32_t(x), int32_t(y), int32_t(z)};
  };
  add_vdb_leaves(*grid, leaves[0] * leaves[1] * leaves[2], leaf_at, [&](int64_t l, int32_t* values) {
    const Voxel at = leaf_at(l);
    LeafMask mask{};
    for (int n = 0; n < 512; ++n) {
      const int64_t x = 8 * int64_t(at.x) + (n >> 6), y = 8 * int64_t(at.y) + (n >> 3 & 7),
                    z = 8 * int64_t(at.z) + (n & 7);
      if (x >= size[0] || y >= size[1] || z >= size[2]) continue;
      values[n] = volume.labels[size_t((z * size[1] + y) * size[0] + x)];
      mask.word[n >> 6] |= uint64_t(1) << (n & 63);
    }
    return mask;
  });
  for (const RegionName& region : volume.names)
    grid->insertMeta(label_key(region.label), openvdb::StringMetadata(region.name));
  return grid;
}

}  // namespace

void write_labels(const std::string& path, const LabelVolume& volume, const LabelWriteOptions& options) {
  check_size(path, volume);
  initialize_openvdb();
  const openvdb::math::Transform::Ptr transform = transform_of(path, volume);
  const auto make = [&]() -> openvdb::GridBase::Ptr {
    VdbIntGrid::Ptr grid = grid_of(volume, options.grid);
    grid->setTransform(transform);
    return grid;
  };
  write_vdb_file(path, {make}, {}, options.overwrite);
}

}  // namespace isoshell
