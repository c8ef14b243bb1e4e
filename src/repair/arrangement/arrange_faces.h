// The triangles of a soup cut along each other, so that they meet in corners and whole edges only.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

/// What is arranged of a soup.
struct ArrangedGroups {
  size_t first_of_second = 0;   ///< triangles before it are cut along those behind it alone; 0: all along all
  std::optional<WorldBox> box;  ///< of the lattice, around all triangles; none: theirs
  /// Per triangle whether it is known to meet others of its group in what they share alone; empty: of none.
  std::vector<uint8_t> is_checked = {};
  double near_world = 0;  ///< corners nearer than twice that, corners and edges or faces, and edges are made one
};

struct ArrangedFaces {
  WorldBox box;  ///< of the lattice
  std::vector<WorldPoint> point;
  std::vector<std::array<uint32_t, 3>> face;
  std::vector<uint32_t> source;  ///< per face the triangle of the soup that it is a part of, and turns like; ascending
  std::vector<uint8_t> is_cut;   ///< per triangle of the soup: it has faces, and not itself alone
  bool is_near = true;           ///< false: nothing was looked at, since the two groups are apart
  bool is_as_wanted = true;      ///< false: cuts did not end with near_world, and only what meets was made one

  int64_t cut_faces() const { return std::count(is_cut.begin(), is_cut.end(), 1); }
};

/// Two of these faces have corners and whole edges in common and nothing else, or all three corners, as where parts lie
/// on each other: each keeps its own copy. That is decided exactly on a lattice of 2^40 steps along the longest side.
/// Corners that are kept have the position of a corner of the soup to the last bit, which is within half a step of that
/// on the lattice; new points lie on the lattice. What is nearer than 2^-20 of the longest side is made one, or than
/// twice near_world: corners (the smaller position stays, by x, y, z), corners and edges or faces (these are bent
/// through the corner), edges (both are bent through one point). Triangles lower than half of that vanish. What two
/// faces have in common is an edge of both, also where a face ends within another. Faces that lie on each other have
/// the same parts. Where that does not come to an end, as where faces cross at small angles, 2^-20 of the longest side
/// is taken for near_world, and then only what meets is cut, and made one where rounding makes it meet again. None
/// where that does not end either, or takes far more work than any parts do: then `failed_at` is a place where they
/// cross. Of two groups, which are arranged each, the triangles near the other group are looked at, and any
/// that intersect. Throws: interrupted. Result: independent of threads. Cost: a tree of the boxes of all triangles that
/// are looked at, pairs whose boxes meet, and rounds over those that were cut; in all no more than is proportional to
/// the triangles.
std::optional<ArrangedFaces> arrange_faces(const TriangleSoup& soup, WorldPoint& failed_at, const Context& context,
                                           const ArrangedGroups& groups = {});

}  // namespace isoshell::repair
