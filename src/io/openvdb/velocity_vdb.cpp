// Velocity fields: a grid of vectors of a .vdb file or from memory, checked once, then sampled.
#include "isoshell/io/velocity_vdb.h"

#include <openvdb/openvdb.h>

#include <cmath>
#include <limits>
#include <sstream>

#include "core/parallel_ranges.h"
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
  const DenseVolume& lattice = components[0];
  initialize_openvdb();
  auto grid = new_vdb_grid<VdbVec3fGrid>(name.c_str(), openvdb::Vec3f(0));
  grid->setTransform(transform_of(lattice, name));
  auto voxels = grid->getAccessor();
  for (int64_t i = 0; i < lattice.size[0]; ++i)
    for (int64_t j = 0; j < lattice.size[1]; ++j)
      for (int64_t k = 0; k < lattice.size[2]; ++k) {
        openvdb::Vec3f value;
        for (int axis = 0; axis < 3; ++axis) {
          const DenseVolume& part = components[size_t(axis)];
          value[axis] = part.values[i * part.stride[0] + j * part.stride[1] + k * part.stride[2]];
        }
        const bool says_nothing = std::isnan(value.x()) || std::isnan(value.y()) || std::isnan(value.z());
        if (!says_nothing) voxels.setValueOn(openvdb::Coord(int(i), int(j), int(k)), value);
      }
  return grid;
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
    std::vector<WorldPoint> out(points.size());
    for_ranges(int64_t(points.size()), 1024, [&](int64_t begin, int64_t end) {
      auto reader = grid_->getConstAccessor();
      for (size_t i = size_t(begin); i < size_t(end); ++i) out[i] = velocity_at(reader, points[i]);
    });
    return out;
  }

 private:
  /// The mean of the active voxels among the eight around the point, by nearness.
  template <class Reader>
  WorldPoint velocity_at(Reader& reader, WorldPoint p) const {
    WorldPoint sum{0, 0, 0};
    double weights = 0;
    for_each_voxel_around(*grid_, reader, {p.x, p.y, p.z}, [&](double weight, bool is_active, openvdb::Vec3f value) {
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
