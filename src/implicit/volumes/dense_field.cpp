#include "implicit/volumes/dense_field.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr double kOffPoints = .125;  // of periodic sides, whose vertices all stay: nearer ones would be one

int32_t blocks_along(int64_t size) { return int32_t((size + kFieldBlock - 1) / kFieldBlock); }

/// Where both sides of an array are at its only value, the surface has to end farther out.
bool ends_half_out(const DenseVolume& volume, VolumeSides sides) {
  return sides == VolumeSides::cell || *std::min_element(volume.size, volume.size + 3) < 2;
}

/// Of the part of a block that lies in the array.
struct BlockRange {
  float low = INFINITY, high = -INFINITY;
  bool has_infinite = false, has_nan = false, whole = false;

  bool is_tile() const { return whole && low == high && !has_nan; }
};

}  // namespace

DenseField::DenseField(const DenseVolume& volume, const std::string& volume_name, const VolumeReadOptions& options)
    : volume_(volume), is_periodic_(options.is_periodic), padding_(ends_half_out(volume, options.sides) ? 1 : 0) {
  file = volume_name;
  name = "values";
  grid_class = "unknown";
  for (int a = 0; a < 3; ++a) size_[a] = volume.size[a] + (is_periodic_[size_t(a)] ? 1 : 2 * padding_);
  const auto& [x, y, z] = volume.step_world;
  to_world = lattice_map(volume.step_world, volume.origin_world - double(padding_) * (x + y + z));
  check(volume_name);
  const bool is_periodic = is_periodic_[0] || is_periodic_[1] || is_periodic_[2];
  sides = FieldSides{{0, 0, 0},
                     {int32_t(size_[0]) - 1, int32_t(size_[1]) - 1, int32_t(size_[2]) - 1},
                     options.sides != VolumeSides::open,
                     padding_ > 0,
                     is_periodic ? kOffPoints : 0};
  double low = INFINITY, high = -INFINITY;
  split_into_blocks(low, high);
  if (!(low <= high)) refuse_unknown();
  if (options.is_mask)
    background = std::min(low, 0.);
  else
    background = !options.iso || is_mostly_above(*options.iso) ? high : low;
  drop_background();
}

void DenseField::check(const std::string& volume_name) const {
  const auto refuse = [&](const std::string& what) { throw Error(ErrorCode::usage, "read", volume_name + what); };
  for (const int64_t size : volume_.size)
    if (size < 1 || size > kFieldReach)
      refuse(" has " + std::to_string(size) + " values along an axis; it must have 1 to " +
             std::to_string(kFieldReach));
  const WorldPoint& o = volume_.origin_world;
  for (const double place : {o.x, o.y, o.z})
    if (!std::isfinite(place)) refuse(": its origin must be finite");
  if (!is_invertible(to_world))
    refuse(": its steps from value to value span no volume; give three finite ones that do");
}

