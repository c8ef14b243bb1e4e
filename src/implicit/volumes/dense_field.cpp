#include "implicit/volumes/dense_field.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/parallel_ranges.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

int32_t blocks_along(int64_t size) { return int32_t((size + kFieldBlock - 1) / kFieldBlock); }

/// Of the part of a block that lies in the array.
struct BlockRange {
  float low = INFINITY, high = -INFINITY;
  bool finite = true, whole = false;

  bool is_tile() const { return whole && low == high; }
};

}  // namespace

DenseField::DenseField(const DenseVolume& volume, const std::string& volume_name, const std::optional<double>& iso)
    : volume_(volume) {
  file = volume_name;
  name = "values";
  grid_class = "unknown";
  check(volume_name);
  to_world = lattice_map(volume.spacing_world, volume.origin_world);
  double low = INFINITY, high = -INFINITY;
  split_into_blocks(low, high);
  background = !iso || is_mostly_above(*iso) ? high : low;
  drop_background();
}

void DenseField::check(const std::string& volume_name) const {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::usage, "read", volume_name + what); };
  for (const int64_t size : volume_.size)
    if (size < 1 || size > kFieldReach)
      refuse(" has " + std::to_string(size) + " values along an axis; it must have 1 to " +
             std::to_string(kFieldReach));
  const WorldPoint &s = volume_.spacing_world, &o = volume_.origin_world;
  for (const double spacing : {s.x, s.y, s.z})
    if (!(spacing > 0) || !std::isfinite(spacing)) refuse(": its spacing must be above 0 along every axis");
  for (const double place : {o.x, o.y, o.z})
    if (!std::isfinite(place)) refuse(": its origin must be finite");
}

void DenseField::split_into_blocks(double& low, double& high) {
  const int32_t nx = blocks_along(volume_.size[0]), ny = blocks_along(volume_.size[1]),
                nz = blocks_along(volume_.size[2]);
  const auto origin = [&](int64_t b) -> Voxel {
    return {int32_t(b / nz / ny) * kFieldBlock, int32_t(b / nz % ny) * kFieldBlock, int32_t(b % nz) * kFieldBlock};
  };
  std::vector<BlockRange> ranges(size_t(int64_t(nx) * ny * nz));
  for_each_index(int64_t(0), int64_t(ranges.size()), [&](int64_t b) {
    const Voxel o = origin(b);
    const int64_t end[3] = {std::min<int64_t>(o.x + kFieldBlock, volume_.size[0]),
                            std::min<int64_t>(o.y + kFieldBlock, volume_.size[1]),
                            std::min<int64_t>(o.z + kFieldBlock, volume_.size[2])};
    BlockRange range;
    for (int64_t x = o.x; x < end[0]; ++x)
      for (int64_t y = o.y; y < end[1]; ++y)
        for (int64_t z = o.z; z < end[2]; ++z) {
          const float value = at(x, y, z);
          range.finite = range.finite && std::isfinite(value);
          range.low = std::min(range.low, value);
          range.high = std::max(range.high, value);
        }
    range.whole = end[0] == o.x + kFieldBlock && end[1] == o.y + kFieldBlock && end[2] == o.z + kFieldBlock;
    ranges[size_t(b)] = range;
  });
  for (size_t b = 0; b < ranges.size(); ++b) {
    const BlockRange& range = ranges[b];
    const Voxel o = origin(int64_t(b));
    if (!range.finite) refuse_value(o);
    low = std::min<double>(low, range.low);
    high = std::max<double>(high, range.high);
    if (range.is_tile())
      tiles_.push_back({o, kFieldBlock, range.low});
    else
      blocks_.push_back(o);
  }
}

void DenseField::drop_background() {
  const auto same = [&](const FieldTile& tile) { return double(tile.value) == background; };
  tiles_.erase(std::remove_if(tiles_.begin(), tiles_.end(), same), tiles_.end());
}

bool DenseField::is_mostly_above(double iso) const {
  int64_t above = 0, count = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    for (const int64_t end : {int64_t(0), volume_.size[axis] - 1})
      for (int64_t i = 0; i < volume_.size[u]; ++i)
        for (int64_t j = 0; j < volume_.size[v]; ++j) {
          int64_t place[3];
          place[axis] = end;
          place[u] = i;
          place[v] = j;
          above += double(at(place[0], place[1], place[2])) > iso;
          ++count;
        }
  }
  return 2 * above > count;
}

void DenseField::refuse_value(Voxel block) const {
  std::ostringstream text;
  for (int i = 0; i < kFieldBlock * kFieldBlock * kFieldBlock; ++i) {
    const int64_t x = block.x + (i >> 6), y = block.y + (i >> 3 & 7), z = block.z + (i & 7);
    if (x >= volume_.size[0] || y >= volume_.size[1] || z >= volume_.size[2] || std::isfinite(at(x, y, z))) continue;
    text << file << ": value (" << x << ", " << y << ", " << z << ") is " << at(x, y, z) << "; values must be finite";
    break;
  }
  throw Error(ErrorCode::unreadable_input, "read", text.str());
}

void DenseField::copy(Voxel origin, const int size[3], float* to) const {
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z) {
        const int64_t i = int64_t(origin.x) + x, j = int64_t(origin.y) + y, k = int64_t(origin.z) + z;
        const bool held =
            i >= 0 && j >= 0 && k >= 0 && i < volume_.size[0] && j < volume_.size[1] && k < volume_.size[2];
        to[x * kWindowStride[0] + y * kWindowStride[1] + z] = held ? at(i, j, k) : float(background);
      }
}

}  // namespace isoshell
