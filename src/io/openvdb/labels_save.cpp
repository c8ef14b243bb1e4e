// Writing volumes of labels as grids of .vdb files.
#include <openvdb/openvdb.h>

#include <algorithm>
#include <array>

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

/// As scales and a translation where the steps are along the axes: files hold these of voxels of any size.
openvdb::math::MapBase::Ptr map_of(const LabelVolume& volume) {
  using openvdb::math::MapBase;
  const auto& [x, y, z] = volume.step_world;
  const openvdb::Vec3d origin(volume.origin_world.x, volume.origin_world.y, volume.origin_world.z);
  if (x.y == 0 && x.z == 0 && y.x == 0 && y.z == 0 && z.x == 0 && z.y == 0)
    return std::make_shared<openvdb::math::ScaleTranslateMap>(openvdb::Vec3d(x.x, y.y, z.z), origin);
  openvdb::math::Mat4d rows = openvdb::math::Mat4d::identity();  // of where the axes go, then the origin
  rows.setRow(0, {x.x, x.y, x.z, 0});
  rows.setRow(1, {y.x, y.y, y.z, 0});
  rows.setRow(2, {z.x, z.y, z.z, 0});
  rows.setRow(3, {origin.x(), origin.y(), origin.z(), 1});
  return std::make_shared<openvdb::math::AffineMap>(rows);
}

openvdb::math::Transform::Ptr transform_of(const std::string& path, const LabelVolume& volume) {
  try {
    return std::make_shared<openvdb::math::Transform>(map_of(volume));
  } catch (const openvdb::Exception&) {
    refuse_use(path, "a .vdb file cannot hold steps that span so little or no volume; scale them up");
  }
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
