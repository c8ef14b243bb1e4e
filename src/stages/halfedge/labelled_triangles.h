// Triangles by their corners' indices: their order, and which stay triangles when labels take the corners' places.
#pragma once

#include "isoshell/advanced/lattice_surface.h"

namespace isoshell {

struct HasThreeLabels {
  View<const TriangleIndices> triangles;
  View<const uint32_t> label;
  ISOSHELL_HD bool operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    const uint32_t a = label[t.a], b = label[t.b], c = label[t.c];
    return a != b && b != c && c != a;
  }
};

ISOSHELL_HD inline bool less_corners(TriangleIndices s, TriangleIndices t) {
  return s.a != t.a ? s.a < t.a : s.b != t.b ? s.b < t.b : s.c < t.c;
}
struct ByIndices {
  ISOSHELL_HD bool operator()(const TriangleIndices& s, const TriangleIndices& t) const { return less_corners(s, t); }
};
/// Corners turned so that the triple is the smallest of its three rotations.
ISOSHELL_HD inline TriangleIndices smallest_first(TriangleIndices t) {
  const TriangleIndices r = {t.b, t.c, t.a}, s = {t.c, t.a, t.b};
  const TriangleIndices u = less_corners(s, r) ? s : r;
  return less_corners(u, t) ? u : t;
}

}  // namespace isoshell
