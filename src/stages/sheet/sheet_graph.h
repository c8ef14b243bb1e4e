// The edge graph of a surface as steps see it.
#pragma once

#include "isoshell/advanced/surface_mesh.h"

namespace isoshell {

struct SheetGraph {
  View<const TriangleIndices> triangles;
  View<const uint32_t> first;
  View<const uint32_t> incident;
  View<const uint32_t> border_before;

  ISOSHELL_HD bool is_on_border(uint32_t v) const { return border_before.size > 0 && border_before[v] != kNone; }
  /// visit(u) for every neighbour u of v: each is the next one in one triangle around v, but for the one before a
  /// border vertex on its border.
  template <class Visit>
  ISOSHELL_HD void for_each_neighbour(uint32_t v, Visit visit) const {
    for_each_corner(v, [&](uint32_t next, uint32_t) { visit(next); });
    if (is_on_border(v)) visit(border_before[v]);
  }
  /// visit(next, last) for every triangle (v, next, last) around v.
  template <class Visit>
  ISOSHELL_HD void for_each_corner(uint32_t v, Visit visit) const {
    for (int64_t n = first[v]; n < first[v + 1]; ++n) {
      const TriangleIndices t = triangles[incident[n]];
      if (t.a == v)
        visit(t.b, t.c);
      else if (t.b == v)
        visit(t.c, t.a);
      else
        visit(t.a, t.b);
    }
  }
};

inline SheetGraph graph_of(const SurfaceMesh& surface) {
  return {surface.triangles.view(), surface.vertex_first.view(), surface.vertex_triangles.view(),
          surface.border_before.view()};
}

}  // namespace isoshell
