// make_surface_mesh (see stages.h), written once over an executor of the host: what it is made of lies there.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/buckets.h"
#include "isoshell/error.h"
#include "stages/halfedge/surface_borders_body.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace surface_mesh {

/// Vertices by patch, leaf, position and number: those of a block are consecutive and near to one another.
struct VertexKey {
  uint64_t leaf;
  PointQ8 position;
  uint32_t patch, vertex;
};
struct ByPlace {
  bool operator()(const VertexKey& a, const VertexKey& b) const {
    if (a.patch != b.patch) return a.patch < b.patch;
    if (a.leaf != b.leaf) return a.leaf < b.leaf;
    if (a.position.x != b.position.x) return a.position.x < b.position.x;
    if (a.position.y != b.position.y) return a.position.y < b.position.y;
    if (a.position.z != b.position.z) return a.position.z < b.position.z;
    return a.vertex < b.vertex;
  }
};
struct ByCorners {
  bool operator()(const TriangleIndices& s, const TriangleIndices& t) const {
    return s.a != t.a ? s.a < t.a : (s.b != t.b ? s.b < t.b : s.c < t.c);
  }
};
inline TriangleIndices from_smallest_corner(TriangleIndices t) {
  if (t.b < t.a && t.b < t.c) return {t.b, t.c, t.a};
  if (t.c < t.a && t.c < t.b) return {t.c, t.a, t.b};
  return t;
}
inline Vec64 area_vector(const SurfaceMesh& surface, TriangleIndices t) {
  return cross(difference(surface.position[t.b], surface.position[t.a]),
               difference(surface.position[t.c], surface.position[t.a]));
}

inline PointQ8 leaf_centre(Voxel leaf) {
  const auto middle = [](int32_t leaf_coordinate) { return (leaf_coordinate * 8 + 4) * kOneVoxelQ8; };
  return {middle(leaf.x), middle(leaf.y), middle(leaf.z)};
}

/// Numbers the vertices, and takes their positions and patches. Result: per vertex as given its number.
template <class Exec>
std::vector<uint32_t> order_vertices(Exec& exec, const SurfaceTriangles& from, SurfaceMesh& surface) {
  const auto vertices = int64_t(from.position.size());
  Buffer<VertexKey> keys(vertices);
  exec.for_each("key vertices", vertices, [&](int64_t v) {
    const PointQ8 p = from.position[size_t(v)];
    keys[v] = {leaf_key(leaf_of_voxel(voxel_of(p))), p, from.patch.empty() ? 0 : from.patch[size_t(v)], uint32_t(v)};
  });
  exec.sort(keys.view(), ByPlace{});
  std::vector<uint32_t> number(from.position.size());
  surface.position = Buffer<PointQ8>(vertices);
  if (!from.patch.empty()) surface.patch = Buffer<uint32_t>(vertices);
  exec.for_each("place vertices", vertices, [&](int64_t i) {
    number[keys[i].vertex] = uint32_t(i);
    surface.position[i] = keys[i].position;
    if (!from.patch.empty()) surface.patch[i] = keys[i].patch;
  });
  return number;
}

template <class Exec>
void order_triangles(Exec& exec, const SurfaceTriangles& from, const std::vector<uint32_t>& number,
                     SurfaceMesh& surface) {
  surface.triangles = Buffer<TriangleIndices>(int64_t(from.triangles.size()));
  exec.for_each("number corners", surface.triangles.size(), [&](int64_t t) {
    const TriangleIndices& old = from.triangles[size_t(t)];
    surface.triangles[t] = from_smallest_corner({number[old.a], number[old.b], number[old.c]});
  });
  exec.sort(surface.triangles.view(), ByCorners{});
}

inline void list_triangles_around(SurfaceMesh& surface) {
  Buckets<uint32_t> around =
      sort_into_buckets<uint32_t>(surface.vertex_count(), surface.triangles.size(), [&](int64_t t, auto put) {
        const TriangleIndices i = surface.triangles[t];
        for (const uint32_t v : {i.a, i.b, i.c}) put(v, uint32_t(t));
      });
  surface.vertex_first = std::move(around.first);
  surface.vertex_triangles = std::move(around.items);
}

/// Along the sum of the area vectors around a vertex; where they cancel, of the first triangle that has area.
template <class Exec>
void find_normals(Exec& exec, SurfaceMesh& surface) {
  surface.normal = Buffer<Normal8>(surface.vertex_count());
  exec.for_each("normals", surface.vertex_count(), [&](int64_t v) {
    const auto is_zero = [](Vec64 n) { return n.x == 0 && n.y == 0 && n.z == 0; };
    Vec64 sum = {0, 0, 0}, any = {0, 0, 0};
    for (int64_t i = surface.vertex_first[v]; i < surface.vertex_first[v + 1]; ++i) {
      const Vec64 n = area_vector(surface, surface.triangles[surface.vertex_triangles[i]]);
      sum = sum + n;
      if (is_zero(any)) any = n;
    }
    surface.normal[v] = normal8(is_zero(sum) ? any : sum);
  });
}

