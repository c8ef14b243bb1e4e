// The census of regions: each by the surface that bounds it, walls and curves by the whole mesh.
#include "isoshell/region_census.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <string>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "measure/complex_counts.h"
#include "measure/region_surface.h"
#include "measure/self_intersections.h"
#include "measure/triangle_shape.h"

namespace isoshell {
namespace {

template <class Surface>
double area_of(const Surface& surface, uint32_t face) {
  const auto& [a, b, c] = surface.triangles[face];
  return shape_of(surface.vertices[a], surface.vertices[b], surface.vertices[c]).area;
}

/// Intersections are asked of positions.
void require_finite(const TriangleMesh& mesh) {
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      if (!is_finite(mesh.vertices[v]))
        throw Error(ErrorCode::usage, "regions",
                    "vertex " + std::to_string(v) + " is not finite; leave its triangles out");
}

/// Per label the faces that bound it, ascending.
std::vector<std::vector<uint32_t>> faces_of(const TriangleMesh& mesh, const std::vector<int32_t>& labels) {
  std::vector<std::vector<uint32_t>> faces(labels.size());
  for (uint32_t f = 0; f < mesh.triangles.size(); ++f)
    for (const int32_t label : mesh.regions.labels[f])
      if (label != mesh.regions.background && !is_of_sheet(mesh.regions.labels[f]))
        faces[size_t(std::lower_bound(labels.begin(), labels.end(), label) - labels.begin())].push_back(f);
  return faces;
}

int64_t count_sets(IndexSets& sets, size_t count) {
  int64_t roots = 0;
  for (uint32_t i = 0; i < count; ++i) roots += sets.root(i) == i;
  return roots;
}

void sum_triangles(const TriangleMesh& mesh, const RegionSurface& surface, const WorldPoint& middle,
                   RegionCounts& counts) {
  for (size_t i = 0; i < surface.face.size(); ++i) {
    const auto& [a, b, c] = surface.triangles[i];
    const auto at = [&](uint32_t v) { return mesh.vertices[surface.vertex[v]] - middle; };
    counts.volume_world += dot(at(a), cross(at(b), at(c))) / 6;
    counts.area_world += area_of(mesh, surface.face[i]);
  }
}

RegionCounts count_region(const TriangleMesh& mesh, int32_t label, std::vector<uint32_t> faces,
                          const WorldPoint& middle) {
  const RegionSurface surface = surface_of_region(mesh, label, std::move(faces));
  RegionComplex complex = complex_of(surface, mesh.vertices);
  RegionCounts counts;
  counts.label = label;
  counts.name = region_name(mesh.regions, label);
  counts.faces = int64_t(surface.face.size());
  counts.vertices = int64_t(surface.vertex.size());
  counts.components = count_sets(complex.parts, surface.face.size());
  counts.open_edges = complex.open_edges;
  counts.inconsistent_edges = complex.inconsistent_edges;
  const int64_t fans = count_sets(complex.fans, 3 * surface.face.size());
  counts.touching_vertices = fans - counts.vertices;
  counts.closed = complex.closed();
  if (counts.closed) counts.genus = (2 * counts.components - (fans - complex.edges + counts.faces)) / 2;
  sum_triangles(mesh, surface, middle, counts);
  return counts;
}

template <class Surface>
std::vector<RegionWall> count_walls(const Surface& mesh) {
  std::vector<std::pair<std::array<int32_t, 2>, uint32_t>> faces(mesh.triangles.size());
  for_each_index(size_t(0), faces.size(), [&](size_t f) {
    const auto& [behind, front] = mesh.regions.labels[f];
    faces[f] = {{std::min(behind, front), std::max(behind, front)}, uint32_t(f)};
  });
  tbb::parallel_sort(faces.begin(), faces.end());
  std::vector<RegionWall> walls;
  for (const auto& [labels, face] : faces) {
    if (walls.empty() || walls.back().labels != labels) walls.push_back({labels});
    ++walls.back().faces;
    walls.back().area_world += area_of(mesh, face);
  }
  return walls;
}

void count_curves(const TriangleMesh& mesh, RegionCensus& census) {
  std::vector<uint32_t> at(mesh.vertices.size());  // edges of curves
  const EdgeSides sides = find_edge_sides(mesh.triangles, mesh.vertices.size());
  for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
    if (on_edge.size < 3) return;
    ++census.curve_edges;
    ++at[u];
    ++at[v];
  });
  census.corners = std::count_if(at.begin(), at.end(), [](uint32_t edges) { return edges != 0 && edges != 2; });
}

