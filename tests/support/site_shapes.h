// Surfaces that are hard on the first stages: thin, flat, tiny, on voxel boundaries, or without any order.
#pragma once

#include <string>
#include <vector>

#include "isoshell/advanced/stages.h"
#include "isoshell/advanced/to_host.h"
#include "support/shapes.h"

namespace isoshell::shapes {

struct NamedSoup {
  std::string name;
  TriangleSoup soup;
};

/// A box that keeps the lattice's scale, so that what else is in the soup can be tiny.
inline TriangleSoup with_box(const TriangleSoup& soup) { return together(soup, box({0, 0, 0}, {4, 4, 4})); }

/// Segments, points, needles, and a triangle inside one voxel.
inline TriangleSoup collapsed_triangles() {
  TriangleSoup s;
  s.vertices = {{.3, .4, .5},  {3.1, 2.2, 1.7}, {1.7, 1.3, 1.1}, {2, 2, 2},
                {2.001, 2, 2}, {2, 2.001, 2},   {3, 1, 1},       {3, 3, 1}};
  add_triangle(s, 0, 1, 2);
  add_triangle(s, 3, 3, 3);
  add_triangle(s, 3, 4, 5);
  add_triangle(s, 6, 7, 7);
  add_triangle(s, 6, 6, 7);
  add_triangle(s, 0, 7, 4);
  s.faces_in_file = 6;
  return with_box(s);
}

inline std::vector<NamedSoup> ugly_soups() {
  return {{"torus", torus(2, .7, 24, 12)},
          {"box", box({0, 0, 0}, {3, 2, 1})},
          {"two sheets", two_sheets(2, .1)},
          {"random soup", random_soup(150, 4, 3, 1)},
          {"confetti", random_soup(2000, 4, .05, 2)},
          {"collapsed triangles", collapsed_triangles()}};
}

/// The soup on a lattice of this resolution, in host memory.
inline LatticeSurface snapped(const TriangleSoup& soup, int32_t resolution, Context& context) {
  const auto [lo, hi] = bounding_box(soup);
  return to_host(snap_surface(soup, LatticeFrame::around(lo, hi, resolution), context));
}

/// Every corner on a voxel's corner: triangles lie in voxel faces, along edges, and across diagonals.
inline LatticeSurface on_voxel_boundaries(Context& context) {
  TriangleSoup s = box({0, 0, 0}, {32, 32, 32});
  for (int i = 0; i < 8; ++i)
    s.vertices.push_back({double(4 + i % 3 * 8), double(8 + i / 3 * 4), double(8 + i % 2 * 8)});
  for (uint32_t i = 8; i + 2 < 16; ++i) add_triangle(s, i, i + 1, i + 2);
  LatticeFrame frame = LatticeFrame::around({0, 0, 0}, {32, 32, 32}, 33);
  frame.origin = {-double(kMarginVox), -double(kMarginVox), -double(kMarginVox)};
  return to_host(snap_surface(s, frame, context));
}

}  // namespace isoshell::shapes
