// The sheet's edge graph as steps see it.
#pragma once

#include "isoshell/sheet.h"

namespace isoshell {

struct SheetGraph {
  View<const TriangleIndices> triangles;
  View<const int64_t> first;
  View<const uint32_t> incident;

  /// visit(next, last) for every triangle (v, next, last) around v. On a closed, oriented sheet `next` runs over every
  /// neighbour of v exactly once.
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

inline SheetGraph graph_of(const Sheet& sheet) {
  return {sheet.triangles.view(), sheet.vertex_first.view(), sheet.vertex_triangles.view()};
}

}  // namespace isoshell
