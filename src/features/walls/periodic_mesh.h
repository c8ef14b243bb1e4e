// What is done to give opposite sides of a periodic volume the same triangles.
#pragma once

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

#include "features/angles/cut_lookup.h"
#include "features/mesh/editable_mesh.h"
#include "features/walls/side_places.h"

namespace isoshell {

/// The mesh of a periodic volume. Sides are numbered as in FaceRegions: of two opposite ones the low one is changed
/// least, and the high one gets its triangles.
class PeriodicMesh : public EditableMesh {
 public:
  PeriodicMesh(const CutLookup& lookup, EditableMesh mesh);

  const PeriodicSides& sides() const { return sides_; }
  bool is_used(uint32_t v) const { return !around(v).empty(); }
  bool is_on_side(uint32_t v, int side) const;

 protected:
  /// A vertex of a curve, or the place that one belongs to.
  struct OnCurve {
    size_t at;
    uint32_t vertex;
    WorldPoint position;  ///< where it is to be

    bool operator<(const OnCurve& o) const { return at != o.at ? at < o.at : vertex < o.vertex; }
  };

  const PlacesOfSide& places(int side) const { return places_[size_t(side - 1)]; }
  bool is_end(uint32_t curve, size_t at) const;
  bool is_beside(uint32_t curve, int side) const;
  /// Whether triangles are left beside it that are no copies of others.
  bool is_alive(uint32_t curve) const;
  /// The vertices inside of each curve, in their order, and those at corners by their place.
  void list_vertices();
  const std::vector<OnCurve>& on_curve(uint32_t curve) const { return on_curve_[curve]; }
  void note_put_in(uint32_t curve, const OnCurve& v);
  void note_taken_away(uint32_t curve, uint32_t v);
  /// kNone where there is none.
  uint32_t corner_at(uint32_t place) const;

  const CutLookup& lookup_;
  const CutSurface& cut_;

 private:
  const PeriodicSides sides_;
  std::vector<PlacesOfSide> places_;  ///< per side, from 1 on
  std::vector<std::vector<OnCurve>> on_curve_;
  std::map<uint32_t, uint32_t> at_corner_;  ///< by place
};

/// Curves on high sides get the vertices of those on low ones: edges are split and collapsed and vertices moved there,
/// and where a vertex cannot go, the low side gets one, too. High sides have no triangles then.
PeriodicMesh with_matched_curves(PeriodicMesh mesh);

/// High sides get the triangles of low ones, and vertices of both are fixed. Throws: usage where curves have not the
/// same vertices.
EditableMesh with_copied_sides(PeriodicMesh mesh);

}  // namespace isoshell
