// See distance_blocks.h.
#include "implicit/level_sets/distance_blocks.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel_ranges.h"
#include "implicit/volumes/iso_surface.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr int64_t kBlockBytes = 4 * kFieldBlock * kFieldBlock * kFieldBlock;

/// Those that differ from the background.
std::vector<FieldTile> tiles_of(const ScalarField& field) {
  std::vector<FieldTile> tiles = field.tiles();
  tiles.erase(std::remove_if(tiles.begin(), tiles.end(),
                             [&](const FieldTile& t) { return !(double(t.value) < field.background); }),
              tiles.end());
  return tiles;
}

}  // namespace

DistanceBlocks::DistanceBlocks(const ScalarField& field, double voxel_size_world, int64_t most_bytes)
    : outside_(float(field.background / voxel_size_world)) {
  const std::vector<Voxel> blocks = field.blocks();
  const std::vector<FieldTile> tiles = tiles_of(field);
  hold_box(field, blocks, tiles, most_bytes);
  for (size_t t = 0; t < tiles.size(); ++t) {
    tile_.push_back(float(double(tiles[t].value) / voxel_size_world));
    const Voxel first{tiles[t].origin.x >> 3, tiles[t].origin.y >> 3, tiles[t].origin.z >> 3};
    const int32_t size = tiles[t].size / kFieldBlock;
    for (int32_t x = 0; x < size; ++x)
      for (int32_t y = 0; y < size; ++y)
        for (int32_t z = 0; z < size; ++z) place_at(first.x + x, first.y + y, first.z + z) = kFirstTile - int32_t(t);
  }
  hold_values(field, blocks, voxel_size_world);
  find_inside();
  if (!is_filled())
    throw Error(ErrorCode::usage, "read",
                field.title() + " has the value of the outside, " + readable_length(field.background) +
                    ", inside of its band, too; give it an inside, as OpenVDB's signedFloodFill does");
}

void DistanceBlocks::hold_box(const ScalarField& field, const std::vector<Voxel>& blocks,
                              const std::vector<FieldTile>& tiles, int64_t most_bytes) {
  if (blocks.empty() && tiles.empty()) return;
  Voxel low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
  const auto hold = [&](const Voxel& origin, int32_t size) {
    check_reach(field, origin);
    low = {std::min(low.x, origin.x), std::min(low.y, origin.y), std::min(low.z, origin.z)};
    high = {std::max(high.x, origin.x + size), std::max(high.y, origin.y + size), std::max(high.z, origin.z + size)};
  };
  for (const Voxel& block : blocks) hold(block, kFieldBlock);
  for (const FieldTile& tile : tiles) hold(tile.origin, tile.size);
  low_ = {low.x >> 3, low.y >> 3, low.z >> 3};
  size_ = {(high.x >> 3) - low_.x, (high.y >> 3) - low_.y, (high.z >> 3) - low_.z};
  const int64_t longest = int64_t(kFieldBlock) * std::max({size_.x, size_.y, size_.z});
  if (longest > 2 * kMaxResolution)
    throw Error(ErrorCode::out_of_memory, "read",
                field.title() + " has " + std::to_string(longest) + " voxels along an axis; at most " +
                    std::to_string(2 * kMaxResolution) + " are taken: resample it coarser");
  const int64_t bytes = 4 * int64_t(size_.x) * size_.y * size_.z + kBlockBytes * int64_t(blocks.size());
  if (most_bytes > 0 && bytes > most_bytes)
    throw Error(ErrorCode::out_of_memory, "read",
                field.title() + " takes " + readable_bytes(bytes) + " beside other level sets, more than the " +
                    readable_bytes(most_bytes) + " that are left; raise --max-memory, or resample them coarser");
  place_.assign(size_t(size_.x) * size_t(size_.y) * size_t(size_.z), kOutside);
}

void DistanceBlocks::hold_values(const ScalarField& field, const std::vector<Voxel>& blocks, double voxel_size_world) {
  values_.resize(blocks.size() * 512);
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    const int all[3] = {kFieldBlock, kFieldBlock, kFieldBlock};
    float window[kWindow * kWindow * kWindow];
    field.copy(blocks[b], all, window);
    float* to = &values_[b * 512];
    for (int x = 0; x < kFieldBlock; ++x)
      for (int y = 0; y < kFieldBlock; ++y)
        for (int z = 0; z < kFieldBlock; ++z, ++to) {
          const float value = window[x * kWindowStride[0] + y * kWindowStride[1] + z];
          *to = std::isfinite(value) ? float(double(value) / voxel_size_world) : outside_;
        }
    place_at(blocks[b].x >> 3, blocks[b].y >> 3, blocks[b].z >> 3) = int32_t(b);
  });
}

void DistanceBlocks::find_inside() {
  Voxel low{INT32_MAX, INT32_MAX, INT32_MAX}, high{INT32_MIN, INT32_MIN, INT32_MIN};
  for_each_block([&](Voxel block) {
    for (int32_t i = 0; i < 512; ++i) {
      const Voxel v{8 * block.x + (i >> 6), 8 * block.y + (i >> 3 & 7), 8 * block.z + (i & 7)};
      if (!(at(v) < 0)) continue;
      low = {std::min(low.x, v.x), std::min(low.y, v.y), std::min(low.z, v.z)};
      high = {std::max(high.x, v.x), std::max(high.y, v.y), std::max(high.z, v.z)};
    }
  });
  if (low.x <= high.x) inside_ = {low, high};
}

/// False where values fall to the inner end of the band and then are those of the outside. Where a part was clipped off
/// they end at any depth.
bool DistanceBlocks::is_filled() const {
  constexpr float kStepVox = 1.05F;  // values differ by no more from one voxel to the next
  bool ends_at_outside = false, ends_elsewhere = false;
  for_each_block([&](Voxel block) {
    if (is_tile({8 * block.x, 8 * block.y, 8 * block.z})) return;
    for (int32_t i = 0; i < 512 && !ends_elsewhere; ++i) {
      const Voxel v{8 * block.x + (i >> 6), 8 * block.y + (i >> 3 & 7), 8 * block.z + (i & 7)};
      const float value = at(v);
      if (!(value < 0)) continue;
      for (const Voxel& step : {Voxel{1, 0, 0}, Voxel{0, 1, 0}, Voxel{0, 0, 1}})
        for (const int32_t way : {-1, 1}) {
          const float next = at({v.x + way * step.x, v.y + way * step.y, v.z + way * step.z});
          if (next < outside_ || next - value < 2 * kStepVox) continue;
          (value < kStepVox - outside_ ? ends_at_outside : ends_elsewhere) = true;
        }
    }
  });
  return !ends_at_outside || ends_elsewhere;
}

WorldPoint DistanceBlocks::slope(Voxel v) const {
  const auto along = [&](int32_t x, int32_t y, int32_t z) {
    return (double(at({v.x + x, v.y + y, v.z + z})) - double(at({v.x - x, v.y - y, v.z - z}))) / 2;
  };
  return {along(1, 0, 0), along(0, 1, 0), along(0, 0, 1)};
}

}  // namespace isoshell
