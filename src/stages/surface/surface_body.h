// snap_surface (see stages.h), written once over an executor.
#pragma once

#include "stages/surface/soup_keys.h"
#include "voxel/leaf.h"
#include "voxel/snap.h"

namespace isoshell {

/// Key of a lattice position: leaf key and x, y, z in the leaf, over 82 bits, then the vertex. Leaf keys of the largest
/// lattice are below 2^49.
ISOSHELL_HD inline KeyedIndex position_key(PointQ8 p, uint32_t vertex) {
  const uint64_t leaf = leaf_key({p.x >> 11, p.y >> 11, p.z >> 11});
  const uint64_t inside = uint64_t(p.x & 2047) << 22 | uint64_t(p.y & 2047) << 11 | uint64_t(p.z & 2047);
  return {leaf << 15 | inside >> 18, (inside & 0x3ffff) << 32 | vertex};
}
ISOSHELL_HD inline PointQ8 position_of_key(const KeyedIndex& k) {
  const Voxel leaf = leaf_of_key(k.key >> 15);
  const uint64_t inside = (k.key & 0x7fff) << 18 | k.rest >> 32;
  return {int32_t(leaf.x * 2048 + int32_t(inside >> 22)), int32_t(leaf.y * 2048 + int32_t(inside >> 11 & 2047)),
          int32_t(leaf.z * 2048 + int32_t(inside & 2047))};
}
ISOSHELL_HD inline bool same_position(const KeyedIndex& a, const KeyedIndex& b) {
  return a.key == b.key && a.rest >> 32 == b.rest >> 32;
}

namespace snap_steps {

struct SnapVertices {
  SoupView soup;
  LatticeFrame frame;
  View<const uint32_t> used;
  View<KeyedIndex> at;
  ISOSHELL_HD void operator()(int64_t i) const {
    at[i] = position_key(snap_point(frame, soup.vertices[used[i]]), used[i]);
  }
};
struct StartsPoint {
  View<const KeyedIndex> at;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || !same_position(at[i - 1], at[i]); }
};
struct StorePoints {
  View<const KeyedIndex> at;
  View<const uint32_t> number;
  View<uint32_t> point_of_vertex;
  View<PointQ8> points;
  ISOSHELL_HD void operator()(int64_t i) const {
    point_of_vertex[uint32_t(at[i].rest)] = number[i];
    if (StartsPoint{at}(i)) points[number[i]] = position_of_key(at[i]);
  }
};
struct IsFirstTriangle {
  View<const KeyedIndex> keys;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || !same_corners(keys[i - 1], keys[i]); }
};
struct StoreTriangles {
  View<const KeyedIndex> keys;
  View<const uint32_t> kept;
  View<TriangleIndices> triangles;
  View<uint32_t> source_face;
  ISOSHELL_HD void operator()(int64_t i) const {
    triangles[i] = corners_of(keys[kept[i]]);
    source_face[i] = uint32_t(keys[kept[i]].rest);
  }
};

}  // namespace snap_steps

template <class Exec>
LatticeSurface snap_surface_body(Exec& exec, const SoupView& soup, const LatticeFrame& frame) {
  using namespace snap_steps;
  const Buffer<uint32_t> used = referenced_vertices(exec, soup);
  Buffer<KeyedIndex> at = exec.template make<KeyedIndex>(used.size());
  exec.for_each("snap vertices", used.size(), SnapVertices{soup, frame, used.view(), at.view()});
  exec.sort(at.view(), KeyedLess{});

  LatticeSurface surface;
  surface.frame = frame;
  Buffer<uint32_t> number = exec.template make<uint32_t>(at.size());
  surface.points = exec.template make<PointQ8>(number_runs(exec, number.view(), StartsPoint{at.view()}));
  Buffer<uint32_t> point_of_vertex = exec.template make<uint32_t>(soup.vertices.size);
  exec.for_each("store points", at.size(),
                StorePoints{at.view(), number.view(), point_of_vertex.view(), surface.points.view()});

  const Buffer<KeyedIndex> keys = sorted_triangles(exec, soup, point_of_vertex.view(), surface.points.size());
  const Buffer<uint32_t> kept = exec.select(keys.size(), IsFirstTriangle{keys.view()});
  surface.triangles = exec.template make<TriangleIndices>(kept.size());
  surface.source_face = exec.template make<uint32_t>(kept.size());
  exec.for_each("store triangles", kept.size(),
                StoreTriangles{keys.view(), kept.view(), surface.triangles.view(), surface.source_face.view()});
  return surface;
}

}  // namespace isoshell
