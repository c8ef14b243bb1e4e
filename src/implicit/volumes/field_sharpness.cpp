#include "implicit/volumes/field_sharpness.h"

#include "core/parallel_ranges.h"
#include "implicit/volumes/linear_fit.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

constexpr double kBent = 0.02, kVeryBent = 0.1;
constexpr int64_t kMostBent = 2;   // cells for each that is bent, at least
constexpr int64_t kVeryShare = 4;  // bent cells for each very bent one, at most
constexpr size_t kSamples = 128;   // blocks

double take_median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

/// Over one of each `step` blocks, anyone of these: blocks that follow each other lie in layers.
double rise_of_sample(const ScalarField& field, Inside inside, const std::vector<Voxel>& blocks, size_t step) {
  std::vector<double> of_block(blocks.size() / step, 0);
  for_each_index(size_t(0), of_block.size(), [&](size_t i) {
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field, blocks[i * step + size_t(random_bits(0, i) % step)], window);
    std::vector<double> rises;
    each_cut_cell(window, inside, [&](int, const float* corner, int) {
      const double rise = fit_cell(corner, kWindowStride).rise();
      if (rise > 0) rises.push_back(rise);
    });
    if (!rises.empty()) of_block[i] = take_median(rises);
  });
  of_block.erase(std::remove(of_block.begin(), of_block.end(), 0.), of_block.end());
  return of_block.empty() ? 0 : take_median(of_block);
}

}  // namespace

double usual_rise(const ScalarField& field, Inside inside, const std::vector<Voxel>& blocks) {
  for (size_t step = 1 + blocks.size() / kSamples;; step = 1) {
    const double rise = rise_of_sample(field, inside, blocks, step);
    if (rise > 0 || step == 1) return rise;
  }
}

void BentCells::add(const float* corner, double usual_rise) {
  const double bend = fit_cell(corner, kWindowStride).bend(usual_rise);
  ++all;
  bent += !(bend < kBent);
  very_bent += !(bend < kVeryBent);
}

bool is_sharp(const std::vector<BentCells>& of_blocks) {
  int64_t all = 0, bent = 0, very_bent = 0;
  for (const BentCells& b : of_blocks) all += b.all, bent += b.bent, very_bent += b.very_bent;
  return very_bent > 0 && kMostBent * bent <= all && kVeryShare * very_bent >= bent;
}

}  // namespace isoshell