void DenseField::split_into_blocks(double& low, double& high) {
  const int32_t nx = blocks_along(size_[0]), ny = blocks_along(size_[1]), nz = blocks_along(size_[2]);
  const auto origin = [&](int64_t b) -> Voxel {
    return {int32_t(b / nz / ny) * kFieldBlock, int32_t(b / nz % ny) * kFieldBlock, int32_t(b % nz) * kFieldBlock};
  };
  std::vector<BlockRange> ranges(size_t(int64_t(nx) * ny * nz));
  for_each_index(int64_t(0), int64_t(ranges.size()), [&](int64_t b) {
    const Voxel o = origin(b);
    const int64_t end[3] = {std::min<int64_t>(o.x + kFieldBlock, size_[0]),
                            std::min<int64_t>(o.y + kFieldBlock, size_[1]),
                            std::min<int64_t>(o.z + kFieldBlock, size_[2])};
    BlockRange range;
    for (int64_t x = o.x; x < end[0]; ++x)
      for (int64_t y = o.y; y < end[1]; ++y)
        for (int64_t z = o.z; z < end[2]; ++z) {
          const float value = at(x, y, z);
          range.has_infinite |= std::isinf(value);
          range.has_nan |= std::isnan(value);
          range.low = std::min(range.low, value);
          range.high = std::max(range.high, value);
        }
    range.whole = end[0] == o.x + kFieldBlock && end[1] == o.y + kFieldBlock && end[2] == o.z + kFieldBlock;
    ranges[size_t(b)] = range;
  });
  for (size_t b = 0; b < ranges.size(); ++b) {
    const BlockRange& range = ranges[b];
    const Voxel o = origin(int64_t(b));
    if (range.has_infinite) refuse_value(o);
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
    for (const int64_t step : {1, -1})
      for (int64_t i = 0; i < size_[u]; ++i)
        for (int64_t j = 0; j < size_[v]; ++j) {
          int64_t place[3];
          place[axis] = step > 0 ? 0 : size_[axis] - 1;
          place[u] = i;
          place[v] = j;
          const auto value = [&] { return at(place[0], place[1], place[2]); };
          while (std::isnan(value()) && place[axis] + step >= 0 && place[axis] + step < size_[axis])
            place[axis] += step;
          above += double(value()) > iso;
          count += std::isnan(value()) ? 0 : 1;
        }
  }
  return 2 * above > count;
}

void DenseField::refuse_unknown() const {
  throw Error(ErrorCode::nothing_to_mesh, "read", file + ": none of its values is a number");
}

void DenseField::refuse_value(Voxel block) const {
  std::ostringstream text;
  for (int i = 0; i < kFieldBlock * kFieldBlock * kFieldBlock; ++i) {
    const Voxel v{block.x + (i >> 6), block.y + (i >> 3 & 7), block.z + (i & 7)};
    if (!sides->hold(v) || !std::isinf(at(v.x, v.y, v.z))) continue;
    const Voxel in = in_array(v);
    text << file << ": value (" << in.x << ", " << in.y << ", " << in.z << ") is " << at(v.x, v.y, v.z)
         << "; values must be finite, or NaN where nothing is known";
    break;
  }
  throw Error(ErrorCode::unreadable_input, "read", text.str());
}

std::unique_ptr<ScalarField> DenseField::continued() const {
  auto field = std::make_unique<DenseField>(*this);
  field->goes_on_ = true;
  return field;
}

/// The value of the nearest point of the lattice, and as much more as that has than the point as far inside of it.
float DenseField::beyond(const int64_t point[3]) const {
  int64_t nearest[3], mirrored[3];
  for (int a = 0; a < 3; ++a) {
    if (is_periodic_[size_t(a)]) {
      const int64_t period = volume_.size[a];
      nearest[a] = mirrored[a] = (point[a] % period + period) % period;
      continue;
    }
    nearest[a] = std::clamp<int64_t>(point[a], 0, size_[a] - 1);
    mirrored[a] = std::clamp<int64_t>(2 * nearest[a] - point[a], 0, size_[a] - 1);
  }
  return 2 * at(nearest[0], nearest[1], nearest[2]) - at(mirrored[0], mirrored[1], mirrored[2]);
}

void DenseField::copy(Voxel origin, const int size[3], float* to) const {
  for (int x = 0; x < size[0]; ++x)
    for (int y = 0; y < size[1]; ++y)
      for (int z = 0; z < size[2]; ++z) {
        const int64_t p[3] = {int64_t(origin.x) + x, int64_t(origin.y) + y, int64_t(origin.z) + z};
        bool is_held = true;
        for (int a = 0; a < 3; ++a) is_held = is_held && p[a] >= 0 && p[a] < size_[a];
        to[x * kWindowStride[0] + y * kWindowStride[1] + z] = is_held    ? at(p[0], p[1], p[2])
                                                              : goes_on_ ? beyond(p)
                                                                         : float(background);
      }
}

}  // namespace isoshell
