// drop_internal_faces (see internal_faces.h).
#include "features/mesh/internal_faces.h"

#include <algorithm>

#include "core/index_sets.h"
#include "features/mesh/mesh_edges.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// Side 2 t is the front of triangle t, which its normal looks to, and 2 t + 1 its back.
uint32_t side(uint32_t triangle, bool is_front) { return 2 * triangle + (is_front ? 0 : 1); }

constexpr double kThin = 1e-6;  // height of triangles that have no direction, in terms of their longest edge
constexpr int kMostNear = 8;    // of them one beside the other

/// A triangle at an edge, seen along the edge.
struct FaceAtEdge {
  uint32_t triangle;
  bool rises;   ///< passes the edge from its smaller end
  double x, y;  ///< direction to its third corner
  bool is_upper() const { return y > 0 || (y == 0 && x > 0); }
};
bool is_before(const FaceAtEdge& a, const FaceAtEdge& b) {
  if (a.is_upper() != b.is_upper()) return a.is_upper();
  const double turn = a.x * b.y - a.y * b.x;
  return turn != 0 ? turn > 0 : a.triangle < b.triangle;
}

class Regions {
 public:
  Regions(const FeatureMesh& mesh, const MeshEdges& edges)
      : mesh_(mesh), edges_(edges), sets_(2 * int64_t(mesh.triangles.size())) {
    join_sides();
    volume_.assign(2 * mesh.triangles.size(), 0);
    is_seen_from_back_.assign(volume_.size(), 0);
    const WorldPoint& o = mesh.vertices[0];
    for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
      const auto& [a, b, c] = mesh.triangles[t];
      const double volume =
          dot(mesh.vertices[a] - o, cross(mesh.vertices[b] - o, mesh.vertices[c] - o));  // of the back side
      volume_[of(t, false)] += volume;
      volume_[of(t, true)] -= volume;
      is_seen_from_back_[of(t, false)] = 1;
    }
  }

  /// Outside of everything, which has a volume below 0, or a hollow.
  bool is_air(uint32_t triangle, bool is_front) {
    const uint32_t region = of(triangle, is_front);
    return volume_[region] <= 0 || !is_seen_from_back_[region];
  }

 private:
  uint32_t of(uint32_t triangle, bool is_front) { return sets_.root(side(triangle, is_front)); }

  void join_sides() {
    std::vector<std::pair<uint32_t, uint32_t>> branching;  // edge, triangle
    for (uint32_t t = 0; t < mesh_.triangles.size(); ++t)
      for (const uint32_t e : edges_.of_triangle[t])
        if (!edges_.is_inner(e)) branching.push_back({e, t});
    for (const FeatureEdge& e : edges_.edges)
      if (e.use == EdgeUse::inner)
        for (const bool is_front : {false, true}) sets_.unite(side(e.face[0], is_front), side(e.face[1], is_front));
    std::sort(branching.begin(), branching.end());
    for (size_t begin = 0, end = 0; begin < branching.size(); begin = end) {
      std::vector<uint32_t> faces;
      for (; end < branching.size() && branching[end].first == branching[begin].first; ++end)
        faces.push_back(branching[end].second);
      join_around(edges_.edges[branching[begin].first], faces);
    }
  }

  /// Between two neighbours around an edge is one region.
  void join_around(const FeatureEdge& edge, const std::vector<uint32_t>& triangles) {
    std::vector<FaceAtEdge> faces;
    for (const uint32_t t : triangles) faces.push_back(seen_along(edge, t, triangles.front()));
    std::sort(faces.begin(), faces.end(), is_before);
    for (size_t i = 0; i < faces.size(); ++i) {
      const FaceAtEdge &here = faces[i], &next = faces[(i + 1) % faces.size()];
      sets_.unite(side(here.triangle, here.rises), side(next.triangle, !next.rises));
    }
  }

  /// Whether the triangle passes the edge from the smaller end.
  bool rises(const FeatureEdge& edge, uint32_t triangle) const {
    const auto& corner = mesh_.triangles[triangle];
    for (size_t i = 0; i < 3; ++i)
      if (corner[i] == edge.end[0]) return corner[(i + 1) % 3] == edge.end[1];
    return true;
  }

  double length_sq_of(const FeatureEdge& e) const {
    return distance_sq(mesh_.vertices[e.end[0]], mesh_.vertices[e.end[1]]);
  }
  bool is_thin(uint32_t triangle) const {
    const auto& [a, b, c] = mesh_.triangles[triangle];
    double longest_sq = 0;
    for (const uint32_t e : edges_.of_triangle[triangle])
      longest_sq = std::max(longest_sq, length_sq_of(edges_.edges[e]));
    return length(doubled_area(mesh_.vertices[a], mesh_.vertices[b], mesh_.vertices[c])) <= kThin * longest_sq;
  }

  /// The triangle that shows where one goes at an edge: where it has no height, as at T-junctions, the one across the
  /// longest of its other edges.
  uint32_t with_height(const FeatureEdge& edge, uint32_t triangle) const {
    const FeatureEdge* behind = &edge;
    for (int i = 0; i < kMostNear && is_thin(triangle); ++i) {
      const FeatureEdge* longest = nullptr;
      for (const uint32_t e : edges_.of_triangle[triangle]) {
        const FeatureEdge& other = edges_.edges[e];
        if (other.use != EdgeUse::inner || other.end == behind->end) continue;
        if (!longest || length_sq_of(other) > length_sq_of(*longest)) longest = &other;
      }
      if (!longest) break;
      triangle = longest->face[0] == triangle ? longest->face[1] : longest->face[0];
      behind = longest;
    }
    return triangle;
  }

  /// The corner of a triangle that is farthest from an edge, which is seen from its smaller end.
  WorldPoint apex_of(const FeatureEdge& edge, uint32_t triangle) const {
    const WorldPoint &from = mesh_.vertices[edge.end[0]], along = mesh_.vertices[edge.end[1]] - from;
    WorldPoint apex = {0, 0, 0};
    for (const uint32_t v : mesh_.triangles[with_height(edge, triangle)]) {
      const WorldPoint to = mesh_.vertices[v] - from;
      if (length_sq(cross(along, to)) > length_sq(cross(along, apex))) apex = to;
    }
    return apex;
  }

  /// In a frame that the first triangle gives.
  FaceAtEdge seen_along(const FeatureEdge& edge, uint32_t triangle, uint32_t first) const {
    const WorldPoint &from = mesh_.vertices[edge.end[0]], along = mesh_.vertices[edge.end[1]] - from;
    const WorldPoint y_axis = cross(along, apex_of(edge, first));
    const WorldPoint x_axis = cross(y_axis, along);
    const WorldPoint to = apex_of(edge, triangle);
    // The first axis is longer than the second, by the length of the edge.
    return {triangle, rises(edge, triangle), dot(to, x_axis), triangle == first ? 0 : dot(to, y_axis) * length(along)};
  }

  const FeatureMesh& mesh_;
  const MeshEdges& edges_;
  IndexSets sets_;
  std::vector<double> volume_;
  std::vector<uint8_t> is_seen_from_back_;
};

