// What closed surfaces that touch, lie in or pass through one another bound together, before anything is voxelised.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {

struct UnionOptions {
  bool outer_only = false;     ///< everything that is enclosed is solid: hollows, and rooms between walls
  bool keeps_open = false;     ///< components with borders stay as they are, if they are apart from the others
  double sheet_gap_world = 0;  ///< between sheets of the result that would share an edge
  bool own_faces = false;      ///< a component is cut along itself, too, where its own faces meet
  double near_world = 0;       ///< what is nearer is made one; so is what is nearer than 2^-21 of the longest side
};

/// What was found among the components of a surface, and changed.
struct UnionReport {
  int64_t turned_components = 0;     ///< looked inward, or all did; turned
  int64_t swallowed_components = 0;  ///< wholly inside of solid; dropped
  int64_t inner_surfaces = 0;        ///< boundaries of hollows, kept
  int64_t dropped_inner = 0;         ///< components in others, dropped where only outer ones are wanted
  int64_t cut_faces = 0;             ///< meet another component; cut along it, and what lies inside dropped
  int64_t internal_faces = 0;        ///< pieces of walls between parts that touch; dropped
  int64_t separated_edges = 0;       ///< of more than two faces, where sheets were moved apart
  int64_t left_components = 0;       ///< open, and apart from those that were united
  std::string given_up;              ///< why components that meet were not united; empty otherwise
  std::optional<WorldPoint> at;      ///< where they meet then, if it is known

  bool changed_anything() const {
    return turned_components + swallowed_components + dropped_inner + cut_faces + internal_faces + separated_edges > 0;
  }
};

struct UnitedSoup {
  TriangleSoup soup;
  std::vector<std::array<WorldPoint, 2>> interfaces;  ///< its edges where walls between parts that touch met it
};

/// The faces that bound the union of a soup's components, cut where these meet. Components of faces that are connected
/// through edges are solids: they wind once around what they enclose, where they look outward; one that looks inward
/// and lies in no other is turned first, all are when their volumes sum up to less than nothing, and one that looks
/// inward in another bounds a hollow of it. Solid is where all wind more than 0 times in all; so rooms that walls
/// enclose stay. Where edges have more than two faces, whose sums are no closed surfaces, a component encloses what
/// some of its faces look away from. The cuts are those of arrange_faces(), of near_world. Faces that pass through
/// others of their own component count as many times as they are around a place. Sheets of the union that would share
/// an edge, of four faces or more, are moved into their solids there by sheet_gap_world each, so that the result is
/// closed, and every edge has two faces. A soup in which nothing changes comes back as it is; so does one with a
/// component that is open or whose faces do not agree, unless those with borders are to be kept, and one that cannot be
/// united, of which the report says why. Throws: interrupted. Result: independent of threads. Cost: for n components
/// sorts of the faces log n times, and the cuts.
UnitedSoup boolean_union(const TriangleSoup& soup, const UnionOptions& options, UnionReport& report,
                         const Context& context);

}  // namespace isoshell
