// Where a result intersects itself and must not.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "features/cutting/cut_surface.h"
#include "measure/box_tree.h"
#include "pipeline/grid/prepared_surface.h"

namespace isoshell {

using TrianglePairs = std::vector<std::array<uint32_t, 2>>;

/// All pairs of triangles of a mesh that intersect on the lattice. Cost: as crossing_pairs.
TrianglePairs crossings_of(const FeatureMesh& mesh, const LatticeFrame& frame, const Context& context);

/// A result that is open may intersect itself where the input's triangles do, to within an edge; no other may. The
/// input must outlive it, and is looked at only where a result intersects. In host memory. Cost: as crossing_pairs.
class NewCrossings {
 public:
  NewCrossings(const PreparedSurface& p, const CutSurface& cut, Context& context);

  /// Whether any may.
  bool may_be_old() const { return may_be_old_; }
  /// All pairs of triangles that intersect. `joined`: as of crossing_pairs.
  TrianglePairs all(const DualMesh& mesh, View<const uint32_t> joined) const;
  /// Of these the ones that must not.
  TrianglePairs wrong_of(const DualMesh& mesh, const TrianglePairs& pairs);

 private:
  const PreparedSurface& p_;
  Context& context_;
  bool may_be_old_;  ///< the result is open as the input is
  int32_t edge_q8_;
  std::optional<std::vector<BoxQ8>> of_input_;
};

}  // namespace isoshell
