// See tie_corners.h.
#include "features/curves/tie_corners.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <set>
#include <utility>

namespace isoshell {
namespace {

constexpr double WorldPoint::*kAxes[3] = {&WorldPoint::x, &WorldPoint::y, &WorldPoint::z};
constexpr double kRounding = 1e-9;  ///< of a period

/// Vertices of curves at the ends of a period that are opposite to each other: coordinates along the sides are the
/// same.
std::vector<std::array<uint32_t, 2>> opposite_vertices(const FeatureMesh& mesh, const CurveNetwork& network,
                                                       size_t axis, double period) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const WorldPoint& p : mesh.vertices) low = std::min(low, p.*kAxes[axis]), high = std::max(high, p.*kAxes[axis]);
  if (std::abs(high - low - period) > kRounding * period) return {};
  std::map<std::pair<double, double>, std::array<std::set<uint32_t>, 2>> at;
  for (const FeatureCurve& curve : network.curves)
    for (const uint32_t v : curve.vertex) {
      const WorldPoint& p = mesh.vertices[v];
      const double along = p.*kAxes[axis];
      if (along == low || along == high)
        at[{p.*kAxes[(axis + 1) % 3], p.*kAxes[(axis + 2) % 3]}][along == high].insert(v);
    }
  std::vector<std::array<uint32_t, 2>> pairs;
  for (const auto& [place, ends] : at)
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

void tie_corners(const FeatureMesh& mesh, const WorldPoint& period_world, CurveNetwork& network) {
  std::vector<std::array<uint32_t, 2>> pairs;
  for (size_t axis = 0; axis < 3; ++axis)
    if (const double period = period_world.*kAxes[axis]; period != 0)
      for (const auto& pair : opposite_vertices(mesh, network, axis, period)) pairs.push_back(pair);
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
