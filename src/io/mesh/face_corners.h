// What files hold of the corners of faces, for the corners of the triangles that faces were split into.
#pragma once

#include <algorithm>
#include <vector>

#include "io/mesh/face_collector.h"

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

/// Calls take(i, corner) with the place in `faces` of each corner i of a triangle: the first one of its face at its
/// vertex.
template <class Take>
void find_corners(const FaceCorners& faces, size_t face, const Triangle& triangle, Take take) {
  const auto begin = faces.vertex.begin() + faces.first[face], end = faces.vertex.begin() + faces.first[face + 1];
  for (size_t i = 0; i < 3; ++i) take(i, size_t(std::find(begin, end, triangle[i]) - faces.vertex.begin()));
}

/// Makes values of vertices values of corners, which share them.
inline void spread_to_corners(const std::vector<Triangle>& triangles, Attribute& attribute) {
  attribute.domain = AttributeDomain::corner;
  attribute.index.reserve(3 * triangles.size());
  for (const Triangle& t : triangles) attribute.index.insert(attribute.index.end(), t.begin(), t.end());
}

}  // namespace isoshell
