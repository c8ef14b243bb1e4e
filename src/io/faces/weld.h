// Equal positions become one vertex.
#pragma once

#include <vector>

#include "io/faces/face_collector.h"

namespace isoshell {

/// A position as a file holds it.
template <class Real>
struct RawPosition {
  Real x, y, z;
};

/// The corners of the facets of a binary STL file, where they lie.
struct BinaryStlCorners {
  using Real = float;
  const char* facets;
  RawPosition<float> operator[](int64_t corner) const;
};

/// Corners in an array.
struct CornerArray {
  using Real = double;
  const WorldPoint* points;
  RawPosition<double> operator[](int64_t corner) const {
    return {points[corner].x, points[corner].y, points[corner].z};
  }
};
struct FloatCornerArray {
  using Real = float;
  const RawPosition<float>* points;
  RawPosition<float> operator[](int64_t corner) const { return points[corner]; }
};

/// Corners of three floats each, `stride` bytes apart, little-endian.
struct StridedCorners {
  using Real = float;
  const char* first;
  int64_t stride;
  RawPosition<float> operator[](int64_t corner) const;
};

struct WeldedCorners {
  VertexTable vertices;
  std::vector<Triangle> index;  ///< vertex of each corner, three by three; padded to a whole triangle
};

/// Welds corners of equal position; -0 equals 0, and a NaN equals a NaN of the same bits.
/// Result: vertices in the order of their first corner, at that corner's position.
/// Cost: O(n) in cache-sized parts; 28 bytes a corner (double: 44) beside the result, 4 where it soon repeats another.
template <class Corners>
WeldedCorners weld_corners(const MeshSource& source, int64_t count, Corners corners);
/// The same with vertices behind those that are there; `index` has room for the vertices of all corners.
template <class Corners>
void weld_corners(const MeshSource& source, int64_t count, Corners corners, VertexTable& vertices, uint32_t* index);

}  // namespace isoshell
