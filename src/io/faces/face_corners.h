// What files hold of the corners of faces, for the corners of the triangles that faces were split into.
#pragma once

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "io/faces/face_collector.h"

namespace isoshell {

/// The corners of a part of a file's faces, as they stand in the file.
struct FaceCorners {
  std::vector<int64_t> first = {0};  ///< per face, and one more, into vertex
  std::vector<uint32_t> vertex;

  int64_t count_of(size_t face) const { return first[face + 1] - first[face]; }
  void end_face() { first.push_back(int64_t(vertex.size())); }
};

/// Where each part's triangles begin in the soup that they are joined to, and one more.
inline std::vector<size_t> triangles_first(const std::vector<FaceCollector>& parts) {
  std::vector<size_t> first = {0};
  for (const FaceCollector& part : parts) first.push_back(first.back() + part.face_of().size());
  return first;
}

/// Finds where corners of triangles stand among those of their faces: the first one of the face at the same vertex.
/// Those of a large face are sorted, once where its triangles are asked about one after another.
class CornerFinder {
 public:
  explicit CornerFinder(const FaceCorners& faces) : faces_(faces) {}

  /// Calls take(i, corner) with the place in the faces' `vertex` of each corner i of a triangle.
  template <class Take>
  void find(size_t face, const Triangle& triangle, Take take) {
    const int64_t first = faces_.first[face], count = faces_.count_of(face);
    if (count <= kFewCorners) {
      const auto begin = faces_.vertex.begin() + first;
      for (size_t i = 0; i < 3; ++i)
        take(i, size_t(std::find(begin, begin + count, triangle[i]) - faces_.vertex.begin()));
      return;
    }
    if (face != sorted_face_) sort(face);
    for (size_t i = 0; i < 3; ++i)
      take(i, std::lower_bound(sorted_.begin(), sorted_.end(), std::make_pair(triangle[i], size_t(0)))->second);
  }

 private:
  static constexpr int64_t kFewCorners = 16;

  void sort(size_t face) {
    sorted_face_ = face;
    sorted_.clear();
    for (auto corner = size_t(faces_.first[face]); corner < size_t(faces_.first[face + 1]); ++corner)
      sorted_.emplace_back(faces_.vertex[corner], corner);
    std::sort(sorted_.begin(), sorted_.end());
  }

  const FaceCorners& faces_;
  size_t sorted_face_ = std::numeric_limits<size_t>::max();
  std::vector<std::pair<uint32_t, size_t>> sorted_;  ///< vertices of its corners, and their places
};

/// Makes values of vertices values of corners, which share them.
inline void spread_to_corners(const MeshSource& source, const std::vector<Triangle>& triangles, Attribute& attribute) {
  make_room(source, attribute.index, 3 * triangles.size());
  attribute.domain = AttributeDomain::corner;
  const auto* const corners = reinterpret_cast<const uint32_t*>(triangles.data());
  attribute.index.assign(corners, corners + 3 * triangles.size());
}

}  // namespace isoshell
