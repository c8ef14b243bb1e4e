// The triangles of a mesh that changes, where they are: whether others would meet them.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "voxel/intersect.h"
#include "voxel/random.h"

namespace isoshell {

/// Triangles on the lattice by their numbers, in cells of one size. Cost: put, take and are_free look at the cells that
/// a triangle's box meets, and at the triangles in them.
class TriangleSpace {
 public:
  TriangleSpace(double cell_q8, size_t triangles) : cell_q8_(std::max(int64_t(cell_q8), kLeastCellQ8)) {
    size_t places = 1024;
    while (2 * places < triangles) places *= 2;
    at_.resize(places);
    is_there_.reserve(triangles);
    corners_.reserve(triangles);
  }

  void put(uint32_t number, const CornersOfTriangle& triangle) {
    if (number >= corners_.size()) {
      corners_.resize(size_t(number) + 1);
      is_there_.resize(size_t(number) + 1, 0);
    }
    corners_[number] = triangle;
    is_there_[number] = 1;
    for_each_place(box(triangle), [&](size_t place) {
      at_[place].push_back(number);
      return true;
    });
  }
  /// Nothing where it is not there.
  void take(uint32_t number) {
    if (number >= corners_.size() || !is_there_[number]) return;
    is_there_[number] = 0;
    for_each_place(box(corners_[number]), [&](size_t place) {
      std::vector<uint32_t>& at = at_[place];
      *std::find(at.begin(), at.end(), number) = at.back();
      at.pop_back();
      return true;
    });
  }
  /// Whether some triangles meet neither each other nor any, but those that they replace, outside of corners that they
  /// share, and none is there twice.
  bool are_free(const std::vector<CornersOfTriangle>& made, const std::vector<uint32_t>& replaced) const {
    for (size_t i = 0; i < made.size(); ++i) {
      for (size_t j = 0; j < i; ++j)
        if (meet(made[i], made[j])) return false;
      const BoxQ8 around = box(made[i]);
      const bool is_free = for_each_place(around, [&](size_t place) {
        for (const uint32_t t : at_[place])
          if (boxes_meet(box(corners_[t]), around) &&
              std::find(replaced.begin(), replaced.end(), t) == replaced.end() && meet(made[i], corners_[t]))
            return false;
        return true;
      });
      if (!is_free) return false;
    }
    return true;
  }

 private:
  static constexpr int64_t kLeastCellQ8 = 64;

  static BoxQ8 box(const CornersOfTriangle& t) { return box_of(t.at[0], t.at[1], t.at[2]); }
  static bool meet(const CornersOfTriangle& s, const CornersOfTriangle& t) {
    int shared = 0;
    for (const uint32_t v : s.id) shared += v == t.id[0] || v == t.id[1] || v == t.id[2] ? 1 : 0;
    return shared == 3 || triangles_intersect_apart(s, t);
  }

  int64_t cell_of(int32_t at) const { return (int64_t(at) + (int64_t(1) << 40)) / cell_q8_; }
  /// The same place for some cells that lie apart: what is there meets a box or does not.
  template <class Visit>
  bool for_each_place(const BoxQ8& box, Visit visit) const {
    const int64_t high[3] = {cell_of(box.max.x), cell_of(box.max.y), cell_of(box.max.z)};
    for (int64_t x = cell_of(box.min.x); x <= high[0]; ++x)
      for (int64_t y = cell_of(box.min.y); y <= high[1]; ++y)
        for (int64_t z = cell_of(box.min.z); z <= high[2]; ++z)
          if (!visit(size_t(mix64(uint64_t(x) << 42 ^ uint64_t(y) << 21 ^ uint64_t(z))) & (at_.size() - 1)))
            return false;
    return true;
  }

  int64_t cell_q8_;
  std::vector<CornersOfTriangle> corners_;  ///< by number
  std::vector<char> is_there_;
  std::vector<std::vector<uint32_t>> at_;  ///< numbers of triangles
};

}  // namespace isoshell
