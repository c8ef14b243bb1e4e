#include "implicit/volumes/field_sharpness.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel_ranges.h"
#include "implicit/volumes/linear_fit.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

constexpr double kBent = 0.02, kVeryBent = 0.1;
constexpr int64_t kMostBent = 2;   // cells for each that is bent, at least
constexpr int64_t kVeryShare = 4;  // bent cells for each very bent one, at most
constexpr size_t kSamples = 128;   // blocks
constexpr double kNearlyAll = .9;  // of the cells that the surface crosses
constexpr double kJump = 2.2;      // times the rise of distances, which those of a fluid may have twice of

double part_that_jumps(const ScalarField& field, Inside inside, double most_rise) {
  const std::vector<Voxel> blocks = field.blocks();
  std::vector<std::array<int64_t, 2>> of_block(blocks.size(), {0, 0});
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field, blocks[b], window);
    each_cut_cell(window, inside, [&](int, const float* corner, int) {
      ++of_block[b][0];
      of_block[b][1] += jumps_in_cell(corner, most_rise, field.background) ? 1 : 0;
    });
  });
  int64_t cells = 0, jumps = 0;
  for (const auto& [all, some] : of_block) cells += all, jumps += some;
  return cells > 0 ? double(jumps) / double(cells) : 0;
}

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

double most_rise_of(const ScalarField& field, Inside inside) {
  const std::vector<Voxel> blocks = field.blocks();
  std::vector<std::vector<float>> of_block(blocks.size());
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field, blocks[b], window);
    each_cut_cell(window, inside, [&](int, const float* corner, int) {
      const double rise = fit_cell(corner, kWindowStride).rise();
      if (std::isfinite(rise)) of_block[b].push_back(float(rise));
    });
  });
  std::vector<float> rises;
  for (const std::vector<float>& some : of_block) rises.insert(rises.end(), some.begin(), some.end());
  if (rises.empty()) return 0;
  const auto quarter = rises.begin() + std::ptrdiff_t(rises.size() / 4);
  std::nth_element(rises.begin(), quarter, rises.end());
  const double most_rise = kJump * double(*quarter);
  return part_that_jumps(field, inside, most_rise) < kNearlyAll ? most_rise : 0;
}

bool jumps_in_cell(const float* corner, double most_rise, double background) {
  for (int c = 0; c < 8; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      if (c >> (2 - axis) & 1) continue;
      const double from = at_corner(corner, c), to = at_corner(corner, c | 1 << (2 - axis));
      if ((from == background || to == background) && std::abs(to - from) > most_rise) return true;
    }
  return false;
}

}  // namespace isoshell
