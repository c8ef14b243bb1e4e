#include "implicit/volumes/field_jumps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/parallel_ranges.h"
#include "implicit/volumes/linear_fit.h"

namespace isoshell {
namespace {

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

}  // namespace

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
      const float* at = corner + window_index((c >> 2) << 6 | (c >> 1 & 1) << 3 | (c & 1));
      const double from = *at, to = at[kWindowStride[axis]];
      if ((from == background || to == background) && std::abs(to - from) > most_rise) return true;
    }
  return false;
}

}  // namespace isoshell
