// See open_mesh.h.
#include "features/walls/open_mesh.h"

#include <algorithm>
#include <numeric>
#include <tuple>
#include <utility>

#include "features/mesh/mesh_fans.h"
#include "geometry/half_edges.h"

namespace isoshell {
namespace {

bool is_free(const RegionVertex& v) { return v.kind == RegionVertex::Kind::free; }

/// The edges that are on curves; keys, ascending.
CurveEdges curve_edges_of(const EditableMesh& mesh) {
  CurveEdges edges;
  for (const RegionTriangle& t : mesh.triangles())
    for (size_t i = 0; i < 3 && !t.is_gone(); ++i)
      if (t.curve[i] != kNone) edges.push_back({edge_key(t.corner[i], t.corner[(i + 1) % 3]), t.curve[i]});
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  return edges;
}

std::vector<uint64_t> keys_of(const CurveEdges& edges) {
  std::vector<uint64_t> keys;
  for (const auto& [key, curve] : edges) keys.push_back(key);
  return keys;
}

}  // namespace

OpenMesh::OpenMesh(const EditableMesh& joined, const CutLookup& lookup)
    : joined_(joined), curves_(curve_edges_of(joined)) {
  MeshTriangles triangles;
  std::vector<uint32_t> patch;
  for (const RegionTriangle& t : joined.triangles()) {
    if (t.is_gone()) continue;
    triangles.push_back(t.corner);
    patch.push_back(t.patch);
  }
  const MeshFans fans = find_fans(triangles, int64_t(joined.vertices().size()), keys_of(curves_));
  std::vector<uint32_t> patch_of_fan(fans.vertex.size()), order(fans.vertex.size()), number(fans.vertex.size());
  for (size_t c = 0; c < fans.of_corner.size(); ++c) patch_of_fan[fans.of_corner[c]] = patch[c / 3];
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](uint32_t f, uint32_t g) {  // those off the free vertices come first
    const uint32_t u = fans.vertex[f], v = fans.vertex[g];
    return std::make_tuple(is_free(joined.vertex(u)), u, f) < std::make_tuple(is_free(joined.vertex(v)), v, g);
  });
  for (uint32_t i = 0; i < order.size(); ++i) {
    number[order[i]] = i;
    of_joined_.push_back(fans.vertex[order[i]]);
    patch_.push_back(patch_of_fan[order[i]]);
  }
  place_vertices(lookup);
  made_.mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  const auto at = [&](size_t corner) { return number[fans.of_corner[corner]]; };
  for (size_t t = 0; t < triangles.size(); ++t)
    made_.mesh.triangles[int64_t(t)] = {at(3 * t), at(3 * t + 1), at(3 * t + 2)};
}

/// With the seeds of the vertices, of which those off the free ones are fixed.
void OpenMesh::place_vertices(const CutLookup& lookup) {
  const SurfaceMesh& surface = lookup.cut().surface;
  const auto count = int64_t(of_joined_.size());
  SeedSet& seeds = made_.seeds;
  seeds.position = Buffer<PointQ8>(count);
  seeds.normal = Buffer<Normal8>(count);
  seeds.home = Buffer<uint32_t>(count);
  for (int64_t i = 0; i < count; ++i) {
    const RegionVertex& v = joined_.vertex(of_joined_[size_t(i)]);
    const uint32_t copy = lookup.copy_in(v.home, patch_[size_t(i)]);
    seeds.home[i] = copy != kNone ? copy : v.home;  // patches may touch at a point
    seeds.position[i] = rounded_down(v.position);
    seeds.normal[i] = surface.normal[seeds.home[i]];
    seeds.fixed.count += is_free(v) ? 0 : 1;
  }
  made_.mesh.position = seeds.position.to_host();
  seeds.fixed.joined = Buffer<uint32_t>(seeds.fixed.count);
  seeds.fixed.of_vertex = Buffer<uint32_t>(seeds.fixed.count > 0 ? surface.vertex_count() : 0);
  std::fill(seeds.fixed.of_vertex.begin(), seeds.fixed.of_vertex.end(), kNone);
  for (int64_t i = 0; i < seeds.fixed.count; ++i) {
    const bool is_first = i == 0 || of_joined_[size_t(i)] != of_joined_[size_t(i) - 1];
    seeds.fixed.joined[i] = is_first ? uint32_t(i) : seeds.fixed.joined[i - 1];
    seeds.fixed.of_vertex[seeds.home[i]] = uint32_t(i);
  }
}

EditableMesh OpenMesh::joined_again(const SeededMesh& optimized) const {
  std::vector<RegionVertex> vertices = joined_.vertices();
  for (int64_t i = optimized.seeds.fixed.count; i < optimized.seeds.size(); ++i) {
    RegionVertex& v = vertices[of_joined_[size_t(i)]];
    const PointQ8 p = optimized.mesh.position[i];
    v.home = optimized.seeds.home[i];
    v.position = {double(p.x), double(p.y), double(p.z)};
  }
  std::vector<RegionTriangle> triangles;
  for (const TriangleIndices& t : optimized.mesh.triangles) {
    const uint32_t a = of_joined_[t.a], b = of_joined_[t.b], c = of_joined_[t.c];
    triangles.push_back(
        {{a, b, c}, {curve_of(curves_, a, b), curve_of(curves_, b, c), curve_of(curves_, c, a)}, patch_[t.a]});
  }
  return {std::move(vertices), std::move(triangles), EditableMesh::Size::many};
}

}  // namespace isoshell
