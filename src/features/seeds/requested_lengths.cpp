// See requested_lengths.h.
#include "features/seeds/requested_lengths.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/parallel_ranges.h"
#include "features/seeds/edge_lengths.h"
#include "features/seeds/length_limits.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr int kSmoothing = 8;  ///< rounds that spread curvature
constexpr double kTurnUnit = 1 << 16;
constexpr double kAreaUnit = 1 << 6;

/// Per vertex how far the surface turns within e. Smooth between paths; on them as beside them, where it turns most, so
/// that a rim is as fine as the finer of its sides. Sums of integers: no order shows.
std::vector<int64_t> smooth_turns(const FineMesh& mesh, const VertexGraph& graph, double e) {
  const std::vector<double> turns = surface_turns(mesh, graph, e);
  std::vector<char> is_on_path(mesh.position.size(), 0);
  for (const CurvePath& path : mesh.paths)
    for (const uint32_t v : path.vertex) is_on_path[v] = 1;
  std::vector<int64_t> turn(turns.size());
  for (size_t v = 0; v < turn.size(); ++v) turn[v] = std::llround(turns[v] * kTurnUnit);
  std::vector<int64_t> next = turn;
  for (int round = 0; round <= kSmoothing; ++round) {
    const bool is_last = round == kSmoothing;
    for_each_index(size_t(0), turn.size(), [&](size_t v) {
      if (bool(is_on_path[v]) != is_last) return;
      int64_t sum = turn[v], count = 1, most = 0;
      graph.for_each(int64_t(v), [&](uint32_t u, double) {
        if (is_on_path[u]) return;
        sum += turn[u];
        ++count;
        most = std::max(most, turn[u]);
      });
      next[v] = is_last ? most : sum / count;
    });
    turn = next;
  }
  return turn;
}

/// Over the area.
double mean_turn(const FineMesh& mesh, const std::vector<int64_t>& turn) {
  int64_t sum = 0, area = 0;
  for (const auto& t : mesh.triangles) {
    const int64_t here =
        std::llround(triangle_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]) / kAreaUnit);
    area += here;
    sum += here * ((turn[t[0]] + turn[t[1]] + turn[t[2]]) / 3);
  }
  return area > 0 ? double(sum) / double(area) : 0;
}

/// A part of the vertices, `adaptivity`, goes by curvature instead of area.
void shorten_where_curved(FineMesh& mesh, const VertexGraph& graph, double adaptivity, double e) {
  const std::vector<int64_t> turn = smooth_turns(mesh, graph, e);
  const double mean = mean_turn(mesh, turn);
  if (!(mean > 0)) return;
  for (size_t v = 0; v < turn.size(); ++v)
    mesh.edge_length[v] /= std::sqrt(std::max(1 - adaptivity + adaptivity * double(turn[v]) / mean, kLeastDensity));
}

/// A vertex has the shortest length of the faces around it; those that have none have what they had.
void set_lengths_of_faces(const std::vector<double>& of_face, FineMesh& mesh) {
  std::vector<double> least(mesh.position.size(), std::numeric_limits<double>::infinity());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const double length = of_face[mesh.source_face[t]];
    for (const uint32_t v : mesh.triangles[t]) least[v] = std::min(least[v], length > 0 ? length : mesh.edge_length[v]);
  }
  mesh.edge_length = std::move(least);
}

}  // namespace

void ask_for_lengths(FineMesh& mesh, const VertexGraph& graph, const LatticeFrame& frame,
                     const RequestedLengths& requested, int64_t vertices, double e) {
  const double of_world = kOneVoxelQ8 / frame.voxel_size;
  mesh.edge_length.assign(mesh.position.size(), requested.usual_world * of_world);
  if (requested.field) {
    std::vector<WorldPoint> points;
    points.reserve(mesh.position.size());
    for (const WorldPoint& p : mesh.position) points.push_back(frame.origin + (1 / of_world) * p);
    const std::vector<double> length = requested.field->lengths_at(points);
    for (size_t v = 0; v < length.size(); ++v)
      if (length[v] > 0) mesh.edge_length[v] = length[v] * of_world;
  }
  if (!requested.of_face_world.empty()) {
    std::vector<double> of_face = requested.of_face_world;
    for (double& l : of_face) l *= of_world;
    set_lengths_of_faces(of_face, mesh);
  }
  if (requested.adaptivity > 0) shorten_where_curved(mesh, graph, requested.adaptivity, e);
  double factor = 1;
  if (vertices > 0) factor = std::sqrt(std::max(1.0, vertices_of_lengths(mesh)) / double(vertices));
  for (double& l : mesh.edge_length) l = std::max(l * factor, requested.shortest_world * of_world);
  const double most = kMostLengthRatio * *std::min_element(mesh.edge_length.begin(), mesh.edge_length.end());
  for (double& l : mesh.edge_length) l = std::min(l, most);
}

}  // namespace isoshell