/// Edges of the kept surface that had more triangles.
std::vector<std::array<WorldPoint, 2>> find_interfaces(const FeatureMesh& mesh, const MeshEdges& edges,
                                                       const std::vector<uint8_t>& is_wall) {
  std::vector<uint8_t> has_wall(edges.count(), 0), has_surface(edges.count(), 0);
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const uint32_t e : edges.of_triangle[t]) (is_wall[t] ? has_wall : has_surface)[e] = 1;
  std::vector<std::array<WorldPoint, 2>> found;
  for (uint32_t e = 0; e < edges.count(); ++e)
    if (has_wall[e] && has_surface[e])
      found.push_back({mesh.vertices[edges.edges[e].end[0]], mesh.vertices[edges.edges[e].end[1]]});
  return found;
}

}  // namespace

std::optional<WithoutInternalFaces> drop_internal_faces(const FeatureMesh& mesh) {
  if (mesh.triangles.empty()) return {};
  const MeshEdges edges = find_mesh_edges(mesh);
  const std::vector<uint32_t> component = components_of(mesh, edges);
  std::vector<uint8_t> branches(mesh.triangles.size(), 0);  // per component
  for (const FeatureEdge& e : edges.edges) {
    if (e.use == EdgeUse::border) return {};
    if (e.use == EdgeUse::non_manifold) branches[component[e.face[0]]] = 1;
  }
  Regions regions(mesh, edges);
  WithoutInternalFaces out;
  std::vector<uint8_t> is_wall(mesh.triangles.size(), 0);
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    std::array<uint32_t, 3> corner = mesh.triangles[t];
    if (branches[component[t]]) {
      const bool front_is_air = regions.is_air(t, true), back_is_air = regions.is_air(t, false);
      if (front_is_air && back_is_air) return {};
      is_wall[t] = !front_is_air && !back_is_air;
      if (back_is_air) std::swap(corner[1], corner[2]);
    }
    out.dropped += is_wall[t];
    if (is_wall[t]) continue;
    out.mesh.triangles.push_back(corner);
    out.mesh.source_face.push_back(mesh.source_face[t]);
  }
  if (out.dropped == 0) return {};
  out.mesh.vertices = mesh.vertices;
  out.interfaces = find_interfaces(mesh, edges, is_wall);
  return out;
}

}  // namespace isoshell
