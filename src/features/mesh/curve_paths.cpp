// curve_paths (see curve_paths.h).
#include "features/mesh/curve_paths.h"

#include <algorithm>
#include <map>
#include <string>

#include "geometry/world_vector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr double kWindow = 4;        ///< edge lengths, within which a jagged path turns back
constexpr double kLeastTurn = 0.35;  ///< an edge length: a circle of three edge lengths turns as much
constexpr double kMostLeft = 0.5;    ///< of all turns, once those of a window are summed

/// How many edges a curve has.
std::vector<uint64_t> edges_of(const CurveNetwork& network, size_t vertices) {
  std::vector<uint64_t> edges;
  for (const FeatureCurve& curve : network.curves) {
    if (curve.vertex.size() < (curve.is_loop ? 3 : 2))
      throw Error(ErrorCode::usage, "features",
                  "a curve has " + std::to_string(curve.vertex.size()) + " vertices; it must have 2, a loop 3");
    for (const uint32_t v : curve.vertex)
      if (v >= vertices)
        throw Error(ErrorCode::usage, "features",
                    "a curve has vertex " + std::to_string(v) + ", the mesh has " + std::to_string(vertices) +
                        "; find the curves on this very mesh");
    append_edges(curve, edges);
  }
  std::sort(edges.begin(), edges.end());
  const auto twice = std::adjacent_find(edges.begin(), edges.end());
  if (twice != edges.end())
    throw Error(ErrorCode::usage, "features",
                "the edge between vertices " + std::to_string(*twice >> 32) + " and " +
                    std::to_string(uint32_t(*twice)) + " is on curves twice; it may be on one");
  return edges;
}

/// Per vertex whether a border of the cut mesh comes along an edge, turns around the vertex and goes back along it.
std::vector<char> turning_vertices(const MeshTriangles& triangles, int64_t vertices,
                                   const std::vector<uint64_t>& cut_edges) {
  const MeshFans fans = find_fans(triangles, vertices, cut_edges);
  std::vector<uint64_t> leaving(fans.vertex.size(), 0);  // no edge has the key 0
  for (const uint32_t h : fans.cut)
    leaving[fans.of_corner[h]] = edge_key(triangles[h / 3][h % 3], triangles[h / 3][(h + 1) % 3]);
  std::vector<char> turns(size_t(vertices), 0);
  for (const uint32_t h : fans.cut) {
    const uint32_t end = triangles[h / 3][(h + 1) % 3];
    if (leaving[fans.of_corner[h / 3 * 3 + (h + 1) % 3]] == edge_key(triangles[h / 3][h % 3], end)) turns[end] = 1;
  }
  return turns;
}

/// The vertices of a curve cut at corners; a loop with a corner begins and ends there.
std::vector<std::vector<uint32_t>> parts_between_corners(const FeatureCurve& curve,
                                                         const std::vector<char>& is_corner) {
  std::vector<uint32_t> along = curve.vertex;
  if (curve.is_loop) {
    const auto first = std::find_if(along.begin(), along.end(), [&](uint32_t v) { return is_corner[v] != 0; });
    if (first == along.end()) return {along};
    std::rotate(along.begin(), first, along.end());
    along.push_back(along.front());
  }
  std::vector<std::vector<uint32_t>> parts{{along.front()}};
  for (size_t i = 1; i < along.size(); ++i) {
    parts.back().push_back(along[i]);
    if (is_corner[along[i]] && i + 1 < along.size()) parts.push_back({along[i]});
  }
  return parts;
}

void find_least_segments(const std::vector<char>& turns, std::vector<CurvePath>& paths) {
  std::map<uint64_t, int> between;
  for (const CurvePath& path : paths)
    if (!path.is_loop) ++between[edge_key(path.vertex.front(), path.vertex.back())];
  for (CurvePath& path : paths) {
    const uint32_t first = path.vertex.front(), last = path.vertex.back();
    if (path.is_loop || first == last)
      path.least_segments = 3;
    else if (between[edge_key(first, last)] > 1 || (turns[first] && turns[last]))
      path.least_segments = 2;  // a slit with two ends has two sides between the same corners
  }
}

