#include "implicit/points/point_distances.h"

#include <algorithm>
#include <cmath>

#include "core/buckets.h"
#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "implicit/points/sides_of_points.h"
#include "implicit/volumes/cell_window.h"
#include "implicit/volumes/tile_borders.h"

namespace isoshell {
namespace {

constexpr double kBand = 3;          // voxels from a point that distances are known
constexpr double kAround = 5;        // voxels from a block: the points of its sides
constexpr double kPerIndicator = 6;  // distance that stands for the indicator's whole rise

/// The blocks of a grid and the points in each.
class PointBlocks {
 public:
  PointBlocks(const OrientedPoints& points, const GridShape& shape) : points_(points), shape_(shape) {
    for (int a = 0; a < 3; ++a) size_[a] = (shape.size[a] + kFieldBlock - 1) / kFieldBlock;
    of_block_ = sort_into_buckets<uint32_t>(count(), int64_t(points.position.size()), [&](int64_t i, auto put) {
      const WorldPoint p = in_voxels(uint32_t(i));
      put(number(int32_t(p.x) / kFieldBlock, int32_t(p.y) / kFieldBlock, int32_t(p.z) / kFieldBlock), uint32_t(i));
    });
  }

  int64_t count() const { return int64_t(size_[0]) * size_[1] * size_[2]; }
  Voxel origin(int64_t block) const {
    const auto z = int32_t(block % size_[2]), y = int32_t(block / size_[2] % size_[1]),
               x = int32_t(block / size_[2] / size_[1]);
    return {kFieldBlock * x, kFieldBlock * y, kFieldBlock * z};
  }

  std::vector<SidePoint> around(int64_t block) const {
    const Voxel o = origin(block);
    const int32_t at[3] = {o.x / kFieldBlock, o.y / kFieldBlock, o.z / kFieldBlock};
    std::vector<SidePoint> found;
    for (int32_t x = std::max(0, at[0] - 1); x <= std::min(size_[0] - 1, at[0] + 1); ++x)
      for (int32_t y = std::max(0, at[1] - 1); y <= std::min(size_[1] - 1, at[1] + 1); ++y)
        for (int32_t z = std::max(0, at[2] - 1); z <= std::min(size_[2] - 1, at[2] + 1); ++z)
          for (const uint32_t i : of_block_.in(number(x, y, z)))
            if (const WorldPoint p = in_voxels(i); is_around(o, p))
              found.push_back({p, points_.normal[i], points_.area[i]});
    return found;
  }

 private:
  int64_t number(int32_t x, int32_t y, int32_t z) const { return (int64_t(x) * size_[1] + y) * size_[2] + z; }
  WorldPoint in_voxels(uint32_t i) const { return (1 / shape_.voxel_size) * (points_.position[i] - shape_.origin); }
  static bool is_around(const Voxel& o, const WorldPoint& p) {
    const double far = kFieldBlock - 1 + kAround;
    return p.x >= o.x - kAround && p.x <= o.x + far && p.y >= o.y - kAround && p.y <= o.y + far &&
           p.z >= o.z - kAround && p.z <= o.z + far;
  }

  const OrientedPoints& points_;
  const GridShape& shape_;
  int32_t size_[3];
  Buckets<uint32_t> of_block_;
};

float value_of(const Indicator& indicator, const Voxel& v) {
  const GridShape& shape = indicator.shape;
  if (v.x >= shape.size[0] || v.y >= shape.size[1] || v.z >= shape.size[2]) return float(kBand);
  const double above = double(indicator.value[size_t(shape.index(v.x, v.y, v.z))]) - indicator.level;
  return float(std::clamp(-kPerIndicator * above, -kBand, kBand));
}

/// The values of a block's lattice points.
std::vector<float> values_of(const PointBlocks& blocks, int64_t block, const Indicator& indicator, double spacing_vox) {
  const Voxel o = blocks.origin(block);
  const std::vector<SidePoint> around = blocks.around(block);
  SidesOfPoints sides(spacing_vox);
  std::vector<float> value(size_t(kFieldBlock * kFieldBlock * kFieldBlock));
  for (int i = 0; i < int(value.size()); ++i) {
    const Voxel v = plus(o, i >> 6, i >> 3 & 7, i & 7);
    const WorldPoint place{double(v.x), double(v.y), double(v.z)};
    double nearest_sq = kBand * kBand;
    for (const SidePoint& p : around) nearest_sq = std::min(nearest_sq, distance_sq(place, p.at));
    value[size_t(i)] = nearest_sq < kBand * kBand
                           ? float(std::clamp(sides.distance(place, around, std::sqrt(nearest_sq)), -kBand, kBand))
                           : value_of(indicator, v);
  }
  return value;
}

}  // namespace

PointDistances::PointDistances(const OrientedPoints& points, const Indicator& indicator) {
  const GridShape& shape = indicator.shape;
  background = kBand;
  to_world = shape.to_world();
  const PointBlocks blocks(points, shape);
  std::vector<std::vector<float>> value(size_t(blocks.count()));
  for_each_index(int64_t(0), blocks.count(), [&](int64_t b) {
    std::vector<float> of_block = values_of(blocks, b, indicator, points.spacing / shape.voxel_size);
    const auto [least, most] = std::minmax_element(of_block.begin(), of_block.end());
    if (*least == *most) of_block.resize(1);
    value[size_t(b)] = std::move(of_block);
  });
  for (int64_t b = 0; b < blocks.count(); ++b) {
    std::vector<float>& of_block = value[size_t(b)];
    if (of_block.size() == 1) {
      if (of_block[0] < 0) tiles_.push_back({blocks.origin(b), kFieldBlock, of_block[0]});
      continue;
    }
    blocks_.push_back(blocks.origin(b));
    value_.push_back(std::move(of_block));
  }
}

void PointDistances::copy(Voxel origin, const int size[3], float* to) const {
  const auto block = std::lower_bound(blocks_.begin(), blocks_.end(), origin, comes_before);
  if (block != blocks_.end() && *block == origin) {
    const std::vector<float>& value = value_[size_t(block - blocks_.begin())];
    return copy_block(size, to, [&](int i) { return value[size_t(i)]; });
  }
  const auto tile = std::lower_bound(tiles_.begin(), tiles_.end(), origin,
                                     [](const FieldTile& t, const Voxel& v) { return comes_before(t.origin, v); });
  const float value = tile != tiles_.end() && tile->origin == origin ? tile->value : float(background);
  copy_block(size, to, [&](int) { return value; });
}

}  // namespace isoshell
