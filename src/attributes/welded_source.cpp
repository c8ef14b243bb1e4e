#include "attributes/welded_source.h"

#include <algorithm>
#include <cmath>

#include "core/attribute_values.h"
#include "core/parallel_ranges.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

// A sixteenth of a texel of an image 8192 wide. Programs that compute corner by corner leave two or three units of
// single precision between faces that belong together, and files of six digits one of the last.
constexpr double kRounding = 1. / (16 * 8192);

/// The value that a triangle has at one of its vertices.
const double* value_at(const WeldedSource& source, const Attribute& a, uint32_t triangle, uint32_t vertex) {
  if (a.domain == AttributeDomain::face) return value_of(a, source.mesh.source_face[triangle]);
  const auto& corners = source.mesh.triangles[triangle];
  return value_of(a, source.corner(triangle, corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : 2));
}

/// What counts as rounding between the values of two triangles: of numbers that are not whole a part of the largest of
/// them, which of coordinates and directions is 1 or about as much.
double rounding_between(const WeldedSource& source, const Attribute& a, const std::array<uint32_t, 2>& triangles) {
  const bool is_whole = a.type != NumberType::f32 && a.type != NumberType::f64;
  if (a.domain == AttributeDomain::face || is_whole) return 0;
  double largest = fitting_meaning(a) ? 1 : 0;
  for (const uint32_t t : triangles)
    for (uint32_t i = 0; i < 3; ++i) {
      const double* const value = value_of(a, source.corner(t, i));
      for (int32_t k = 0; k < a.components; ++k)
        if (std::isfinite(value[k])) largest = std::max(largest, std::abs(value[k]));
    }
  return kRounding * largest;
}

bool is_near(const double* a, const double* b, int32_t components, double rounding) {
  for (int32_t k = 0; k < components; ++k)
    if (!is_same(a[k], b[k]) && !(std::abs(a[k] - b[k]) <= rounding)) return false;
  return true;
}

}  // namespace

WeldedSource weld_source(const TriangleSoup& soup) {
  WeldedSource source{weld_for_features(soup), {}, {}};
  source.edges = find_mesh_edges(source.mesh);
  source.first_corner.resize(source.mesh.triangles.size());
  for_each_index(size_t(0), source.first_corner.size(), [&](size_t t) {
    const auto& face = soup.triangles[source.mesh.source_face[t]];
    const WorldPoint& first = source.mesh.vertices[source.mesh.triangles[t][0]];
    while (!(soup.vertices[face[source.first_corner[t]]] == first)) ++source.first_corner[t];
  });
  return source;
}

std::vector<Jump> find_jumps(const WeldedSource& source, const Attribute& attribute) {
  std::vector<Jump> jumps(source.edges.count(), Jump::none);
  for_each_index(size_t(0), jumps.size(), [&](size_t e) {
    const FeatureEdge& edge = source.edges.edges[e];
    if (edge.use != EdgeUse::inner) return;
    const double rounding = rounding_between(source, attribute, {edge.face[0], edge.face[1]});
    int differing = 0;
    for (const uint32_t v : edge.end)
      differing += !is_near(value_at(source, attribute, edge.face[0], v), value_at(source, attribute, edge.face[1], v),
                            attribute.components, rounding);
    jumps[e] = Jump(differing);
  });
  return jumps;
}

}  // namespace isoshell
