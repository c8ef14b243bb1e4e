// See region_surface.h.
#include "measure/region_surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <utility>

#include "core/parallel_ranges.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "regions", message); }

}  // namespace

void require_regions(const TriangleMesh& mesh) {
  const auto& labels = mesh.regions.labels;
  if (mesh.regions.empty()) refuse("the mesh has no regions; give one whose faces have the labels of two each");
  if (labels.size() != mesh.triangles.size())
    refuse("the mesh has " + std::to_string(mesh.triangles.size()) + " triangles, and labels of " +
           std::to_string(labels.size()) + "; give a pair a triangle");
  for (size_t t = 0; t < labels.size(); ++t)
    if (labels[t][0] == labels[t][1])
      refuse("face " + std::to_string(t) + " has region " + std::to_string(labels[t][0]) +
             " on both sides; leave out faces that part nothing");
  require_indices(mesh.triangles, mesh.vertices.size(), "regions");
}

std::vector<int32_t> region_labels(const TriangleMesh& mesh) {
  std::vector<int32_t> labels;
  labels.reserve(2 * mesh.regions.labels.size());
  for (const auto& sides : mesh.regions.labels)
    for (const int32_t label : sides)
      if (label != mesh.regions.background) labels.push_back(label);
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

RegionComplex complex_of(const RegionSurface& surface) {
  const auto& triangles = surface.triangles;
  RegionComplex complex{IndexSets(int64_t(3 * triangles.size())), IndexSets(int64_t(triangles.size()))};
  const auto corner = [&](uint32_t half_edge) { return triangles[half_edge / 3][half_edge % 3]; };
  const auto corner_at = [&](uint32_t half_edge, uint32_t vertex) {
    return corner(half_edge) == vertex ? half_edge : next_in_triangle(half_edge);
  };
  const EdgeSides sides = find_edge_sides(triangles, surface.vertex.size());
  for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
    const uint32_t first = on_edge[0].half_edge;
    ++complex.edges;
    for (int64_t i = 1; i < on_edge.size; ++i) {
      const uint32_t other = on_edge[i].half_edge;
      for (const uint32_t end : {u, v}) complex.fans.unite(corner_at(first, end), corner_at(other, end));
      complex.parts.unite(first / 3, other / 3);
    }
    if (on_edge.size != 2)
      ++complex.open_edges;
    else if (corner(first) == corner(on_edge[1].half_edge))
      ++complex.inconsistent_edges;
  });
  return complex;
}

}  // namespace isoshell
