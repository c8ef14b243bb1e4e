// part_fans (see part_fans.h).
#include "pipeline/patches/part_fans.h"

#include <algorithm>
#include <map>
#include <numeric>

#include "features/mesh/separate_fans.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// Moves every new vertex into its fan.
void step_inward(TriangleMesh& mesh, size_t first, double step_world) {
  std::vector<WorldPoint> inward(mesh.vertices.size() - first, WorldPoint{0, 0, 0});
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      for (const uint32_t u : t)
        if (v >= first) inward[v - first] = inward[v - first] + (mesh.vertices[u] - mesh.vertices[v]);
  for (size_t i = 0; i < inward.size(); ++i)
    if (const double far = length(inward[i]); far > 0)
      mesh.vertices[first + i] = mesh.vertices[first + i] + (step_world / far) * inward[i];
}

void sort_triangles(TriangleMesh& mesh) {
  for (auto& t : mesh.triangles) std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  std::vector<uint32_t> order(mesh.triangles.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t a, uint32_t b) { return mesh.triangles[a] < mesh.triangles[b]; });
  const std::vector<uint32_t> patch = mesh.features.patch;
  for (size_t i = 0; i < patch.size(); ++i) mesh.features.patch[i] = patch[order[i]];
  std::sort(mesh.triangles.begin(), mesh.triangles.end());
}

/// An edge on a curve may be there twice now.
void rename_features(TriangleMesh& mesh, const std::vector<uint32_t>& was, size_t first) {
  MeshFeatures& features = mesh.features;
  const auto old = [&](uint32_t v) { return v < first ? v : was[v - first]; };
  std::map<uint64_t, uint32_t> curve_of;
  for (const MeshCurveEdge& e : features.curve_edges) curve_of[edge_key(e.vertex[0], e.vertex[1])] = e.curve;
  features.curve_edges.clear();
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = std::min(t[i], t[(i + 1) % 3]), v = std::max(t[i], t[(i + 1) % 3]);
      const auto found = curve_of.find(edge_key(old(u), old(v)));
      if (found != curve_of.end()) features.curve_edges.push_back({{u, v}, found->second});
    }
  std::vector<MeshCurveEdge>& edges = features.curve_edges;
  std::sort(edges.begin(), edges.end(),
            [](const MeshCurveEdge& a, const MeshCurveEdge& b) { return a.vertex < b.vertex; });
  edges.erase(std::unique(edges.begin(), edges.end(),
                          [](const MeshCurveEdge& a, const MeshCurveEdge& b) { return a.vertex == b.vertex; }),
              edges.end());
  const std::vector<uint32_t> corners = features.corners;
  for (size_t i = 0; i < was.size(); ++i)
    if (std::binary_search(corners.begin(), corners.end(), was[i])) features.corners.push_back(uint32_t(first + i));
}

}  // namespace

void part_fans(TriangleMesh& mesh, double step_world) {
  const std::vector<uint32_t> was = separate_fans(mesh.vertices, mesh.triangles);
  if (was.empty()) return;
  const size_t first = mesh.vertices.size() - was.size();
  step_inward(mesh, first, step_world);
  rename_features(mesh, was, first);
  sort_triangles(mesh);
}

}  // namespace isoshell
