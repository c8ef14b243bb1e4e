// See tie_corners.h.
#include "features/curves/tie_corners.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <set>

namespace isoshell {
namespace {

using Place = std::array<int32_t, 3>;

Place place_of(const LatticeFrame& frame, const WorldPoint& world) {
  const PointQ8 p = frame.snap(world);
  return {p.x, p.y, p.z};
}

/// Vertices of curves at the two ends of a period that lie opposite to each other.
std::vector<std::array<uint32_t, 2>> opposite_vertices(const std::vector<Place>& place, const CurveNetwork& network,
                                                       size_t axis, int32_t period) {
  const auto less = [&](const Place& p, const Place& q) { return p[axis] < q[axis]; };
  const int32_t low = (*std::min_element(place.begin(), place.end(), less))[axis],
                high = (*std::max_element(place.begin(), place.end(), less))[axis];
  if (high - low != period) return {};
  std::map<Place, std::array<std::set<uint32_t>, 2>> at;
  for (const FeatureCurve& curve : network.curves)
    for (const uint32_t v : curve.vertex) {
      const bool is_high = place[v][axis] == high;
      if (!is_high && place[v][axis] != low) continue;
      Place along = place[v];
      along[axis] = 0;
      at[along][is_high].insert(v);
    }
  std::vector<std::array<uint32_t, 2>> pairs;
  for (const auto& [along, ends] : at)
    for (const uint32_t u : ends[0])
      for (const uint32_t v : ends[1]) pairs.push_back({u, v});
  return pairs;
}

/// With corners at these vertices, too.
void append_split(const FeatureCurve& curve, const std::set<uint32_t>& corners, std::vector<FeatureCurve>& out) {
  std::vector<uint32_t> vertex = curve.vertex;
  if (curve.is_loop) {
    const auto first = std::find_if(vertex.begin(), vertex.end(), [&](uint32_t v) { return corners.count(v) > 0; });
    if (first == vertex.end()) return out.push_back(curve);
    std::rotate(vertex.begin(), first, vertex.end());
    vertex.push_back(vertex.front());
  }
  for (size_t begin = 0, i = 1; i < vertex.size(); ++i) {
    if (i + 1 < vertex.size() && corners.count(vertex[i]) == 0) continue;
    out.push_back({curve.kind, false, {vertex.begin() + int64_t(begin), vertex.begin() + int64_t(i) + 1}});
    begin = i;
  }
}

}  // namespace

void tie_corners(const FeatureMesh& mesh, const LatticeFrame& frame, const WorldPoint& period_world,
                 CurveNetwork& network) {
  std::vector<Place> place;
  for (const WorldPoint& p : mesh.vertices) place.push_back(place_of(frame, p));
  const std::array<double, 3> period{period_world.x, period_world.y, period_world.z};
  std::vector<std::array<uint32_t, 2>> pairs;
  for (size_t axis = 0; axis < 3; ++axis) {
    if (period[axis] == 0) continue;
    const auto period_q8 = int32_t(std::lround(period[axis] / frame.voxel_size * kOneVoxelQ8));
    for (const auto& pair : opposite_vertices(place, network, axis, period_q8)) pairs.push_back(pair);
  }
  std::set<uint32_t> corners(network.corners.begin(), network.corners.end());
  for (size_t before = 0; before != corners.size();) {
    before = corners.size();
    for (const auto& [u, v] : pairs)
      if (corners.count(u) + corners.count(v) == 1) corners.insert({u, v});
  }
  if (corners.size() == network.corners.size()) return;
  std::vector<FeatureCurve> curves;
  for (const FeatureCurve& curve : network.curves) append_split(curve, corners, curves);
  network.curves = std::move(curves);
  network.corners = {corners.begin(), corners.end()};
}

}  // namespace isoshell
