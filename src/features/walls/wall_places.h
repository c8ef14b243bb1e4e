// Where vertices of walls may go.
#pragma once

#include <optional>

#include "features/walls/wall_mesh.h"

namespace isoshell {

/// Places on the cut surface that walls are of, and on its curves.
class WallPlaces {
 public:
  explicit WallPlaces(const WallMesh& mesh) : mesh_(mesh), cut_(mesh.lookup().cut()) {}

  /// The point of the surface that is nearest to one, in the triangles around the vertex of it that is. None where that
  /// is on a border.
  std::optional<RegionVertex> on_surface_near(const RegionVertex& from, const WorldPoint& near) const;
  /// From a vertex on a curve to the next one, along it, in lattice steps; negative towards its beginning.
  double way_to(uint32_t next, const RegionVertex& from) const;
  /// The place of a curve that is nearest to so far from a vertex on it, no corner.
  RegionVertex along(const RegionVertex& from, double way_q8) const;

 private:
  const WallMesh& mesh_;
  const CutSurface& cut_;
};

}  // namespace isoshell
