// make_surface_mesh (see stages.h), written once over an executor of the host: what it is made of lies there.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/buckets.h"
#include "isoshell/error.h"
#include "stages/halfedge/surface_borders_body.h"
#include "stages/halfedge/triangles_around.h"
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
struct ByPosition {
  bool operator()(const VertexKey& a, const VertexKey& b) const {
    if (a.patch != b.patch) return a.patch < b.patch;
    if (a.leaf != b.leaf) return a.leaf < b.leaf;
    if (a.position.x != b.position.x) return a.position.x < b.position.x;
    if (a.position.y != b.position.y) return a.position.y < b.position.y;
    if (a.position.z != b.position.z) return a.position.z < b.position.z;
    return a.vertex < b.vertex;
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
  exec.sort(keys.view(), ByPosition{});
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
  struct OtherCorners {
    uint32_t b, c;
    bool operator<(const OtherCorners& o) const { return b != o.b ? b < o.b : c < o.c; }
  };
  const auto triangles = int64_t(from.triangles.size());
  const Buckets<OtherCorners> by_smallest =
      sort_into_buckets<OtherCorners>(surface.vertex_count(), triangles, [&](int64_t t, auto put) {
        const TriangleIndices& old = from.triangles[size_t(t)];
        const TriangleIndices i = from_smallest_corner({number[old.a], number[old.b], number[old.c]});
        put(i.a, OtherCorners{i.b, i.c});
      });
  surface.triangles = Buffer<TriangleIndices>(triangles);
  exec.for_each("triangles of corners", surface.vertex_count(), [&](int64_t a) {
    for (int64_t t = by_smallest.first[a]; t < by_smallest.first[a + 1]; ++t)
      surface.triangles[t] = {uint32_t(a), by_smallest.items[t].b, by_smallest.items[t].c};
  });
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

/// What the triangles around a vertex are together.
struct Fan {
  bool is_one = false;                     ///< each leads to the next over an edge that it shares with no other
  uint32_t before = kNone, after = kNone;  ///< the vertex on the border of the surface, where it is on it
};

inline Fan fan_around(const SurfaceMesh& surface, int64_t v) {
  struct Sector {
    uint32_t next, last;
    const Sector* after = nullptr;  ///< the one it leads to
    bool is_behind = false;         ///< another one
  };
  constexpr size_t kFew = 16;                // so many are searched sooner than sorted
  thread_local std::vector<Sector> sectors;  // these are small, and many
  sectors.clear();
  for (int64_t i = surface.vertex_first[v]; i < surface.vertex_first[v + 1]; ++i) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[i]];
    sectors.push_back(t.a == v ? Sector{t.b, t.c} : (t.b == v ? Sector{t.c, t.a} : Sector{t.a, t.b}));
  }
  const auto by_next = [](const Sector& s, const Sector& t) { return s.next < t.next; };
  const bool are_few = sectors.size() <= kFew;
  if (!are_few) std::sort(sectors.begin(), sectors.end(), by_next);
  const auto find = [&](uint32_t next) -> Sector* {
    if (!are_few) {
      const auto found = std::lower_bound(sectors.begin(), sectors.end(), Sector{next, 0}, by_next);
      return found != sectors.end() && found->next == next ? &*found : nullptr;
    }
    Sector* found = nullptr;
    for (Sector& s : sectors) found = s.next == next ? &s : found;
    return found;
  };
  for (Sector& s : sectors)
    if (Sector* const after = find(s.last)) {
      if (after->is_behind) return {};
      after->is_behind = true;
      s.after = after;
    }
  // On a border the turn begins with the sector that is behind no other one.
  const Sector* begin = &sectors[0];
  for (const Sector& s : sectors) begin = s.is_behind ? begin : &s;
  const Sector* at = begin;
  for (size_t passed = 1; passed < sectors.size(); ++passed) {
    at = at->after;
    if (!at || at->next == begin->next) return {};
  }
  return begin->is_behind ? Fan{true} : Fan{true, at->last, begin->next};
}

template <class Exec>
[[noreturn]] void refuse_fans(Exec& exec, const SurfaceMesh& surface, const std::vector<uint32_t>& number,
                              int64_t wrong) {
  const auto is_wrong = [&](int64_t v) { return !fan_around(surface, v).is_one; };
  const uint32_t first = exec.select(surface.vertex_count(), is_wrong)[0];
  const auto given = std::find(number.begin(), number.end(), first) - number.begin();
  throw Error(ErrorCode::usage, "surface",
              "around " + std::to_string(wrong) + " vertices, as vertex " + std::to_string(given) +
                  ", the triangles are no oriented manifold: an edge has three of them, or two that pass it the same " +
                  "way, or they are several fans; repair the faces first, or give every fan a vertex of its own");
}

/// Finds border_before and the chains. Throws: usage where the triangles around a vertex are no fan.
template <class Exec>
void find_borders(Exec& exec, const std::vector<uint32_t>& number, SurfaceMesh& surface) {
  const int64_t vertices = surface.vertex_count();
  Buffer<uint32_t> before(vertices), after(vertices);
  const int64_t wrong = exec.sum(vertices, [&](int64_t v) {
    const Fan fan = fan_around(surface, v);
    before[v] = fan.before;
    after[v] = fan.after;
    return fan.is_one ? 0 : 1;
  });
  if (wrong > 0) refuse_fans(exec, surface, number, wrong);
  const auto is_on_border = [](uint32_t u) { return u != kNone; };
  if (std::none_of(before.begin(), before.end(), is_on_border)) return;
  surface.border_before = std::move(before);
  chain_borders(exec, after.view(), surface);
}

/// A triangle may be in the block of any of its corners.
template <class Exec>
void require_reach(Exec& exec, const SurfaceMesh& surface) {
  const auto is_far = [&](int64_t t) {
    const TriangleIndices i = surface.triangles[t];
    for (const uint32_t v : {i.a, i.b, i.c}) {
      const PointQ8 c = leaf_centre(leaf_of_voxel(voxel_of(surface.position[v])));
      for (const uint32_t u : {i.a, i.b, i.c}) {
        const Vec64 d = difference(surface.position[u], c);
        if (std::max({std::abs(d.x), std::abs(d.y), std::abs(d.z)}) >= VertexBlocks::kReachQ8) return 1;
      }
    }
    return 0;
  };
  const int64_t far = exec.sum(surface.triangles.size(), is_far);
  if (far == 0) return;
  const PointQ8 p = surface.position[surface.triangles[exec.select(surface.triangles.size(), is_far)[0]].a];
  throw NoRoom("surface",
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
  find_borders(exec, made.number, surface);
  find_normals(exec, surface);
  cut_into_blocks(surface);
  return made;
}

}  // namespace isoshell
