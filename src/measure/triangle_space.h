// The triangles of a mesh that changes, where they are: whether others would meet them.
#pragma once

#include <tbb/spin_mutex.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "voxel/intersect.h"
#include "voxel/random.h"

namespace isoshell {

/// Triangles on the lattice by their numbers, in cells of one size. Several threads may put, take and look at once what
/// does not meet what the others have, as long as none puts a number that is new. Cost: put, take and are_free look at
/// the cells that a box meets, and at the boxes in them.
class TriangleSpace {
 public:
  TriangleSpace(double cell_q8, size_t triangles) : cell_q8_(std::max(int64_t(cell_q8), kLeastCellQ8)) {
    size_t places = 1024;
    while (2 * places < triangles) places *= 2;
    at_ = std::vector<Place>(places);
    is_there_.resize(triangles, 0);
    corners_.resize(triangles);
  }

  void put(uint32_t number, const CornersOfTriangle& triangle) {
    if (number >= corners_.size()) {
      corners_.resize(size_t(number) + 1);
      is_there_.resize(size_t(number) + 1, 0);
    }
    corners_[number] = triangle;
    is_there_[number] = 1;
    const BoxQ8 around = box(triangle);
    for_each_place(around, [&](Place& place, const Cell&) {
      place.boxed.push_back({around, number});
      return true;
    });
  }
  /// Nothing where it is not there.
  void take(uint32_t number) {
    if (number >= corners_.size() || !is_there_[number]) return;
    is_there_[number] = 0;
    for_each_place(box(corners_[number]), [&](Place& place, const Cell&) {
      std::vector<Boxed>& at = place.boxed;
      *std::find_if(at.begin(), at.end(), [&](const Boxed& t) { return t.number == number; }) = at.back();
      at.pop_back();
      return true;
    });
  }
  /// Whether some triangles meet neither each other nor any, but those that they replace, outside of corners that they
  /// share, and none is there twice.
  bool are_free(const std::vector<CornersOfTriangle>& made, const std::vector<uint32_t>& replaced) const {
    if (made.empty()) return true;
    for (size_t i = 0; i < made.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (meet(made[i], made[j])) return false;
    BoxQ8 whole = box(made[0]);
    for (const CornersOfTriangle& t : made) whole = joined(whole, box(t));
    return for_each_place(whole, [&](const Place& place, const Cell& cell) {
      for (const Boxed& t : place.boxed) {
        if (!boxes_meet(t.box, whole) || !is_in(cell, largest_of(t.box.min, whole.min)) ||
            std::find(replaced.begin(), replaced.end(), t.number) != replaced.end())
          continue;
        for (const CornersOfTriangle& m : made)
          if (boxes_meet(t.box, box(m)) && meet(m, corners_[t.number])) return false;
      }
      return true;
    });
  }
  /// The same where they may meet what those that they replace met. Cost: looks at each of these, too, and sorts them.
  bool meet_no_more(const std::vector<CornersOfTriangle>& made, const std::vector<uint32_t>& replaced) const {
    std::vector<uint32_t> before = replaced;
    bool met_any = false, met_each_other = false;
    for (const uint32_t r : replaced)
      for_each_met(corners_[r], [&](uint32_t other) {
        if (other == r) return;
        before.push_back(other);
        met_any = true;
        met_each_other = met_each_other || std::find(replaced.begin(), replaced.end(), other) != replaced.end();
      });
    if (!met_any) return false;
    std::sort(before.begin(), before.end());
    const auto is_new = [&](uint32_t t) { return !std::binary_search(before.begin(), before.end(), t); };
    for (size_t i = 0; i < made.size(); ++i) {
      for (size_t j = 0; j < i && !met_each_other; ++j)
        if (meet(made[i], made[j])) return false;
      if (meets_any(made[i], is_new)) return false;
    }
    return true;
  }
  /// Calls use(number) for each triangle that a triangle meets outside of corners that they share, or that it is.
  template <class Use>
  void for_each_met(const CornersOfTriangle& triangle, Use use) const {
    meets_any(triangle, [&](uint32_t number) {
      use(number);
      return false;
    });
  }
  /// Whether one of these is so, by is(number). Looks no further once it is.
  template <class Is>
  bool meets_any(const CornersOfTriangle& triangle, Is is) const {
    const BoxQ8 around = box(triangle);
    return !for_each_place(around, [&](const Place& place, const Cell& cell) {
      for (const Boxed& t : place.boxed)
        if (boxes_meet(t.box, around) && is_in(cell, largest_of(t.box.min, around.min)) &&
            meet(triangle, corners_[t.number]) && is(t.number))
          return false;
      return true;
    });
  }

 private:
  struct Boxed {
    BoxQ8 box;
    uint32_t number;
  };
  /// Of some cells that lie apart.
  struct Place {
    std::vector<Boxed> boxed;  ///< boxes beside their numbers, as most of them meet nothing
    tbb::spin_mutex mutex;
  };
  static constexpr int64_t kLeastCellQ8 = 64;

  static BoxQ8 box(const CornersOfTriangle& t) { return box_of(t.at[0], t.at[1], t.at[2]); }
  static bool meet(const CornersOfTriangle& s, const CornersOfTriangle& t) {
    int shared = 0;
    for (const uint32_t v : s.id) shared += v == t.id[0] || v == t.id[1] || v == t.id[2] ? 1 : 0;
    return shared == 3 || triangles_intersect_apart(s, t);
  }

  using Cell = std::array<int64_t, 3>;
  Cell cell_of(const PointQ8& p) const {
    const auto on_axis = [&](int32_t at) { return (int64_t(at) + (int64_t(1) << 40)) / cell_q8_; };
    return {on_axis(p.x), on_axis(p.y), on_axis(p.z)};
  }
  /// As cell_of(p) == cell, without a division.
  bool is_in(const Cell& cell, const PointQ8& p) const {
    const auto on_axis = [&](int64_t number, int32_t at) {
      return uint64_t(int64_t(at) + (int64_t(1) << 40) - number * cell_q8_) < uint64_t(cell_q8_);
    };
    return on_axis(cell[0], p.x) && on_axis(cell[1], p.y) && on_axis(cell[2], p.z);
  }
  template <class Visit>
  bool for_each_place(const BoxQ8& box, Visit visit) const {
    const Cell low = cell_of(box.min), high = cell_of(box.max);
    for (int64_t x = low[0]; x <= high[0]; ++x)
      for (int64_t y = low[1]; y <= high[1]; ++y)
        for (int64_t z = low[2]; z <= high[2]; ++z) {
          Place& place = at_[size_t(mix64(uint64_t(x) << 42 ^ uint64_t(y) << 21 ^ uint64_t(z))) & (at_.size() - 1)];
          const tbb::spin_mutex::scoped_lock lock(place.mutex);
          if (!visit(place, Cell{x, y, z})) return false;
        }
    return true;
  }

  int64_t cell_q8_;
  std::vector<CornersOfTriangle> corners_;  ///< by number
  std::vector<char> is_there_;
  mutable std::vector<Place> at_;
};

}  // namespace isoshell
