// What can be repaired on the faces themselves, before anything is voxelised: most dirty files become closed and
// oriented.
#pragma once

#include <cstdint>
#include <optional>

#include "isoshell/surface_source.h"

namespace isoshell {

struct Context;
struct RemeshOptions;

/// Larger loops are rims, of a bowl or a terrain: longer in terms of their component's diagonal, unless they are
/// cracks, whose caps are small in terms of its area.
constexpr double kLargestHole = .6;
constexpr double kLargestCrack = .01;
/// Boundaries nearer to each other than this part of the diagonal are one.
constexpr double kWidestCrack = 1e-5;

struct RepairOptions {
  bool cap_loops = true;  ///< close holes with new faces
};

/// What was changed, by kind.
struct RepairReport {
  int64_t joined_vertices = 0;  ///< of boundaries, moved by next to nothing onto others: cracks
  int64_t repeated_faces = 0;   ///< the same corners as another face, whichever way round; dropped
  int64_t fins = 0;             ///< small patches that hang on the surface by edges of three faces; dropped
  int64_t fin_faces = 0;
  int64_t islands = 0;  ///< small open patches apart from the rest; dropped
  int64_t island_faces = 0;
  int64_t turned_faces = 0;   ///< disagreed with their neighbours about which side is outside
  int64_t capped_loops = 0;   ///< holes closed
  int64_t tubes = 0;          ///< pairs of those that were joined: an arm or a handle that a hole cut through
  int64_t cap_faces = 0;      ///< new faces, the last ones of the repaired soup
  int64_t open_loops = 0;     ///< too large to be holes, or tangled; left open
  double cap_area_world = 0;  ///< square world units
  double widest_cap_world =
      0;  ///< but for tubes: four areas over the length of the loop: the diameter of a round hole, twice a slit's width

  bool changed_anything() const {
    return joined_vertices + repeated_faces + fins + islands + turned_faces + capped_loops > 0;
  }
};

/// Result: boundaries that lie on each other edge by edge, to within kWidestCrack and a quarter of the edges around,
/// and in opposite directions, are one; then the soup without repeated faces, fins and islands, its faces turned to
/// agree with their neighbours over every edge of two faces, and holes capped by triangulations of least area. A patch
/// is what edges of exactly two faces connect. A fin is a patch that ends in the open and on edges of more faces, none
/// of which it leaves with one face, T-junctions taken for closed, and that has less than a two hundredth of the area.
/// A hole is a loop of edges with one face whose box has a diagonal of at most kLargestHole of its component's, or
/// whose cap has at most kLargestCrack of its area; or which is what pieces of a flat face left: along a third of it or
/// more, but not all of it, the surface goes on in its plane, and at the ends of these parts the outline of the face
/// turns. Loops of one plane are holes together where a flat face with holes is missing whole: the surface at the outer
/// one lies behind that face, the others are inside of it and run the other way round, and one of them at least is of
/// another patch. An island is an open patch that shares no vertex with another and has less than a hundredth of the
/// area. Two holes that are rims of one tube, an arm that was cut through, are joined instead: each looks towards the
/// other, the surface at them runs along the way between them, the radii of circles of their areas are within 2.5 of
/// each other, and either is the other's nearest. They belong to one patch and are no farther apart than three times
/// their radii together, or to two, of which one has at most a fifth of the other's area, and are no farther apart than
/// their radii together; then neither is part of an island. Fins stay when all of them have more than a tenth together,
/// islands more than a twentieth: then they are the surface. Closed patches in which faces disagreed are turned
/// outward. The set of positions and triangles does not depend on the order of the soup's. Cost: sorts of vertices,
/// faces and edges; n^3 steps for a hole of n edges up to 128, n^2 beyond.
TriangleSoup repair_soup(const TriangleSoup& soup, const RepairOptions& options, RepairReport& report);

/// Pulls vertices back that alone stretch a surface: by needles that are narrower than the edges that the options ask
/// for, no triangle of a result could follow them, and a grid around them has no voxels for the rest.
/// Result: the soup in which each such vertex stands in the middle of its foot, with its report; none where there are
/// none, or where they were pulled back already. The body is the box of three quarters of the faces, those with the
/// shortest longest edges. A vertex is far where it is farther from the body than 32 times its longest side. The foot
/// of far vertices that faces connect are the others of these faces. They are pulled back where neither their box nor
/// that of the foot has a side as long as an edge. Cost: linear in the faces; one look at each where no edge is longer
/// than a quarter of the box. Throws: usage for options that ask for what is not possible.
std::optional<TriangleSoup> pull_back_far_vertices(const TriangleSoup& soup, const RemeshOptions& options,
                                                   Context& context);

}  // namespace isoshell
