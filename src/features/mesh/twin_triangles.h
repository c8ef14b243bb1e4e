// Triangles that know across which edge they have which neighbour, and flips of these edges.
#pragma once

#include <vector>

#include "features/mesh/mesh_fans.h"
#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Half-edge 3 t + i runs from corner i of triangle t to the next one. Of the triangles beside an edge, a to b, c is
/// the corner of the one that passes it so, d that of the other.
class TwinTriangles {
 protected:
  /// `twin`: as MeshTwins::of; edges without stay.
  TwinTriangles(MeshTriangles& triangles, std::vector<uint32_t>& twin) : triangles_(triangles), twin_(twin) {}

  static uint32_t next(uint32_t h) { return next_in_triangle(h); }
  static uint32_t before(uint32_t h) { return next(next(h)); }
  uint32_t from(uint32_t h) const { return triangles_[h / 3][h % 3]; }
  uint32_t to(uint32_t h) const { return from(next(h)); }
  uint32_t opposite(uint32_t h) const { return from(before(h)); }

  /// Calls visit(half-edge) for those that leave the vertex that one begins at, of the triangles of its fan, until it
  /// returns false. Result: whether it came back to the first one.
  template <class Visit>
  bool visit_fan(uint32_t begin, Visit visit) const {
    for (uint32_t h = begin; h != kNone;) {
      if (!visit(h)) return false;
      h = twin_[before(h)];
      if (h == begin) return true;
    }
    for (uint32_t g = twin_[begin]; g != kNone && visit(next(g));) g = twin_[next(g)];
    return false;
  }

  /// The triangles a, b, c and b, a, d become a, d, c and b, c, d.
  void flip(uint32_t h) {
    const uint32_t g = twin_[h], t = h - h % 3, u = g - g % 3;
    const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(g);
    const uint32_t at_ad = twin_[next(g)], at_ca = twin_[before(h)], at_bc = twin_[next(h)], at_db = twin_[before(g)];
    triangles_[t / 3] = {a, d, c};
    triangles_[u / 3] = {b, c, d};
    connect(t, at_ad);
    connect(t + 1, u + 1);
    connect(t + 2, at_ca);
    connect(u, at_bc);
    connect(u + 2, at_db);
  }
  void connect(uint32_t g, uint32_t h) {
    if (g != kNone) twin_[g] = h;
    if (h != kNone) twin_[h] = g;
  }

  MeshTriangles& triangles_;
  std::vector<uint32_t>& twin_;
};

}  // namespace isoshell
