// See region_surface.h.
#include "measure/region_surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "core/parallel_ranges.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "isoshell/error.h"
#include "measure/around_edge.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "regions", message); }

/// Pairs of triangles around an edge that have a piece of the region between them, where it touches itself there. None
/// where they do not come in such pairs, or lie on each other.
std::vector<std::array<uint32_t, 2>> wedges_at(const RegionSurface& surface, const std::vector<WorldPoint>& points,
                                               uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
  std::vector<TriangleAtEdge> around = triangles_at_edge(surface.triangles, u, on_edge);
  for (TriangleAtEdge& t : around) t.apex = surface.vertex[t.apex];
  sort_around_edge(points, surface.vertex[u], surface.vertex[v], around);
  std::vector<std::array<uint32_t, 2>> wedges;
  for (size_t i = 0; i < around.size(); ++i) {
    const TriangleAtEdge &here = around[i], &next = around[(i + 1) % around.size()];
    if (here.apex == next.apex) return {};
    if (!here.rises && next.rises) wedges.push_back({here.triangle, next.triangle});
  }
  if (2 * wedges.size() != around.size()) wedges.clear();
  return wedges;
}

}  // namespace

void require_regions(const TriangleMesh& mesh) {
  const auto& labels = mesh.regions.labels;
  if (mesh.regions.empty()) refuse("the mesh has no regions; give one whose faces have the labels of two each");
  if (labels.size() != mesh.triangles.size())
    refuse("the mesh has " + std::to_string(mesh.triangles.size()) + " triangles, and labels of " +
           std::to_string(labels.size()) + "; give a pair a triangle");
  require_indices(mesh.triangles, mesh.vertices.size(), "regions");
}

std::vector<int32_t> region_labels(const TriangleMesh& mesh) {
  std::vector<int32_t> labels;
  labels.reserve(2 * mesh.regions.labels.size());
  for (const auto& sides : mesh.regions.labels)
    for (const int32_t label : sides)
      if (label != mesh.regions.background && !is_of_sheet(sides)) labels.push_back(label);
  tbb::parallel_sort(labels.begin(), labels.end());
  labels.erase(std::unique(labels.begin(), labels.end()), labels.end());
  return labels;
}

std::string region_name(const FaceRegions& regions, int32_t label) {
  const auto& names = regions.names;
  const auto found = std::lower_bound(names.begin(), names.end(), label,
                                      [](const RegionName& name, int32_t wanted) { return name.label < wanted; });
  return found != names.end() && found->label == label ? found->name : "";
}

RegionSurface surface_of_region(const TriangleMesh& mesh, int32_t label, std::vector<uint32_t> faces) {
  RegionSurface surface;
  surface.face = std::move(faces);
  surface.is_turned.reserve(surface.face.size());
  surface.triangles.reserve(surface.face.size());
  surface.vertex.reserve(3 * surface.face.size());
  for (const uint32_t f : surface.face) {
    const bool is_turned = mesh.regions.labels[f][1] == label;
    const auto& t = mesh.triangles[f];
    surface.is_turned.push_back(is_turned);
    surface.triangles.push_back(is_turned ? std::array<uint32_t, 3>{t[0], t[2], t[1]} : t);
    surface.vertex.insert(surface.vertex.end(), t.begin(), t.end());
  }
  std::vector<uint32_t>& vertex = surface.vertex;
  tbb::parallel_sort(vertex.begin(), vertex.end());
  vertex.erase(std::unique(vertex.begin(), vertex.end()), vertex.end());
  for_each_index(size_t(0), surface.triangles.size(), [&](size_t t) {
    for (uint32_t& v : surface.triangles[t])
      v = uint32_t(std::lower_bound(vertex.begin(), vertex.end(), v) - vertex.begin());
  });
  return surface;
}

RegionComplex complex_of(const RegionSurface& surface, const std::vector<WorldPoint>& points) {
  const auto& triangles = surface.triangles;
  RegionComplex complex{IndexSets(int64_t(3 * triangles.size())), IndexSets(int64_t(triangles.size()))};
  const auto corner_at = [&](uint32_t triangle, uint32_t vertex) {
    const auto& t = triangles[triangle];
    return 3 * triangle + (t[0] == vertex ? 0 : t[1] == vertex ? 1 : 2);
  };
  const EdgeSides sides = find_edge_sides(triangles, surface.vertex.size());
  for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
    const auto unite = [&](uint32_t t, uint32_t s) {
      for (const uint32_t end : {u, v}) complex.fans.unite(corner_at(t, end), corner_at(s, end));
      complex.parts.unite(t, s);
    };
    if (on_edge.size > 2)
      if (const auto wedges = wedges_at(surface, points, u, v, on_edge); !wedges.empty()) {
        for (const auto& [t, s] : wedges) unite(t, s);
        complex.edges += int64_t(wedges.size());
        return;
      }
    ++complex.edges;
    for (int64_t i = 1; i < on_edge.size; ++i) unite(on_edge[0].half_edge / 3, on_edge[i].half_edge / 3);
    const auto passes_from_u = [&](int64_t i) {
      return triangles[on_edge[i].half_edge / 3][on_edge[i].half_edge % 3] == u;
    };
    if (on_edge.size != 2)
      ++complex.open_edges;
    else if (passes_from_u(0) == passes_from_u(1))
      ++complex.inconsistent_edges;
  });
  return complex;
}

}  // namespace isoshell