int64_t count_duplicate_faces(const TriangleMesh& mesh, const std::vector<uint32_t>& first_at) {
  std::vector<std::array<uint32_t, 3>> triangles = mesh.triangles;
  for (auto& t : triangles)
    for (uint32_t& v : t) v = first_at[v];
  return count_duplicates(std::move(triangles));
}

}  // namespace

SurfaceRegions regions_of_surface(const TriangleSoup& surface) {
  SurfaceRegions regions;
  if (surface.regions.empty()) return regions;
  const WorldBox box = box_of(surface.vertices, surface.triangles);
  const WorldPoint middle = .5 * (box.min + box.max);
  for (size_t t = 0; t < surface.triangles.size();) {  // faces with the same labels mostly follow one another
    const std::array<int32_t, 2> labels = surface.regions.labels[t];
    double six_volumes = 0;
    for (; t < surface.triangles.size() && surface.regions.labels[t] == labels; ++t) {
      const auto& [a, b, c] = surface.triangles[t];
      const auto at = [&](uint32_t v) { return surface.vertices[v] - middle; };
      six_volumes += dot(at(a), cross(at(b), at(c)));
    }
    regions.volume_world[labels[0]] += six_volumes / 6;
    regions.volume_world[labels[1]] -= six_volumes / 6;
  }
  regions.volume_world.erase(surface.regions.background);
  regions.walls = count_walls(surface);
  regions.absorbed_walls = surface.absorbed_walls;
  regions.names = surface.regions.names;
  return regions;
}

RegionCensus take_region_census(const TriangleMesh& mesh, Context& context, std::optional<int64_t> intersecting_pairs) {
  require_regions(mesh);
  require_finite(mesh);
  return run_with_threads(context, [&] {
    RegionCensus census;
    census.background = mesh.regions.background;
    const std::vector<int32_t> labels = region_labels(mesh);
    std::vector<std::vector<uint32_t>> faces = faces_of(mesh, labels);
    const WorldBox box = box_of(mesh.vertices, mesh.triangles);
    census.regions.resize(labels.size());
    for_each_index(size_t(0), labels.size(), [&](size_t r) {
      check_cancel(context, "regions");
      census.regions[r] = count_region(mesh, labels[r], std::move(faces[r]), .5 * (box.min + box.max));
    });
    census.every_region_closed =
        !mesh.triangles.empty() && std::all_of(census.regions.begin(), census.regions.end(),
                                               [](const RegionCounts& region) { return region.closed; });
    census.inside_out_regions = std::count_if(census.regions.begin(), census.regions.end(),
                                              [](const RegionCounts& region) { return region.is_inside_out(); });
    census.walls = count_walls(mesh);
    count_curves(mesh, census);
    check_cancel(context, "regions");
    const std::vector<uint32_t> first_at = first_at_position(mesh.vertices);
    for (uint32_t v = 0; v < first_at.size(); ++v) census.coincident_vertices += first_at[v] != v;
    census.duplicate_faces = count_duplicate_faces(mesh, first_at);
    census.intersecting_pairs =
        intersecting_pairs ? *intersecting_pairs : find_self_intersections(mesh, first_at, context).pairs;
    return census;
  });
}

}  // namespace isoshell
