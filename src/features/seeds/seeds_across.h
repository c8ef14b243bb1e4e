// What the seeds of curves on the far sides of strips ask of a curve's own.
#pragma once

#include "features/seeds/facing_curves.h"

namespace isoshell {

/// Per path, where others run along it within about an edge length.
class SeedsAcross {
 public:
  SeedsAcross(const FineMesh& mesh, const std::vector<FacingVertices>& facing);

  /// Whether there are any.
  bool beside(size_t path) const { return first_[path] < first_[path + 1]; }

  /// The paths that others run along, each after one that it runs along, as far as that is possible: in groups that run
  /// along none of another group.
  std::vector<std::vector<size_t>> groups() const;

  /// Calls visit(other) for those that run along a path, some more than once.
  template <class Visit>
  void for_each_beside(size_t path, Visit visit) const {
    for (size_t s = first_[path]; s < first_[path + 1]; ++s) visit(sides_[s].other);
  }

  /// How much a seed at a point of a path faces seeds across strips, where it belongs between two of them: 0 to 1 a
  /// strip, less where the strip is so wide that it has seeds of its own.
  double cost(const FineMesh& mesh, size_t path, const PathPoint& point, const WorldPoint& position) const;

 private:
  struct Side {
    uint32_t path, index;  ///< a vertex of the path
    uint32_t other;        ///< the path across
    uint32_t other_index;  ///< the vertex of that one
  };
  std::vector<size_t> first_;  ///< per path, and one more: offsets into sides_
  std::vector<Side> sides_;    ///< by path, index, other; one each
};

}  // namespace isoshell
