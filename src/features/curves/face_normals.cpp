#include "features/curves/face_normals.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "geometry/box.h"

namespace isoshell {
namespace {

constexpr double kThinHeight = 1e-5;   // of the largest extent: what floats round is 100 times smaller
constexpr double kThinRoundings = 16;  // a triangle as high turns by 5 degrees where its vertices are rounded
constexpr int kThinRounds = 8;         // thin triangles in a row that get a normal

constexpr WorldPoint kNoNormal{0, 0, 0};

WorldPoint doubled_area_of(const FeatureMesh& mesh, size_t t) {
  const auto& c = mesh.triangles[t];
  return doubled_area(mesh.vertices[c[0]], mesh.vertices[c[1]], mesh.vertices[c[2]]);
}

double edge_length_sq(const FeatureMesh& mesh, const FeatureEdge& e) {
  return distance_sq(mesh.vertices[e.end[0]], mesh.vertices[e.end[1]]);
}

/// The normal on the other side of the longest edge that has one there.
WorldPoint neighbours_normal(const FeatureMesh& mesh, const MeshEdges& edges, View<const WorldPoint> normals,
                             uint32_t face) {
  WorldPoint best = kNoNormal;
  double longest_sq = 0;
  for (const uint32_t e : edges.of_triangle[face]) {
    if (!edges.is_inner(e)) continue;
    const WorldPoint& n = normals[edges.across(e, face)];
    const double length_sq = edge_length_sq(mesh, edges.edges[e]);
    if (!has_normal(n) || length_sq <= longest_sq) continue;
    longest_sq = length_sq;
    best = n;
  }
  return best;
}

/// Thin triangles take a neighbour's normal; a round only sees the normals of the rounds before.
void borrow_normals(const FeatureMesh& mesh, const MeshEdges& edges, std::vector<uint32_t> thin,
                    View<WorldPoint> normals) {
  for (int round = 0; round < kThinRounds && !thin.empty(); ++round) {
    std::vector<std::pair<uint32_t, WorldPoint>> found;
    for (const uint32_t t : thin) found.push_back({t, neighbours_normal(mesh, edges, normals, t)});
    thin.clear();
    for (const auto& [t, n] : found) {
      normals[t] = n;
      if (!has_normal(n)) thin.push_back(t);
    }
  }
}

}  // namespace

Buffer<WorldPoint> face_normals(const FeatureMesh& mesh, const MeshEdges& edges) {
  const double extent = mesh.vertices.empty() ? 0 : longest_side(box_of(mesh.vertices));
  const double least_height = std::max(kThinHeight * extent, kThinRoundings * mesh.rounding_world);
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
