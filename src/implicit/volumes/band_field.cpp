// What is known beside the band of a level set whose background says nothing.
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/parallel_ranges.h"
#include "implicit/volumes/cell_window.h"
#include "implicit/volumes/iso_surface.h"
#include "implicit/volumes/tile_borders.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr int kAround = kFieldBlock + 2;  // a block with a point more on every side
constexpr int kStep[3] = {kAround * kAround, kAround, 1};
constexpr int64_t kBlockBytes = kFieldBlock * kFieldBlock * kFieldBlock * int64_t(sizeof(float));

/// Calls visit(x, y, z) for -1, 0 and 1 along each axis.
template <class Visit>
void each_around(Visit visit) {
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) visit(x, y, z);
}

std::vector<Voxel> blocks_and_those_around(const ScalarField& field) {
  std::vector<Voxel> all;
  for (const Voxel& block : field.blocks()) {
    check_reach(field, block);
    each_around(
        [&](int x, int y, int z) { all.push_back(plus(block, x * kFieldBlock, y * kFieldBlock, z * kFieldBlock)); });
  }
  tbb::parallel_sort(all.begin(), all.end(), comes_before);
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

/// The values of a block and of the points around it, at kStep.
void read_around(const ScalarField& field, Voxel block, float* to) {
  each_around([&](int x, int y, int z) {
    const int side[3] = {x, y, z};
    int first[3], size[3], at = 0;  // of the points taken from there; before the block it is the last ones
    for (int axis = 0; axis < 3; ++axis) {
      first[axis] = side[axis] < 0 ? kFieldBlock - 1 : 0;
      size[axis] = side[axis] > 0 ? 1 : kFieldBlock;
      at += (side[axis] < 0 ? 0 : side[axis] == 0 ? 1 : kAround - 1) * kStep[axis];
    }
    float part[kWindow * kWindow * kWindow];
    field.copy(plus(block, x * kFieldBlock, y * kFieldBlock, z * kFieldBlock), size, part);
    for (int i = first[0]; i < size[0]; ++i)
      for (int j = first[1]; j < size[1]; ++j)
        for (int k = first[2]; k < size[2]; ++k)
          to[at + (i - first[0]) * kStep[0] + (j - first[1]) * kStep[1] + k - first[2]] =
              part[i * kWindowStride[0] + j * kWindowStride[1] + k];
  });
}

/// Of the nearest known values around one; NaN where there are none.
float mean_of_nearest(const float* value) {
  double sum[4] = {};
  int count[4] = {};
  each_around([&](int x, int y, int z) {
    const float beside = value[x * kStep[0] + y * kStep[1] + z];
    const int ring = std::abs(x) + std::abs(y) + std::abs(z);
    if (std::isnan(beside)) return;
    sum[ring] += double(beside);
    ++count[ring];
  });
  for (int ring = 1; ring < 4; ++ring)
    if (count[ring] > 0) return float(sum[ring] / count[ring]);
  return NAN;
}

class BandField : public ScalarField {
 public:
  BandField(std::unique_ptr<ScalarField> of, int64_t memory_limit_bytes);

  std::vector<Voxel> blocks() const override { return block_; }
  std::vector<FieldTile> tiles() const override { return of_->tiles(); }
  void copy(Voxel origin, const int size[3], float* to) const override;

 private:
  /// None where nothing is known.
  std::vector<float> filled(Voxel block) const;

  const std::unique_ptr<ScalarField> of_;
  std::vector<Voxel> block_;                ///< in which something is known, sorted
  std::vector<std::vector<float>> values_;  ///< of each, z fastest
};

BandField::BandField(std::unique_ptr<ScalarField> of, int64_t memory_limit_bytes) : of_(std::move(of)) {
  file = of_->file;
  name = of_->name;
  grid_class = of_->grid_class;
  background = of_->background;
  to_world = of_->to_world;
  const std::vector<Voxel> blocks = blocks_and_those_around(*of_);
  const int64_t bytes = int64_t(blocks.size()) * kBlockBytes;
  if (memory_limit_bytes > 0 && bytes > memory_limit_bytes)
    throw Error(ErrorCode::out_of_memory, "memory",
                title() + ": what lies beside its band takes up to " + std::to_string(bytes >> 20) +
                    " MiB, more than the limit; give it a background, resample it coarser or raise --max-memory");
  std::vector<std::vector<float>> values(blocks.size());
  for_each_index(size_t(0), blocks.size(), [&](size_t b) { values[b] = filled(blocks[b]); });
  for (size_t b = 0; b < blocks.size(); ++b) {
    if (values[b].empty()) continue;
    block_.push_back(blocks[b]);
    values_.push_back(std::move(values[b]));
  }
}

std::vector<float> BandField::filled(Voxel block) const {
  float around[kAround * kAround * kAround];
  read_around(*of_, block, around);
  std::vector<float> values;
  for (int i = 0; i < 512; ++i) {
    const float* value = around + ((i >> 6) + 1) * kStep[0] + ((i >> 3 & 7) + 1) * kStep[1] + (i & 7) + 1;
    values.push_back(std::isnan(*value) ? mean_of_nearest(value) : *value);
  }
  const bool is_unknown = std::all_of(values.begin(), values.end(), [](float v) { return std::isnan(v); });
  return is_unknown ? std::vector<float>() : values;
}

void BandField::copy(Voxel origin, const int size[3], float* to) const {
  const auto block = std::lower_bound(block_.begin(), block_.end(), origin, comes_before);
  if (block == block_.end() || !(*block == origin)) return of_->copy(origin, size, to);
  const std::vector<float>& values = values_[size_t(block - block_.begin())];
  copy_block(size, to, [&](int i) { return values[size_t(i)]; });
}

}  // namespace

std::unique_ptr<ScalarField> with_points_beside_band(std::unique_ptr<ScalarField> band, int64_t memory_limit_bytes) {
  return std::make_unique<BandField>(std::move(band), memory_limit_bytes);
}

}  // namespace isoshell
