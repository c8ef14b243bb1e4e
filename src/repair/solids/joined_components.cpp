#include "repair/solids/joined_components.h"

#include <algorithm>

#include "core/index_sets.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_list.h"
#include "voxel/intersect.h"

namespace isoshell {
namespace {

CornersOfTriangle corners_of(const LatticeSurface& surface, uint32_t triangle) {
  const TriangleIndices t = surface.triangles[triangle];
  return {{t.a, t.b, t.c}, {surface.points[t.a], surface.points[t.b], surface.points[t.c]}};
}

struct Sets {
  IndexSets of;
  int64_t count;

  explicit Sets(int64_t points) : of(points), count(points) {}
  void join_points(uint32_t v, uint32_t w) {
    count -= of.root(v) != of.root(w);
    of.unite(v, w);
  }
};

/// Sets of triangles that edges join, of any number of triangles.
int64_t count_sets_by_edges(const LatticeSurface& surface) {
  Sets sets(surface.triangles.size());
  const EdgeSides sides = find_edge_sides(list_of(surface.triangles.view()), size_t(surface.points.size()));
  for_each_edge(sides, [&](uint32_t, uint32_t, View<const EdgeSide> on_edge) {
    for (const EdgeSide& side : on_edge) sets.join_points(on_edge[0].half_edge / 3, side.half_edge / 3);
  });
  return sets.count;
}

}  // namespace

int64_t count_joins(const LatticeSurface& surface, const SiteSamples& samples) {
  Sets sets(surface.points.size());
  for (const TriangleIndices t : surface.triangles) {
    sets.join_points(t.a, t.b);
    sets.join_points(t.a, t.c);
  }
  const auto set_of = [&](uint32_t triangle) { return sets.of.root(surface.triangles[triangle].a); };
  for (int64_t site = 0; site + 1 < samples.first.size(); ++site) {
    const uint32_t* const begin = samples.triangles.begin() + samples.first[site];
    const uint32_t* const end = samples.triangles.begin() + samples.first[site + 1];
    if (std::all_of(begin, end, [&](uint32_t t) { return set_of(t) == set_of(*begin); })) continue;
    for (const uint32_t* s = begin; s < end; ++s)
      for (const uint32_t* t = s + 1; t < end; ++t)
        if (set_of(*s) != set_of(*t) && triangles_intersect(corners_of(surface, *s), corners_of(surface, *t)))
          sets.join_points(surface.triangles[*s].a, surface.triangles[*t].a);
  }
  return count_sets_by_edges(surface) - sets.count;
}

}  // namespace isoshell
