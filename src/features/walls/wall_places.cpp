// WallPlaces (see wall_places.h).
#include "features/walls/wall_places.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isoshell/advanced/voxel_set.h"
#include "voxel/closest_point.h"

namespace isoshell {

std::optional<RegionVertex> WallPlaces::on_surface_near(const RegionVertex& from, const WorldPoint& near) const {
  RegionVertex out = from;
  out.home = mesh_.lookup().nearest_from(from.home, near);
  if (cut_.place[out.home] != kNone) return {};
  const SurfaceMesh& surface = cut_.surface;
  double nearest = std::numeric_limits<double>::infinity();
  for (int64_t n = surface.vertex_first[out.home]; n < surface.vertex_first[out.home + 1]; ++n) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
    const PointQ8 at =
        closest_point_on_triangle(rounded(near), surface.position[t.a], surface.position[t.b], surface.position[t.c]);
    const WorldPoint there{double(at.x), double(at.y), double(at.z)};
    if (const double d = distance_sq(there, near); d < nearest) nearest = d, out.position = there;
  }
  return out;
}

double WallPlaces::way_to(uint32_t next, const RegionVertex& from) const {
  const RegionVertex& to = mesh_.vertex(next);
  const CutCurve& curve = cut_.curves[from.curve];
  const double here = curve.at_q8[from.at], half = curve.length_q8 / 2;
  if (to.kind == RegionVertex::Kind::corner) {
    const uint32_t place = cut_.place[to.home];
    const bool is_first = curve.place.front() == place, is_last = curve.place.back() == place;
    return (is_last && (!is_first || here > half) ? curve.length_q8 : 0) - here;
  }
  const double way = curve.at_q8[to.at] - here;
  if (!curve.is_loop || std::abs(way) <= half) return way;
  return way > 0 ? way - curve.length_q8 : way + curve.length_q8;
}

RegionVertex WallPlaces::along(const RegionVertex& from, double way_q8) const {
  const CutCurve& curve = cut_.curves[from.curve];
  const std::vector<double>& at = curve.at_q8;
  double wanted = at[from.at] + way_q8;
  if (curve.is_loop && wanted < 0) wanted += curve.length_q8;
  if (curve.is_loop && wanted >= curve.length_q8) wanted -= curve.length_q8;
  auto i = size_t(std::lower_bound(at.begin(), at.end(), wanted) - at.begin());
  if (i == at.size() || (i > 0 && wanted - at[i - 1] < at[i] - wanted)) --i;
  if (!curve.is_loop) i = std::min(std::max(i, size_t(1)), at.size() - 2);
  RegionVertex out = from;
  out.at = i;
  out.home = mesh_.lookup().home_on(from.curve, i);
  out.position = mesh_.lookup().position(out.home);
  return out;
}

}  // namespace isoshell
