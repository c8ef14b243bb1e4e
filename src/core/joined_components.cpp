#include "core/joined_components.h"

#include <algorithm>

#include "voxel/intersect.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

CornersOfTriangle corners_of(const LatticeSurface& surface, uint32_t triangle) {
  const TriangleIndices t = surface.triangles[triangle];
  return {{t.a, t.b, t.c}, {surface.points[t.a], surface.points[t.b], surface.points[t.c]}};
}

}  // namespace

int64_t count_joined_components(const LatticeSurface& surface, const SiteSamples& samples) {
  Buffer<uint32_t> parent(surface.points.size());
  for (int64_t v = 0; v < parent.size(); ++v) parent[v] = uint32_t(v);
  const View<uint32_t> sets = parent.view();
  for (const TriangleIndices t : surface.triangles) {
    join(sets, t.a, t.b);
    join(sets, t.a, t.c);
  }
  const auto set_of = [&](uint32_t triangle) { return find_root(sets, surface.triangles[triangle].a); };
  for (int64_t site = 0; site + 1 < samples.first.size(); ++site) {
    const uint32_t* const begin = samples.triangles.begin() + samples.first[site];
    const uint32_t* const end = samples.triangles.begin() + samples.first[site + 1];
    if (std::all_of(begin, end, [&](uint32_t t) { return set_of(t) == set_of(*begin); })) continue;
    for (const uint32_t* s = begin; s < end; ++s)
      for (const uint32_t* t = s + 1; t < end; ++t)
        if (set_of(*s) != set_of(*t) && triangles_intersect(corners_of(surface, *s), corners_of(surface, *t)))
          join(sets, surface.triangles[*s].a, surface.triangles[*t].a);
  }
  int64_t count = 0;
  for (int64_t v = 0; v < parent.size(); ++v) count += find_root(sets, uint32_t(v)) == uint32_t(v);
  return count;
}

}  // namespace isoshell