/// Whether the triangles around a vertex are one fan: each leads to the next over an edge that it shares with no other.
inline bool is_one_fan(const SurfaceMesh& surface, int64_t v) {
  struct Sector {
    uint32_t next, last;
  };
  thread_local std::vector<Sector> sectors;  // these are small, and many
  thread_local std::vector<uint32_t> last;
  sectors.clear();
  last.clear();
  for (int64_t i = surface.vertex_first[v]; i < surface.vertex_first[v + 1]; ++i) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[i]];
    sectors.push_back(t.a == v ? Sector{t.b, t.c} : (t.b == v ? Sector{t.c, t.a} : Sector{t.a, t.b}));
  }
  std::sort(sectors.begin(), sectors.end(), [](Sector s, Sector t) { return s.next < t.next; });
  for (const Sector& s : sectors) last.push_back(s.last);
  std::sort(last.begin(), last.end());
  for (size_t i = 1; i < sectors.size(); ++i)
    if (sectors[i].next == sectors[i - 1].next || last[i] == last[i - 1]) return false;
  // On a border the turn begins with the sector that no other one leads to.
  Sector at = sectors[0];
  for (const Sector& s : sectors)
    if (!std::binary_search(last.begin(), last.end(), s.next)) at = s;
  const uint32_t start = at.next;
  for (size_t passed = 1; passed < sectors.size(); ++passed) {
    const auto found = std::lower_bound(sectors.begin(), sectors.end(), at.last,
                                        [](const Sector& s, uint32_t next) { return s.next < next; });
    if (found == sectors.end() || found->next != at.last || found->next == start) return false;
    at = *found;
  }
  return true;
}

template <class Exec>
void require_fans(Exec& exec, const SurfaceMesh& surface, const std::vector<uint32_t>& number) {
  const auto is_wrong = [&](int64_t v) { return is_one_fan(surface, v) ? 0 : 1; };
  const int64_t wrong = exec.sum(surface.vertex_count(), is_wrong);
  if (wrong == 0) return;
  const uint32_t first = exec.select(surface.vertex_count(), is_wrong)[0];
  const auto given = std::find(number.begin(), number.end(), first) - number.begin();
  throw Error(ErrorCode::usage, "surface",
              "around " + std::to_string(wrong) + " vertices, as vertex " + std::to_string(given) +
                  ", the triangles are no oriented manifold: an edge has three of them, or two that pass it the same " +
                  "way, or they are several fans; repair the faces first, or give every fan a vertex of its own");
}

/// A triangle may be in the block of any of its corners.
template <class Exec>
void require_reach(Exec& exec, const SurfaceMesh& surface) {
  const auto is_far = [&](int64_t t) {
    const TriangleIndices i = surface.triangles[t];
    for (const uint32_t v : {i.a, i.b, i.c})
      for (const uint32_t u : {i.a, i.b, i.c}) {
        const PointQ8 c = leaf_centre(leaf_of_voxel(voxel_of(surface.position[v]))), p = surface.position[u];
        const Vec64 d = difference(p, c);
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) >= VertexBlocks::kReachQ8) return 1;
      }
    return 0;
  };
  const int64_t far = exec.sum(surface.triangles.size(), is_far);
  if (far == 0) return;
  const PointQ8 p = surface.position[surface.triangles[exec.select(surface.triangles.size(), is_far)[0]].a];
  throw Error(ErrorCode::usage, "surface",
              std::to_string(far) + " triangles, as one at voxel (" + std::to_string(p.x / kOneVoxelQ8) + ", " +
                  std::to_string(p.y / kOneVoxelQ8) + ", " + std::to_string(p.z / kOneVoxelQ8) + "), reach " +
                  std::to_string(VertexBlocks::kReachQ8 / kOneVoxelQ8) +
                  " voxels or more from the middle of a corner's leaf; split their edges, or use larger voxels");
}

/// Blocks are the vertices of a patch in a leaf, cut where they are more than a block may have.
inline void cut_into_blocks(SurfaceMesh& surface) {
  std::vector<int64_t> first;
  std::vector<PointQ8> centre;
  const auto leaf_at = [&](int64_t v) { return leaf_of_voxel(voxel_of(surface.position[v])); };
  const auto patch_of = [&](int64_t v) { return surface.patch.empty() ? 0 : surface.patch[v]; };
  for (int64_t v = 0; v < surface.vertex_count(); ++v) {
    const Voxel leaf = leaf_at(v);
    if (v > 0 && leaf == leaf_at(v - 1) && patch_of(v) == patch_of(v - 1) &&
        v - first.back() < VertexBlocks::kMostVertices)
      continue;
    first.push_back(v);
    centre.push_back(leaf_centre(leaf));
  }
  surface.blocks.centre = Buffer<PointQ8>(int64_t(centre.size()));
  std::copy(centre.begin(), centre.end(), surface.blocks.centre.begin());
  first.push_back(surface.vertex_count());
  surface.blocks.first = Buffer<int64_t>(int64_t(first.size()));
  std::copy(first.begin(), first.end(), surface.blocks.first.begin());
}

}  // namespace surface_mesh

template <class Exec>
MadeSurface make_surface_mesh_body(Exec& exec, const SurfaceTriangles& from) {
  using namespace surface_mesh;
  MadeSurface made;
  SurfaceMesh& surface = made.surface;
  std::copy(from.extent_vox, from.extent_vox + 3, surface.extent_vox);
  made.number = order_vertices(exec, from, surface);
  order_triangles(exec, from, made.number, surface);
  require_reach(exec, surface);
  list_triangles_around(surface);
  require_fans(exec, surface, made.number);
  find_normals(exec, surface);
  cut_into_blocks(surface);
  find_borders(exec, surface);
  return made;
}

}  // namespace isoshell
