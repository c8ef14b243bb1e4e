// Cubes of lattice points, numbered.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// All that some points are in, as large as asked for, or larger where there would be more than points. What is in one
/// meets nothing that is in another one.
class Cubes {
 public:
  Cubes(const std::vector<PointQ8>& points, double size_q8, double offset) : size_q8_(size_q8), offset_(offset) {
    BoxQ8 box = box_of(points[0], points[0]);
    for (const PointQ8& p : points) stretch(box, p);
    low_ = box.min;
    for (;; size_q8_ *= 2) {  // a few long edges, or short ones, must not make more cubes than there is room for
      const Place last = place_of(box.max);
      rows_ = last[2] + 1;
      slices_ = rows_ * (last[1] + 1);
      count_ = slices_ * (last[0] + 1);
      if (count_ <= int64_t(points.size()) + 1) return;
    }
  }

  int64_t count() const { return count_; }
  int64_t of(const PointQ8& p) const { return number(place_of(p)); }
  /// Calls visit(cube) for all that a box meets.
  template <class Visit>
  void for_each_meeting(const BoxQ8& box, Visit visit) const {
    const Place low = place_of(box.min), high = place_of(box.max);
    for (int64_t x = low[0]; x <= high[0]; ++x)
      for (int64_t y = low[1]; y <= high[1]; ++y)
        for (int64_t z = low[2]; z <= high[2]; ++z) visit(number({x, y, z}));
  }

 private:
  using Place = std::array<int64_t, 3>;

  int64_t number(const Place& at) const { return slices_ * at[0] + rows_ * at[1] + at[2]; }
  Place place_of(const PointQ8& p) const {
    const auto along = [&](int64_t way) { return int64_t(std::floor(double(way) / size_q8_ + offset_)); };
    return {along(int64_t(p.x) - low_.x), along(int64_t(p.y) - low_.y), along(int64_t(p.z) - low_.z)};
  }

  double size_q8_, offset_;
  PointQ8 low_;
  int64_t rows_ = 0, slices_ = 0, count_ = 0;
};

}  // namespace isoshell
