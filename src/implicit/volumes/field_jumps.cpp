#include "implicit/volumes/field_jumps.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/parallel_ranges.h"
#include "implicit/volumes/linear_fit.h"

namespace isoshell {
namespace {

constexpr double kJump = 2.2;  // times the rise of distances, which those of a fluid may have twice of

}  // namespace

double most_rise_of(const ScalarField& field, Inside inside) {
  const std::vector<Voxel> blocks = field.blocks();
  std::vector<std::vector<double>> of_block(blocks.size());
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field, blocks[b], window);
    each_cut_cell(window, inside, [&](int, const float* corner, int) {
      const double rise = fit_cell(corner, kWindowStride).rise();
      if (std::isfinite(rise)) of_block[b].push_back(rise);
    });
  });
  std::vector<double> rises;
  for (const std::vector<double>& some : of_block) rises.insert(rises.end(), some.begin(), some.end());
  if (rises.empty()) return 0;
  const auto quarter = rises.begin() + std::ptrdiff_t(rises.size() / 4);
  std::nth_element(rises.begin(), quarter, rises.end());
  return kJump * *quarter;
}

bool jumps_in_cell(const float* corner, double most_rise) {
  for (int c = 0; c < 8; ++c)
    for (int axis = 0; axis < 3; ++axis) {
      if (c >> (2 - axis) & 1) continue;
      const float* at = corner + window_index((c >> 2) << 6 | (c >> 1 & 1) << 3 | (c & 1));
      if (std::abs(double(at[kWindowStride[axis]]) - double(*at)) > most_rise) return true;
    }
  return false;
}

}  // namespace isoshell
