// A mesh of patches that was changed edge by edge, cut open again for stages that relax or optimise patches.
#pragma once

#include <utility>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "features/cutting/curve_edges.h"
#include "features/mesh/editable_mesh.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Every vertex off the free ones has a copy for each fan of triangles between curves there. In host memory.
class OpenMesh {
 public:
  /// `joined` must outlive it. Cost: sorts of its edges and vertices.
  OpenMesh(const EditableMesh& joined, const CutLookup& lookup);

  /// Vertices without triangles are left out. The copies are fixed seeds; which cells they have is left open.
  SeededMesh take() { return std::move(made_); }
  /// The joined mesh, with free vertices where those of take() have moved, and with the edges that were flipped.
  EditableMesh joined_again(const SeededMesh& optimized) const;

 private:
  void place_vertices(const CutLookup& lookup);

  const EditableMesh& joined_;
  CurveEdges curves_;
  std::vector<uint32_t> of_joined_, patch_;  ///< per vertex its own in the joined mesh, and its patch
  SeededMesh made_;
};

}  // namespace isoshell
