#include "isoshell/gaps.h"

#include <tbb/parallel_for.h>

#include <cmath>

#include "core/copy_product.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace {

Vec64 doubled_area(const LatticeSurface& surface, TriangleIndices t) {
  const PointQ8 a = surface.points[t.a];
  return cross(difference(surface.points[t.b], a), difference(surface.points[t.c], a));
}

/// Whether normals are more than 120 degrees apart.
bool face_away(Vec64 m, Vec64 n) {
  const auto product = [](Vec64 p, Vec64 q) {
    return double(p.x) * double(q.x) + double(p.y) * double(q.y) + double(p.z) * double(q.z);
  };
  const double mn = product(m, n);
  return mn < 0 && 4 * mn * mn > product(m, m) * product(n, n);
}

bool share_a_corner(TriangleIndices s, TriangleIndices t) {
  const auto is_of_t = [&](uint32_t v) { return v == t.a || v == t.b || v == t.c; };
  return is_of_t(s.a) || is_of_t(s.b) || is_of_t(s.c);
}

}  // namespace

std::vector<uint8_t> find_gaps(const LatticeSurface& of, const Sheet& on) {
  if (on.source_triangle.size() == 0) return {};  // an outline
  if (of.first_cap == kNone && on.topology.bridged_vertices == 0) return {};
  const OnHost<LatticeSurface> surface(of);
  const OnHost<Sheet> sheet(on);
  std::vector<uint8_t> gaps(size_t(sheet->vertex_count()));
  for (int64_t v = 0; v < sheet->vertex_count(); ++v) {
    const uint32_t source = sheet->source_triangle[v];
    gaps[size_t(v)] = source == kNone || surface->source_face[source] >= of.first_cap;
  }
  return gaps;
}

double gap_area_world(const Sheet& of, const std::vector<uint8_t>& gaps) {
  if (gaps.empty()) return 0;
  const OnHost<Sheet> sheet(of);
  double doubled_q16 = 0;
  for (const TriangleIndices t : sheet->triangles) {
    if (!gaps[t.a] || !gaps[t.b] || !gaps[t.c]) continue;
    const PointQ8 a = sheet->position[t.a];
    const Vec64 n = cross(difference(sheet->position[t.b], a), difference(sheet->position[t.c], a));
    doubled_q16 += std::sqrt(double(dot(n, n)));
  }
  const double unit = sheet->frame.voxel_size / kOneVoxelQ8;
  return doubled_q16 / 2 * unit * unit;
}

std::vector<uint8_t> find_risks(const LatticeSurface& of, const SiteSamples& seen) {
  const OnHost<LatticeSurface> surface(of);
  const OnHost<SiteSamples> samples(seen);
  if (samples->first.empty()) return {};
  std::vector<uint8_t> risks(size_t(samples->sample.size()), 0);
  tbb::parallel_for(int64_t(0), samples->sample.size(), [&](int64_t site) {
    const TriangleIndices own = surface->triangles[samples->sample[site].triangle];
    const Vec64 normal = doubled_area(*surface, own);
    for (int64_t i = samples->first[site]; i < samples->first[site + 1] && !risks[size_t(site)]; ++i) {
      const TriangleIndices other = surface->triangles[samples->triangles[i]];
      risks[size_t(site)] = !share_a_corner(own, other) && face_away(normal, doubled_area(*surface, other));
    }
  });
  return risks;
}

}  // namespace isoshell
