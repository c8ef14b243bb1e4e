// The cases of marching cubes, made instead of listed: on every face of a cell the surface cuts off each run of inside
// corners, so that the two cells of a face agree about it, also where its corners alternate.
#pragma once

#include <cstdint>

namespace isoshell {

/// Corner c of a cell lies at (c >> 2, c >> 1 & 1, c & 1). Edge e runs along axis e >> 2, from corner edge_corner(e).
constexpr int edge_corner(int edge) {
  const int axis = edge >> 2, i = edge >> 1 & 1, j = edge & 1;  // the two other coordinates, in order
  return axis == 0 ? i << 1 | j : axis == 1 ? i << 2 | j : i << 2 | j << 1;
}
constexpr int edge_between(int a, int b) {
  const int axis = (a ^ b) == 4 ? 0 : (a ^ b) == 2 ? 1 : 2, low = a & b;
  return axis << 2 | (axis == 0 ? low & 3 : axis == 1 ? (low >> 2 & 1) << 1 | (low & 1) : low >> 1);
}

/// The patches of the surface in a cell: loops of cut edges, one behind the other, each turning left as seen from
/// outside of the surface.
struct IsoCase {
  int8_t loops = 0;
  int8_t size[4] = {};
  int8_t edge[12] = {};
};

struct IsoCases {
  IsoCase of[256] = {};  ///< bit c: corner c is inside
};

namespace iso_cases_steps {

/// Corners of each face in turn, turning left as seen from outside of the cell.
constexpr int kFace[6][4] = {{0, 1, 3, 2}, {4, 6, 7, 5}, {0, 4, 5, 1}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 5, 7, 3}};

constexpr IsoCase make_case(int inside) {
  int next[12] = {};  // edge that follows; a cut edge is entered on one of its faces and left on the other
  for (int& e : next) e = -1;
  for (const auto& corner : kFace)
    for (int i = 0; i < 4; ++i) {
      if (!(inside >> corner[i] & 1) || (inside >> corner[(i + 3) % 4] & 1)) continue;  // not the start of a run
      int last = i;
      while (inside >> corner[(last + 1) % 4] & 1) last = (last + 1) % 4;
      next[edge_between(corner[(i + 3) % 4], corner[i])] = edge_between(corner[last], corner[(last + 1) % 4]);
    }
  IsoCase made;
  int at = 0;
  for (int e = 0; e < 12; ++e) {
    if (next[e] < 0) continue;
    const int begin = at;
    for (int f = e; next[f] >= 0;) {
      made.edge[at++] = int8_t(f);
      const int to = next[f];
      next[f] = -1;
      f = to;
    }
    made.size[made.loops++] = int8_t(at - begin);
  }
  return made;
}

constexpr IsoCases make_cases() {
  IsoCases cases;
  for (int inside = 1; inside < 255; ++inside) cases.of[inside] = make_case(inside);
  return cases;
}

}  // namespace iso_cases_steps

inline constexpr IsoCases kIsoCases = iso_cases_steps::make_cases();

}  // namespace isoshell
