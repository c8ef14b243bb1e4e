#include "repair/solids/joined_components.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "voxel/intersect.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

CornersOfTriangle corners_of(const LatticeSurface& surface, uint32_t triangle) {
  const TriangleIndices t = surface.triangles[triangle];
  return {{t.a, t.b, t.c}, {surface.points[t.a], surface.points[t.b], surface.points[t.c]}};
}

struct Sets {
  Buffer<uint32_t> parent;  ///< per point
  int64_t count;

  explicit Sets(int64_t points) : parent(points), count(points) {
    for (int64_t v = 0; v < points; ++v) parent[v] = uint32_t(v);
  }
  uint32_t of(uint32_t v) { return find_root(parent.view(), v); }
  void join_points(uint32_t v, uint32_t w) {
    count -= of(v) != of(w);
    join(parent.view(), v, w);
  }
};

/// Sets of triangles that edges join, of any number of triangles.
int64_t count_sets_by_edges(const LatticeSurface& surface) {
  struct Side {
    uint64_t edge;
    uint32_t triangle;
  };
  std::vector<Side> sides;
  for (int64_t t = 0; t < surface.triangles.size(); ++t) {
    const TriangleIndices c = surface.triangles[t];
    for (const auto& [v, w] : {std::pair(c.a, c.b), std::pair(c.b, c.c), std::pair(c.c, c.a)})
      sides.push_back({uint64_t(std::min(v, w)) << 32 | std::max(v, w), uint32_t(t)});
  }
  std::sort(sides.begin(), sides.end(), [](const Side& s, const Side& t) { return s.edge < t.edge; });
  Sets sets(surface.triangles.size());
  for (size_t i = 1; i < sides.size(); ++i)
    if (sides[i].edge == sides[i - 1].edge) sets.join_points(sides[i].triangle, sides[i - 1].triangle);
  return sets.count;
}

}  // namespace

int64_t count_joins(const LatticeSurface& surface, const SiteSamples& samples) {
  Sets sets(surface.points.size());
  for (const TriangleIndices t : surface.triangles) {
    sets.join_points(t.a, t.b);
    sets.join_points(t.a, t.c);
  }
  const auto set_of = [&](uint32_t triangle) { return sets.of(surface.triangles[triangle].a); };
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
