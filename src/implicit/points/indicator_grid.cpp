// The smooth indicator function of oriented points on a regular grid.
#include "implicit/points/indicator_grid.h"

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "geometry/box.h"

namespace isoshell {
namespace {

constexpr double kRimPart = 0.125;  // of the longest side, empty around the points
constexpr int32_t kRimVoxels = 6;
constexpr int32_t kCoarsest = 24;     // voxels along the longest side of the first grid
constexpr int kCoarsestSweeps = 400;  // on the first grid, and on each one after it
constexpr int kSweeps = 40;

struct Place {
  int32_t cell[3];
  double fraction[3];
};
Place place_of(const GridShape& shape, const WorldPoint& p, double shift) {
  Place at;
  const double v[3] = {(p.x - shape.origin.x) / shape.voxel_size, (p.y - shape.origin.y) / shape.voxel_size,
                       (p.z - shape.origin.z) / shape.voxel_size};
  for (int axis = 0; axis < 3; ++axis) {
    const double floor = std::floor(v[axis] + shift);
    at.cell[axis] = int32_t(floor);
    at.fraction[axis] = v[axis] - floor;
  }
  return at;
}

/// Quadratic B-spline at the three grid points around a place within half a voxel of the middle one, and its slope.
void spline(double f, double weight[3], double slope[3]) {
  weight[0] = 0.5 * (0.5 - f) * (0.5 - f);
  weight[1] = 0.75 - f * f;
  weight[2] = 0.5 * (0.5 + f) * (0.5 + f);
  slope[0] = f - 0.5;
  slope[1] = -2 * f;
  slope[2] = f + 0.5;
}

/// Laplacian of the indicator function times the voxel's square: the divergence of the inward normals.
std::vector<float> divergence(const OrientedPoints& points, const GridShape& shape) {
  std::vector<float> out(size_t(shape.count()), 0.f);
  const double per_voxel = 1 / (shape.voxel_size * shape.voxel_size);
  for (size_t i = 0; i < points.position.size(); ++i) {
    const Place at = place_of(shape, points.position[i], 0.5);
    double w[3][3], s[3][3];
    for (int axis = 0; axis < 3; ++axis) spline(at.fraction[axis], w[axis], s[axis]);
    const WorldPoint& n = points.normal[i];
    const double scale = points.area[i] * per_voxel;
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        for (int z = 0; z < 3; ++z) {
          const double along =
              n.x * s[0][x] * w[1][y] * w[2][z] + n.y * w[0][x] * s[1][y] * w[2][z] + n.z * w[0][x] * w[1][y] * s[2][z];
          out[size_t(shape.index(at.cell[0] + x - 1, at.cell[1] + y - 1, at.cell[2] + z - 1))] += float(scale * along);
        }
  }
  return out;
}

/// Gauss-Seidel over the points of one colour, then of the other: neighbours of a point have the other one.
void relax(const GridShape& shape, const std::vector<float>& source, int sweeps, std::vector<float>& value) {
  const int64_t sx = int64_t(shape.size[1]) * shape.size[2], sy = shape.size[2];
  for (int half = 0; half < 2 * sweeps; ++half)
    for_each_index(1, shape.size[0] - 1, [&](int32_t x) {
      for (int32_t y = 1; y < shape.size[1] - 1; ++y)
        for (int32_t z = 1 + (x + y + half) % 2; z < shape.size[2] - 1; z += 2) {
          const int64_t i = shape.index(x, y, z);
          const float* v = value.data() + i;
          value[size_t(i)] = (v[-sx] + v[sx] + v[-sy] + v[sy] + v[-1] + v[1] - source[size_t(i)]) / 6;
        }
    });
}

double interpolated(const GridShape& shape, const std::vector<float>& value, const WorldPoint& p) {
  const Place at = place_of(shape, p, 0);
  double sum = 0;
  for (int corner = 0; corner < 8; ++corner) {
    double weight = 1;
    int32_t c[3];
    for (int axis = 0; axis < 3; ++axis) {
      const int up = corner >> axis & 1;
      c[axis] = std::clamp(at.cell[axis] + up, 0, shape.size[axis] - 1);
      weight *= up ? at.fraction[axis] : 1 - at.fraction[axis];
    }
    sum += weight * double(value[size_t(shape.index(c[0], c[1], c[2]))]);
  }
  return sum;
}

GridShape coarser(const GridShape& shape) {
  GridShape half = shape;
  half.voxel_size *= 2;
  for (int32_t& size : half.size) size = (size + 1) / 2 + 1;
  return half;
}

std::vector<float> refined(const GridShape& from, const std::vector<float>& value, const GridShape& to) {
  std::vector<float> out(size_t(to.count()), 0.f);
  for_each_index(1, to.size[0] - 1, [&](int32_t x) {
    for (int32_t y = 1; y < to.size[1] - 1; ++y)
      for (int32_t z = 1; z < to.size[2] - 1; ++z)
        out[size_t(to.index(x, y, z))] = float(interpolated(
            from, value,
            {to.origin.x + x * to.voxel_size, to.origin.y + y * to.voxel_size, to.origin.z + z * to.voxel_size}));
  });
  return out;
}

}  // namespace

GridShape shape_around(const std::vector<WorldPoint>& points, double voxel_size, int64_t max_count) {
  const WorldBox box = box_of(points);
  const WorldPoint extent = box.max - box.min;
  GridShape shape;
  for (shape.voxel_size = voxel_size;; shape.voxel_size *= 1.1) {
    const double rim = kRimPart * longest_side(box) + kRimVoxels * shape.voxel_size;
    double count = 1;
    for (int axis = 0; axis < 3; ++axis) count *= (coordinate(extent, axis) + 2 * rim) / shape.voxel_size + 2;
    if (count > double(max_count)) continue;
    shape.origin = widened(box, rim).min;
    for (int axis = 0; axis < 3; ++axis)
      shape.size[axis] = int32_t((coordinate(extent, axis) + 2 * rim) / shape.voxel_size) + 2;
    return shape;
  }
}

std::vector<float> solve_indicator(const OrientedPoints& points, const GridShape& shape) {
  std::vector<float> value;
  if (std::max({shape.size[0], shape.size[1], shape.size[2]}) <= kCoarsest) {
    value.assign(size_t(shape.count()), 0.f);
    relax(shape, divergence(points, shape), kCoarsestSweeps, value);
  } else {
    const GridShape half = coarser(shape);
    value = refined(half, solve_indicator(points, half), shape);
    relax(shape, divergence(points, shape), kSweeps, value);
  }
  return value;
}

double level_at_points(const OrientedPoints& points, const GridShape& shape, const std::vector<float>& value) {
  double sum = 0, area = 0;
  for (size_t i = 0; i < points.position.size(); ++i) {
    sum += points.area[i] * interpolated(shape, value, points.position[i]);
    area += points.area[i];
  }
  return area > 0 ? sum / area : 0.5;
}

IndicatorField::IndicatorField(const GridShape& shape, std::vector<float> value, double level)
    : shape_(shape), value_(std::move(value)), level_(level) {
  background = 0;
  to_world = shape.to_world();
}

std::vector<Voxel> IndicatorField::blocks() const {
  std::vector<Voxel> origins;
  for (int32_t x = 0; x < shape_.size[0]; x += kFieldBlock)
    for (int32_t y = 0; y < shape_.size[1]; y += kFieldBlock)
      for (int32_t z = 0; z < shape_.size[2]; z += kFieldBlock) {
        bool inside = false, outside = false;
        for (int32_t i = 0; i < kFieldBlock * kFieldBlock * kFieldBlock && !(inside && outside); ++i)
          (double(at(x + (i >> 6), y + (i >> 3 & 7), z + (i & 7))) > level_ ? inside : outside) = true;
        if (inside) origins.push_back({x, y, z});
      }
  return origins;
}

void IndicatorField::copy(Voxel o, const int size[3], float* to) const {
  copy_block(size, to, [&](int i) { return at(o.x + (i >> 6), o.y + (i >> 3 & 7), o.z + (i & 7)); });
}

}  // namespace isoshell
