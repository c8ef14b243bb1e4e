// How steady a frame is (see previous_frame.h).
#include <algorithm>
#include <cmath>
#include <iterator>

#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/previous_frame.h"
#include "sequence/mean_edge_length.h"

namespace isoshell {
namespace {

constexpr double kFarthestOfOld = 0.9;  ///< mean edge lengths from where a vertex went; beyond, it is another one

/// Each edge once, the smaller vertex in the high half.
std::vector<uint64_t> edges_of(const std::vector<std::array<uint32_t, 3>>& triangles) {
  std::vector<uint64_t> edges;
  edges.reserve(3 * triangles.size());
  for (const std::array<uint32_t, 3>& t : triangles)
    for (size_t c = 0; c < 3; ++c) edges.push_back(edge_key(t[c], t[(c + 1) % 3]));
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

}  // namespace

std::vector<uint8_t> born_vertices(const PreviousFrame& previous, const TriangleMesh& mesh) {
  const double reach = kFarthestOfOld * mean_edge_length(mesh);
  std::vector<uint8_t> born(mesh.vertices.size(), 1);
  for (size_t v = 0; v < std::min(born.size(), previous.carried.size()); ++v)
    born[v] = !(distance_sq(mesh.vertices[v], previous.carried[v]) < reach * reach);
  return born;
}

void measure_coherence(const PreviousFrame& previous, const TriangleMesh& mesh, CoherenceReport& report) {
  const std::vector<uint8_t> born = born_vertices(previous, mesh);
  report.born = std::count(born.begin(), born.end(), uint8_t(1));
  double sum = 0;
  for (size_t v = 0; v < born.size(); ++v)
    if (!born[v]) sum += distance_sq(mesh.vertices[v], previous.carried[v]);
  const int64_t others = int64_t(born.size()) - report.born;
  report.excess = others > 0 ? std::sqrt(sum / double(others)) / mean_edge_length(mesh) : 0;
  const std::vector<uint64_t> edges = edges_of(mesh.triangles), before = edges_of(previous.triangles);
  std::vector<uint64_t> kept;
  std::set_intersection(edges.begin(), edges.end(), before.begin(), before.end(), std::back_inserter(kept));
  report.kept_edges_pct = edges.empty() ? 0 : 100 * double(kept.size()) / double(edges.size());
}

}  // namespace isoshell
