#include "isoshell/gaps.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <queue>
#include <tuple>
#include <utility>

#include "core/copy_product.h"
#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "core/voxel_set.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr double kRimVoxels = 1;  // of those that hold the rims, half of each is gap

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

std::vector<uint8_t> find_bridges(const SiteSet& of, const Sheet& on) {
  const OnHost<SiteSet> sites(of);
  const OnHost<Sheet> sheet(on);
  std::vector<uint8_t> bridges(size_t(sheet->vertex_count()));
  const VoxelSetView voxels = sites->voxels.view();
  for_each_voxel(sheet->corners.view(), [&](Voxel c, int64_t v) {
    bool holds_surface = false;
    for (int o = 0; o < 8 && !holds_surface; ++o)
      holds_surface = find_voxel(voxels, {c.x - (o >> 2), c.y - (o >> 1 & 1), c.z - (o & 1)}) >= 0;
    bridges[size_t(v)] = !holds_surface;
  });
  return bridges;
}

void measure_bridges(const Sheet& on, const std::vector<uint8_t>& bridges, GapReport& report) {
  const OnHost<Sheet> sheet(on);
  std::vector<Voxel> corner(bridges.size());
  for_each_voxel(sheet->corners.view(), [&](Voxel c, int64_t v) { corner[size_t(v)] = c; });
  // Each bridging vertex takes the nearest of its neighbours' nearest corners of the rim, nearest first.
  std::vector<std::pair<int64_t, uint32_t>> rim_of(bridges.size(), {INT64_MAX, kNone});  // squared distance, vertex
  using Step = std::tuple<int64_t, uint32_t, uint32_t>;  // squared distance, rim, vertex
  std::priority_queue<Step, std::vector<Step>, std::greater<>> next;
  IndexSets sets(int64_t(bridges.size()));
  const auto offer = [&](uint32_t rim, uint32_t v) {
    const Voxel p = corner[rim], q = corner[v];
    const int64_t x = p.x - q.x, y = p.y - q.y, z = p.z - q.z, distance_sq = x * x + y * y + z * z;
    if (std::pair(distance_sq, rim) >= rim_of[v]) return;
    rim_of[v] = {distance_sq, rim};
    next.push({distance_sq, rim, v});
  };
  const auto for_each_neighbour = [&](uint32_t v, auto each) {
    for (int64_t i = sheet->vertex_first[v]; i < sheet->vertex_first[v + 1]; ++i) {
      const TriangleIndices t = sheet->triangles[sheet->vertex_triangles[i]];
      for (const uint32_t w : {t.a, t.b, t.c})
        if (w != v) each(w);
    }
  };
  for (uint32_t v = 0; v < bridges.size(); ++v) {
    if (!bridges[v]) continue;
    for_each_neighbour(v, [&](uint32_t w) {
      if (bridges[w])
        sets.unite(v, w);
      else
        offer(w, v);
    });
  }
  int64_t farthest_sq = 0;
  while (!next.empty()) {
    const auto [distance_sq, rim, v] = next.top();
    next.pop();
    if (rim_of[v] != std::pair(distance_sq, rim)) continue;
    farthest_sq = std::max(farthest_sq, distance_sq);
    for_each_neighbour(v, [&, rim = rim](uint32_t w) {
      if (bridges[w]) offer(rim, w);
    });
  }
  for (uint32_t v = 0; v < bridges.size(); ++v) report.bridges += bridges[v] && sets.root(v) == v;
  if (report.bridges > 0)
    report.widest_bridge_world = (2 * std::sqrt(double(farthest_sq)) + kRimVoxels) * sheet->frame.voxel_size;
}

std::vector<uint8_t> find_gaps(const LatticeSurface& of, const Sheet& on, const std::vector<uint8_t>& bridges) {
  if (on.source_triangle.empty()) return {};  // a coarse proxy
  if (of.first_cap == kNone && bridges.empty()) return {};
  const OnHost<LatticeSurface> surface(of);
  const OnHost<Sheet> sheet(on);
  std::vector<uint8_t> gaps(size_t(sheet->vertex_count()));
  for (int64_t v = 0; v < sheet->vertex_count(); ++v) {
    const uint32_t source = sheet->source_triangle[v];
    gaps[size_t(v)] =
        source == kNone || surface->source_face[source] >= of.first_cap || (!bridges.empty() && bridges[size_t(v)]);
  }
  return gaps;
}

std::vector<Voxel> bridging_voxels(const Sheet& on, const std::vector<uint8_t>& bridges) {
  const OnHost<Sheet> sheet(on);
  std::vector<Voxel> voxels;
  for_each_voxel(sheet->corners.view(), [&](Voxel c, int64_t v) {
    for (int o = 0; o < 8 && bridges[size_t(v)]; ++o)
      voxels.push_back({c.x - (o >> 2), c.y - (o >> 1 & 1), c.z - (o & 1)});
  });
  const auto key = [](Voxel v) { return std::tuple(v.x, v.y, v.z); };
  std::sort(voxels.begin(), voxels.end(), [&](Voxel a, Voxel b) { return key(a) < key(b); });
  voxels.erase(std::unique(voxels.begin(), voxels.end(), [&](Voxel a, Voxel b) { return key(a) == key(b); }),
               voxels.end());
  return voxels;
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
  for_each_index(int64_t(0), samples->sample.size(), [&](int64_t site) {
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
