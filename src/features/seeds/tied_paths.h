// Paths at opposite sides of a periodic volume get the same seeds.
#pragma once

#include <array>
#include <vector>

#include "features/mesh/refine_mesh.h"

namespace isoshell {

class TiedPaths {
 public:
  /// `period_q8`: along each axis from one side to the opposite one; 0 where the volume is not periodic, and a mesh
  /// that is not as long has no such sides.
  TiedPaths(const FineMesh& mesh, const WorldPoint& period_q8);

  /// Vertices of both sides aim at the shorter of their edge lengths.
  void share_lengths(FineMesh& mesh) const;
  /// The second one of two sides gets the seeds of the first one. Corners are opposite to corners.
  void share_seeds(FineMesh& mesh) const;

 private:
  std::vector<std::vector<std::array<uint32_t, 2>>>
      pairs_;  ///< per periodic axis vertices of paths: first side, second
};

}  // namespace isoshell
