// Velocity fields: a grid of vectors of a .vdb file or from memory, checked once, then sampled.
#include "isoshell/io/velocity_vdb.h"

#include <openvdb/openvdb.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "geometry/world_vector.h"
#include "io/openvdb/dense_lattice.h"
#include "io/openvdb/field_grid.h"
#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/vdb_cursor.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr FieldKind kVelocities{"Tree_vec3s_5_4_3", "vectors",
                                "velocities are a Vec3SGrid, of three floats a voxel in world units a frame",
                                "the velocities"};

VdbVec3fGrid::Ptr grid_of(const std::array<DenseVolume, 3>& components, const std::string& name) {
  return dense_grid<VdbVec3fGrid>(components[0], name, [&](int64_t i, int64_t j, int64_t k, openvdb::Vec3f& value) {
    for (int axis = 0; axis < 3; ++axis) value[axis] = value_of(components[size_t(axis)], i, j, k);
    return !(std::isnan(value.x()) || std::isnan(value.y()) || std::isnan(value.z()));
  });
}

void check_values(const std::string& path, const VdbVec3fGrid& grid) {
  for (auto value = grid.cbeginValueOn(); value; ++value) {
    if (value->isFinite()) continue;
    std::ostringstream text;
    text << "grid \"" << grid.getName() << "\", voxel " << value.getCoord() << ": " << *value
         << " is no velocity; every active voxel must hold one, finite, in world units a frame";
    throw_unreadable_vdb(path, text.str());
  }
}

class VdbVelocity final : public VelocityField {
 public:
  explicit VdbVelocity(VdbVec3fGrid::ConstPtr grid) : grid_(std::move(grid)) {}

  std::vector<WorldPoint> velocities_at(const std::vector<WorldPoint>& points) const override {
    return sample_field<WorldPoint>(*grid_, points, [&](auto& reader, WorldPoint p) { return velocity_at(reader, p); });
  }

 private:
  /// The mean of the active voxels among the eight around the point, by nearness.
  template <class Reader>
  WorldPoint velocity_at(Reader& reader, WorldPoint p) const {
    WorldPoint sum{0, 0, 0};
    double weights = 0;
    for_each_voxel_around(reader, grid_->worldToIndex({p.x, p.y, p.z}),
                          [&](double weight, bool is_active, openvdb::Vec3f value) {
                            if (!is_active) return;
                            sum = sum + weight * WorldPoint{value.x(), value.y(), value.z()};
                            weights += weight;
                          });
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    return weights > 0 ? (1 / weights) * sum : WorldPoint{kNothing, kNothing, kNothing};
  }

  const VdbVec3fGrid::ConstPtr grid_;
};

}  // namespace

std::shared_ptr<const VelocityField> read_velocity(const std::string& path, const std::string& name,
                                                   int64_t max_bytes) {
  const auto grid = std::static_pointer_cast<const VdbVec3fGrid>(read_field_grid(path, name, kVelocities, max_bytes));
  check_values(path, *grid);
  return std::make_shared<VdbVelocity>(grid);
}

std::shared_ptr<const VelocityField> velocity_of(const std::array<DenseVolume, 3>& components,
                                                 const std::string& name) {
  auto grid = grid_of(components, name);
  check_values(name, *grid);
  return std::make_shared<VdbVelocity>(std::move(grid));
}

}  // namespace isoshell
