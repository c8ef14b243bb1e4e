// What closed surfaces that lie in or pass through one another bound together, before anything is voxelised.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {

struct UnionOptions {
  bool outer_only = false;       ///< drop components that lie in others
  double finest_edge_world = 0;  ///< faces that another component cuts are split until their edges are this short
};

/// What was found among the components of a closed and oriented surface, and changed.
struct UnionReport {
  int64_t turned_components = 0;     ///< lay in no other and looked inward; turned
  int64_t swallowed_components = 0;  ///< wholly inside of solid; dropped
  int64_t inner_surfaces = 0;        ///< boundaries of hollows, kept
  int64_t dropped_inner = 0;         ///< components in others, dropped because only outer ones are wanted
  int64_t cut_faces = 0;             ///< pass through another component; split, and what lies inside dropped
  int64_t joined_components = 0;     ///< components of the union, where faces were cut

  bool changed_anything() const { return turned_components + swallowed_components + dropped_inner + cut_faces > 0; }
};

/// What came of joining closed components that pass through or touch each other as one mesh, which keeps creases.
struct JoinReport {
  std::string given_up;          ///< why they were not joined, though they meet; empty otherwise
  std::optional<WorldPoint> at;  ///< where they meet then, if it is known
  int64_t left_components = 0;   ///< open or looking inward, and apart from those that were joined
};

/// Result: the faces of a closed and oriented soup that bound the union of its components, by winding numbers: outside
/// of a component its number is 0, inside 1, or -1 when it looks inward, and a face stays where its outer side sums up
/// to 0. A component that looks inward and lies in no other is turned first, all are when their volumes sum up to less
/// than nothing. Faces that pass through another component are split; of their pieces those stay that lie in part
/// outside, so the result overlaps a little where it was cut and is closed only to within finest_edge_world. Components
/// that only touch stay as they are. A soup in which nothing changes comes back as it is. Cost: sorts of vertices and
/// faces, four rays a face, and where faces are cut about as many pieces as cuts are long in terms of
/// finest_edge_world.
TriangleSoup boolean_union(const TriangleSoup& soup, const UnionOptions& options, UnionReport& report,
                           const Context& context);

}  // namespace isoshell
