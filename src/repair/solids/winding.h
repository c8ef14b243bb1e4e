// Which faces a ray along x crosses beyond a point: sums over them are winding numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "core/buckets.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Faces in columns along x. Ties are broken the same way for every face, as if points were moved a little, so the
/// crossings of a closed surface always sum up to an integer that is right next to the point asked for.
class RayColumns {
 public:
  RayColumns(const std::vector<WorldPoint>& points, const std::vector<std::array<uint32_t, 3>>& faces);

  /// Calls visit(face, sign) for each face but `own` that the ray from p towards larger x crosses: 1 where it leaves
  /// through the outer side, -1 where it enters. A face through p itself counts when its index is larger than own's.
  template <class Visit>
  void for_each_crossing(const WorldPoint& p, uint32_t own, Visit visit) const {
    for_each_crossing(
        p, own, [](uint32_t) { return true; }, visit);
  }
  /// The same for faces that count only.
  template <class Counts, class Visit>
  void for_each_crossing(const WorldPoint& p, uint32_t own, Counts counts, Visit visit) const {
    for (const uint32_t face : in_column_.in(column_of(p.y, 0) * cells_[1] + column_of(p.z, 1))) {
      if (face == own || !counts(face)) continue;
      if (const int sign = crossing(p, own, face)) visit(face, sign);
    }
  }

 private:
  int64_t column_of(double at, int axis) const;
  struct Columns {
    int64_t y0, y1, z0, z1;
    int64_t count() const { return (y1 - y0 + 1) * (z1 - z0 + 1); }
  };
  Columns columns_of(const std::array<uint32_t, 3>& face) const;
  int crossing(const WorldPoint& p, uint32_t own, uint32_t face) const;
  template <class Each>
  void for_each_column(const std::array<uint32_t, 3>& face, Each each) const;

  const std::vector<WorldPoint>& points_;
  const std::vector<std::array<uint32_t, 3>>& faces_;
  double least_[2], cell_[2];
  int64_t cells_[2];
  Buckets<uint32_t> in_column_;
};

}  // namespace isoshell
