// The smooth indicator function of oriented points on a regular grid: about 1 inside, 0 outside.
#pragma once

#include <vector>

#include "implicit/points/point_normals.h"
#include "implicit/volumes/scalar_field.h"

namespace isoshell {

/// Cubes of the same size over the points' box and a rim around it; values in their corners, z fastest.
struct GridShape {
  WorldPoint origin{0, 0, 0};
  double voxel_size = 1;
  int32_t size[3] = {};

  AffineMap to_world() const {
    return lattice_map({WorldPoint{voxel_size, 0, 0}, {0, voxel_size, 0}, {0, 0, voxel_size}}, origin);
  }
  int64_t count() const { return int64_t(size[0]) * size[1] * size[2]; }
  int64_t index(int32_t x, int32_t y, int32_t z) const { return (int64_t(x) * size[1] + y) * size[2] + z; }
};

/// A grid of about `voxel_size` whose points are at most `max_count`; it is made coarser where they would be more.
GridShape shape_around(const std::vector<WorldPoint>& points, double voxel_size, int64_t max_count);

/// Solves for the function whose gradient is the points' inward normals, spread over the voxels around them, from
/// coarse grids to the given one. 0 on the rim.
std::vector<float> solve_indicator(const OrientedPoints& points, const GridShape& shape);

/// Mean value at the points, each by its area: the level of the surface.
double level_at_points(const OrientedPoints& points, const GridShape& shape, const std::vector<float>& value);

/// The grid as a field with the background 0, for extract_iso_surface at `level`.
class IndicatorField : public ScalarField {
 public:
  IndicatorField(const GridShape& shape, std::vector<float> value, double level);
  std::vector<Voxel> blocks() const override;
  std::vector<FieldTile> tiles() const override { return {}; }
  void copy(Voxel origin, const int size[3], float* to) const override;

 private:
  float at(int32_t x, int32_t y, int32_t z) const {
    return x < shape_.size[0] && y < shape_.size[1] && z < shape_.size[2] && x >= 0 && y >= 0 && z >= 0
               ? value_[size_t(shape_.index(x, y, z))]
               : 0;
  }
  GridShape shape_;
  std::vector<float> value_;
  double level_;
};

}  // namespace isoshell
