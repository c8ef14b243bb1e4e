// Where the curves of one side of a periodic volume lie on the opposite side.
#pragma once

#include <array>
#include <optional>
#include <unordered_map>
#include <vector>

#include "features/cutting/cut_surface.h"
#include "geometry/world_vector.h"

namespace isoshell {

/// The periodic sides of a cut surface: 1 to 6 as in FaceRegions.
class PeriodicSides {
 public:
  explicit PeriodicSides(const CutSurface& cut);

  /// Of a patch; 0: it is on none.
  int of_patch(uint32_t patch) const { return of_patch_[patch]; }
  bool is_high(uint32_t patch) const { return of_patch_[patch] > 0 && of_patch_[patch] % 2 == 0; }
  /// Whether a side is there.
  bool has(int side) const { return plane_q8_[size_t(side)].has_value(); }
  /// The point of a side's plane that is nearest to one.
  WorldPoint on_plane(int side, WorldPoint p) const;
  /// A point, or for one beyond a plane the nearest one before it.
  WorldPoint within(WorldPoint p) const;
  /// A point in planes, so far from them.
  WorldPoint inside(WorldPoint p, double way_q8) const;
  /// Whether a triangle lies in one of the planes.
  bool hold(const std::array<WorldPoint, 3>& corners) const;
  /// From the low side of an axis to its high one.
  WorldPoint period_q8(int axis) const;

 private:
  std::vector<uint8_t> of_patch_;
  std::array<std::optional<int32_t>, 7> plane_q8_;  ///< per side where it is along its axis
};

struct PlaceOnCurve {
  uint32_t curve;
  size_t at;  ///< into its places
};

/// The places of the curves around some patches, to be found by where they are.
class PlacesOfSide {
 public:
  PlacesOfSide(const CutSurface& cut, const PeriodicSides& sides, int side);

  /// The nearest one within half of an edge length; of several that are as near the first one along the first curve.
  std::optional<PlaceOnCurve> nearest(const WorldPoint& to) const;

 private:
  std::array<int64_t, 3> cell_of(const WorldPoint& p) const;

  const CutSurface& cut_;
  double cell_q8_;
  std::unordered_map<uint64_t, std::vector<PlaceOnCurve>> in_cell_;
};

}  // namespace isoshell
