#include "features/curves/surface_walk.h"

#include <algorithm>

#include "features/curves/face_normals.h"

namespace isoshell {
namespace {

constexpr int kMostTriangles = 256;  // of a walk

/// A point on an edge of a triangle, and a direction in its plane.
struct Walker {
  uint32_t face, edge;
  WorldPoint at, direction;
};

/// The part of v at a right angle to the unit vector u.
WorldPoint part_across(const WorldPoint& v, const WorldPoint& u) { return v - dot(v, u) * u; }

WorldPoint direction_of(const FeatureMesh& mesh, const FeatureEdge& e) {
  return normalised(mesh.vertices[e.end[1]] - mesh.vertices[e.end[0]]);
}

uint32_t corner_off(const FeatureMesh& mesh, const FeatureEdge& e, uint32_t face) {
  const auto& c = mesh.triangles[face];
  return c[0] + c[1] + c[2] - e.end[0] - e.end[1];
}

/// In the plane of the face, from its edge inwards at a right angle.
WorldPoint inwards(const FeatureMesh& mesh, const FeatureEdge& e, uint32_t face) {
  const WorldPoint& off = mesh.vertices[corner_off(mesh, e, face)];
  return normalised(part_across(off - mesh.vertices[e.end[0]], direction_of(mesh, e)));
}

/// How far ahead the walker leaves its triangle, and by which edge: of the two others, the one whose outer side it
/// comes nearer to and reaches first.
struct Exit {
  double ahead;
  uint32_t edge;
};
Exit find_exit(const WalkGround& ground, const Walker& w) {
  Exit best{-1, w.edge};
  for (const uint32_t e : ground.edges.of_triangle[w.face]) {
    if (e == w.edge) continue;
    const FeatureEdge& edge = ground.edges.edges[e];
    const WorldPoint in = inwards(ground.mesh, edge, w.face);
    const double approach = -dot(w.direction, in);
    if (approach <= 0) continue;
    const double ahead = std::max(0., dot(w.at - ground.mesh.vertices[edge.end[0]], in) / approach);
    if (best.ahead < 0 || ahead < best.ahead) best = {ahead, e};
  }
  return best;
}

/// Over the edge into the next triangle, straight on in the unfolded plane.
void cross_edge(const WalkGround& ground, const Exit& exit, Walker& w) {
  const FeatureEdge& e = ground.edges.edges[exit.edge];
  const WorldPoint along = direction_of(ground.mesh, e);
  const WorldPoint out = -1. * inwards(ground.mesh, e, w.face);
  w.at = w.at + exit.ahead * w.direction;
  w.face = ground.edges.across(exit.edge, w.face);
  w.edge = exit.edge;
  w.direction = normalised(dot(w.direction, along) * along + dot(w.direction, out) * inwards(ground.mesh, e, w.face));
}

}  // namespace

BesideEdge look_beside(const WalkGround& ground, uint32_t edge, uint32_t face, double length_world) {
  const FeatureEdge& e = ground.edges.edges[edge];
  const WorldPoint middle = .5 * (ground.mesh.vertices[e.end[0]] + ground.mesh.vertices[e.end[1]]);
  Walker w{face, edge, middle, inwards(ground.mesh, e, face)};
  BesideEdge seen{0, 0, 0};
  for (; seen.crossed < kMostTriangles; ++seen.crossed) {
    const Exit exit = find_exit(ground, w);
    if (exit.ahead < 0) break;
    seen.walked_world += exit.ahead;
    if (seen.walked_world >= length_world || ground.is_end[exit.edge] || !ground.edges.is_inner(exit.edge)) break;
    cross_edge(ground, exit, w);
    seen.turn = std::max(seen.turn, turn_between(ground.normals[face], ground.normals[w.face]));
  }
  return seen;
}

}  // namespace isoshell
