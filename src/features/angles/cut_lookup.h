// What changes of a result ask of the surface below it, over and over.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "features/cutting/cut_surface.h"
#include "features/mesh/editable_mesh.h"
#include "geometry/world_vector.h"

namespace isoshell {

class CutLookup {
 public:
  /// Finds where curves bend, in parallel. `cut` must outlive it.
  explicit CutLookup(const CutSurface& cut);

  const CutSurface& cut() const { return *cut_; }
  WorldPoint position(uint32_t home) const;
  /// What is at a vertex of the surface: a corner or a place of a curve on borders.
  RegionVertex vertex_at(uint32_t home) const;
  /// At a place of a curve; beyond the last one of a loop it goes on with the first.
  RegionVertex on_curve_at(uint32_t curve, size_t at) const;
  /// The point of the surface that is nearest to one, in the triangles around the vertex of it that is. None where that
  /// is on a border.
  std::optional<RegionVertex> on_surface_near(const RegionVertex& from, const WorldPoint& near) const;
  /// From a vertex on a curve to the next one, along it, in lattice steps; negative towards its beginning.
  double way_between(const RegionVertex& from, const RegionVertex& to) const;
  /// The place of a curve that is nearest to so far from a vertex on it, no corner.
  RegionVertex along(const RegionVertex& from, double way_q8) const;
  uint32_t patch(uint32_t home) const { return cut_->surface.patch.empty() ? 0 : cut_->surface.patch[home]; }
  double edge_length(uint32_t home) const;
  /// The first copy of a place of a curve; beyond the last place of a loop it goes on with the first.
  uint32_t home_on(uint32_t curve, size_t at) const;
  /// Of several fans of one patch at a place the first one; kNone where there is none.
  uint32_t copy_in(uint32_t home, uint32_t patch) const;
  /// Between a unit vector and the normal of the surface of a patch; of several fans there the one that fits best.
  double cosine(uint32_t home, uint32_t patch, const WorldPoint& unit) const;
  /// Between the normal of a triangle and those of the surface at its corners, the least.
  double cosine(const EditableMesh& mesh, const RegionTriangle& t) const;
  /// Goes from a vertex to neighbours on the surface as long as these are nearer to a point.
  uint32_t nearest_from(uint32_t start, const WorldPoint& near) const;
  /// How far a curve leaves the chord between two of its places, to within a small part of an edge. Cost: a look at the
  /// bends between them, of which a straight curve has none however many places it has.
  double off_chord(uint32_t curve, size_t begin, size_t end) const;

 private:
  std::vector<size_t> bends_of(uint32_t curve) const;

  const CutSurface* cut_;
  std::vector<std::vector<size_t>> bends_;             ///< per curve, ascending; of loops those of two rounds
  std::vector<std::pair<uint32_t, size_t>> at_place_;  ///< per place a curve that it is on, and where on that
};

}  // namespace isoshell
