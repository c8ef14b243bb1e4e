#include "features/curves/face_normals.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "features/mesh/remove_slivers.h"

namespace isoshell {
namespace {

constexpr WorldPoint kNoNormal{0, 0, 0};

WorldPoint doubled_area_of(const FeatureMesh& mesh, size_t t) {
  const auto& c = mesh.triangles[t];
  return doubled_area(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]);
}

double edge_length_sq(const FeatureMesh& mesh, const FeatureEdge& e) {
  return distance_sq(mesh.vertices[e.end[0]], mesh.vertices[e.end[1]]);
}

/// The normal on the other side of the longest edge; of any edges the longest one that has a normal there.
WorldPoint neighbours_normal(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                             uint32_t face, bool of_any_edge) {
  WorldPoint best = kNoNormal;
  double longest_sq = 0;
  for (const uint32_t e : edges.of_triangle[face]) {
    const WorldPoint n = edges.is_inner(e) ? normals[edges.across(e, face)] : kNoNormal;
    const double length_sq = edge_length_sq(mesh, edges.edges[e]);
    if ((of_any_edge && !has_normal(n)) || length_sq <= longest_sq) continue;
    longest_sq = length_sq;
    best = n;
  }
  return best;
}

/// Thin triangles take the normal beside their longest edge, from triangle to triangle; where none is there, as in a
/// ring of thin ones, that of another edge. A round only sees the normals of the rounds before.
void borrow_normals(const FeatureMesh& mesh, const MeshEdges& edges, std::vector<uint32_t> thin,
                    View<WorldPoint> normals) {
  const auto lacks_normal = [&](uint32_t t) { return !has_normal(normals[t]); };
  std::vector<uint32_t> next = thin;
  for (bool of_any_edge = false;;) {
    std::vector<std::pair<uint32_t, WorldPoint>> found;
    for (const uint32_t t : next) {
      const WorldPoint n = neighbours_normal(mesh, edges, normals, t, of_any_edge);
      if (has_normal(n)) found.push_back({t, n});
    }
    if (found.empty() && of_any_edge) return;
    next.clear();
    for (const auto& [t, n] : found) normals[t] = n;
    for (const auto& [t, n] : found)
      for (const uint32_t e : edges.of_triangle[t])
        if (edges.is_inner(e) && lacks_normal(edges.across(e, t))) next.push_back(edges.across(e, t));
    std::sort(next.begin(), next.end());
    next.erase(std::unique(next.begin(), next.end()), next.end());
    of_any_edge = next.empty();
    if (!of_any_edge) continue;
    thin.erase(std::stable_partition(thin.begin(), thin.end(), lacks_normal), thin.end());
    next = thin;
  }
}

}  // namespace

Buffer<WorldPoint> face_normals(const FeatureMesh& mesh, const MeshEdges& edges) {
  const double least_height = least_height_world(mesh);
  Buffer<WorldPoint> normals(int64_t(mesh.triangles.size()));
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& c = mesh.triangles[t];
    const WorldPoint &a = mesh.vertices[c[0]], &b = mesh.vertices[c[1]], &d = mesh.vertices[c[2]];
    const double longest_sq = std::max({distance_sq(a, b), distance_sq(b, d), distance_sq(d, a)});
    const WorldPoint across = doubled_area_of(mesh, t);
    const double doubled = length(across);
    normals[int64_t(t)] = doubled > least_height * std::sqrt(longest_sq) ? (1 / doubled) * across : kNoNormal;
  });
  std::vector<uint32_t> thin;
  for (uint32_t t = 0; t < normals.size(); ++t)
    if (!has_normal(normals[t])) thin.push_back(t);
  borrow_normals(mesh, edges, std::move(thin), normals.view());
  return normals;
}

double turn_of_degrees(double degrees) {
  // The series of 1 - cos at a quarter of the angle, where it converges fast, then twice doubled.
  const double x = degrees / 180 * 3.14159265358979323846 / 4;
  double term = x * x / 2, turn = 0;
  for (int k = 2; k < 20; k += 2) {
    turn += term;
    term *= -x * x / double((k + 1) * (k + 2));
  }
  for (int twice = 0; twice < 2; ++twice) turn = 2 * turn * (2 - turn);
  return turn;
}

}  // namespace isoshell
