#include "repair/holes/cap_loop.h"

#include <cmath>
#include <limits>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

constexpr size_t kMostCorners = 128;
constexpr size_t kMostStarts = 1024;  // corners from which chords are tried
constexpr double kNever = std::numeric_limits<double>::infinity();

using Part = std::vector<uint32_t>;  // corners of a part of the loop, in order
using MayJoin = std::function<bool(uint32_t, uint32_t)>;

/// Dynamic programme over the spans of a part: the best triangle on each span's chord.
class LeastArea {
 public:
  LeastArea(const std::vector<WorldPoint>& corner, const Part& part, const MayJoin& may_join)
      : corner_(corner), part_(part), n_(part.size()), cost_(n_ * n_, 0), apex_(n_ * n_, 0) {
    for (size_t span = 2; span < n_; ++span)
      for (size_t i = 0; i + span < n_; ++i) {
        const size_t j = i + span;
        // The chord of the whole part is one of the loop, or of the cut that made the part.
        if (span + 1 < n_ && !may_join(part_[i], part_[j]))
          cost_[i * n_ + j] = kNever;
        else
          choose_apex(i, j);
      }
  }
  bool found() const { return cost_[n_ - 1] < kNever; }
  void list(std::vector<LoopTriangle>& triangles) const { list(0, n_ - 1, triangles); }

 private:
  void choose_apex(size_t i, size_t j) {
    double best = kNever;
    for (size_t k = i + 1; k < j; ++k) {
      const double sides = cost_[i * n_ + k] + cost_[k * n_ + j];
      if (!(sides < best)) continue;
      const double cost = sides + triangle_area(corner_[part_[i]], corner_[part_[k]], corner_[part_[j]]);
      if (!(cost < best)) continue;
      best = cost;
      apex_[i * n_ + j] = uint32_t(k);
    }
    cost_[i * n_ + j] = best;
  }
  void list(size_t i, size_t j, std::vector<LoopTriangle>& triangles) const {
    if (j - i < 2) return;
    const size_t k = apex_[i * n_ + j];
    triangles.push_back({part_[i], part_[k], part_[j]});
    list(i, k, triangles);
    list(k, j, triangles);
  }

  const std::vector<WorldPoint>& corner_;
  const Part& part_;
  size_t n_;
  std::vector<double> cost_;
  std::vector<uint32_t> apex_;
};

/// The shortest chord that leaves at least a quarter of the corners on either side; {0, 0} when there is none.
std::array<size_t, 2> shortest_cut(const std::vector<WorldPoint>& corner, const Part& part, const MayJoin& may_join) {
  const size_t n = part.size(), least = n / 4, stride = (n + kMostStarts - 1) / kMostStarts;
  std::array<size_t, 2> best = {0, 0};
  double best_sq = kNever;
  for (size_t i = 0; i < n; i += stride)
    for (size_t j = i + least; j < n && j - i <= n - least; ++j) {
      const double sq = distance_sq(corner[part[i]], corner[part[j]]);
      if (!(sq < best_sq) || !may_join(part[i], part[j])) continue;
      best_sq = sq;
      best = {i, j};
    }
  return best;
}

bool cap_part(const std::vector<WorldPoint>& corner, const Part& part, const MayJoin& may_join,
              std::vector<LoopTriangle>& triangles) {
  if (part.size() <= kMostCorners) {
    const LeastArea least(corner, part, may_join);
    if (!least.found()) return false;
    least.list(triangles);
    return true;
  }
  const auto [i, j] = shortest_cut(corner, part, may_join);
  if (i == j) return false;
  Part inner(part.begin() + int64_t(i), part.begin() + int64_t(j) + 1), outer(part.begin() + int64_t(j), part.end());
  outer.insert(outer.end(), part.begin(), part.begin() + int64_t(i) + 1);
  return cap_part(corner, inner, may_join, triangles) && cap_part(corner, outer, may_join, triangles);
}

}  // namespace

std::vector<LoopTriangle> cap_loop(const std::vector<WorldPoint>& corner, const MayJoin& may_join) {
  Part whole(corner.size());
  for (uint32_t i = 0; i < whole.size(); ++i) whole[i] = i;
  std::vector<LoopTriangle> triangles;
  if (whole.size() < 3 || !cap_part(corner, whole, may_join, triangles)) triangles.clear();
  return triangles;
}

}  // namespace isoshell::repair