/// Along the axis, as long as the distance between the two directions.
WorldPoint turn_chord(const WorldPoint& before, const WorldPoint& after) {
  const WorldPoint axis = cross(before, after);
  const double a = length(before), b = length(after), size = length(axis);
  if (!(a > 0 && b > 0 && size > 0)) return {0, 0, 0};
  return (length((1 / b) * after - (1 / a) * before) / size) * axis;
}

bool is_jagged(const std::vector<WorldPoint>& position, double edge_length, const CurvePath& path) {
  const size_t n = path.vertex.size(), margin = path.is_loop ? 0 : 1;
  double all = 0, left = 0, window_end = kWindow * edge_length;
  WorldPoint sum{0, 0, 0};
  for (size_t i = margin; i + margin < n; ++i) {
    if (path.at[i] > window_end) {
      left += length(sum);
      sum = {0, 0, 0};
      window_end = path.at[i] + kWindow * edge_length;
    }
    const WorldPoint& here = position[path.vertex[i]];
    const WorldPoint turn =
        turn_chord(here - position[path.vertex[(i + n - 1) % n]], position[path.vertex[(i + 1) % n]] - here);
    all += length(turn);
    sum = sum + turn;
  }
  left += length(sum);
  return all > kLeastTurn * path.length / edge_length && left < kMostLeft * all;
}

}  // namespace

void append_edges(const FeatureCurve& curve, std::vector<uint64_t>& edges) {
  const size_t count = curve.vertex.size();
  for (size_t i = 0; i + (curve.is_loop ? 0 : 1) < count; ++i)
    edges.push_back(edge_key(curve.vertex[i], curve.vertex[(i + 1) % count]));
}

std::vector<uint64_t> path_edges(const std::vector<CurvePath>& paths) {
  std::vector<uint64_t> edges;
  for (const CurvePath& path : paths)
    for (size_t i = 0; i < path.edge_count(); ++i) edges.push_back(edge_key(path.vertex[i], path.edge_end(i)));
  std::sort(edges.begin(), edges.end());
  return edges;
}

void measure_path(const std::vector<WorldPoint>& position, CurvePath& path) {
  path.at.clear();
  path.length = 0;
  for (size_t i = 0; i < path.vertex.size(); ++i) {
    path.at.push_back(path.length);
    if (i < path.edge_count()) path.length += length(position[path.edge_end(i)] - position[path.vertex[i]]);
  }
}

double length_of(const std::vector<WorldPoint>& position, const FeatureCurve& curve) {
  CurvePath path;
  path.vertex = curve.vertex;
  path.is_loop = curve.is_loop;
  measure_path(position, path);
  return path.length;
}

std::vector<CurvePath> curve_paths(const std::vector<WorldPoint>& position, const MeshTriangles& triangles,
                                   const CurveNetwork& network) {
  const std::vector<char> turns =
      turning_vertices(triangles, int64_t(position.size()), edges_of(network, position.size()));
  std::vector<char> is_corner = turns;
  for (const uint32_t v : network.corners) is_corner[v] = 1;
  for (const FeatureCurve& curve : network.curves)
    if (!curve.is_loop) is_corner[curve.vertex.front()] = is_corner[curve.vertex.back()] = 1;

  std::vector<CurvePath> paths;
  for (size_t c = 0; c < network.curves.size(); ++c)
    for (std::vector<uint32_t>& part : parts_between_corners(network.curves[c], is_corner)) {
      CurvePath path;
      path.curve = uint32_t(c);
      path.kind = network.curves[c].kind;
      path.is_loop = network.curves[c].is_loop && !is_corner[part.front()];
      path.vertex = std::move(part);
      measure_path(position, path);
      paths.push_back(std::move(path));
    }
  find_least_segments(turns, paths);
  return paths;
}

void find_jagged_paths(const std::vector<WorldPoint>& position, double edge_length, std::vector<CurvePath>& paths) {
  for (CurvePath& path : paths)
    path.is_jagged = (path.kind == CurveKind::border || path.kind == CurveKind::non_manifold) &&
                     is_jagged(position, edge_length, path);
}

}  // namespace isoshell
