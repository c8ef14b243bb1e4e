// snap_surface (see stages.h) over an executor. Host only: world units are double.
#pragma once

#include "stages/soup_keys.h"
#include "voxel/leaf.h"

namespace isoshell {

/// Key of a lattice position: leaf key and x, y, z in the leaf, over 82 bits, then the vertex. Leaf keys of the largest
/// lattice are below 2^49.
inline KeyedIndex position_key(PointQ8 p, uint32_t vertex) {
  const uint64_t leaf = leaf_key({p.x >> 11, p.y >> 11, p.z >> 11});
  const uint64_t inside = uint64_t(p.x & 2047) << 22 | uint64_t(p.y & 2047) << 11 | uint64_t(p.z & 2047);
  return {leaf << 15 | inside >> 18, (inside & 0x3ffff) << 32 | vertex};
}
inline PointQ8 position_of_key(const KeyedIndex& k) {
  const Voxel leaf = leaf_of_key(k.key >> 15);
  const uint64_t inside = (k.key & 0x7fff) << 18 | k.rest >> 32;
  return {int32_t(leaf.x * 2048 + int32_t(inside >> 22)), int32_t(leaf.y * 2048 + int32_t(inside >> 11 & 2047)),
          int32_t(leaf.z * 2048 + int32_t(inside & 2047))};
}
inline bool same_position(const KeyedIndex& a, const KeyedIndex& b) {
  return a.key == b.key && a.rest >> 32 == b.rest >> 32;
}

template <class Exec>
LatticeSurface snap_surface_body(Exec& exec, const TriangleSoup& soup, const LatticeFrame& frame) {
  const Buffer<uint32_t> used = referenced_vertices(exec, soup);
  Buffer<KeyedIndex> at = exec.template make<KeyedIndex>(used.size());
  exec.for_each("snap vertices", used.size(),
                [&](int64_t i) { at[i] = position_key(frame.snap(soup.vertices[used[i]]), used[i]); });
  exec.sort(at.view());

  LatticeSurface surface;
  surface.frame = frame;
  Buffer<uint32_t> number = exec.template make<uint32_t>(at.size());
  const auto starts_point = [&](int64_t i) { return i == 0 || !same_position(at[i - 1], at[i]); };
  surface.points = exec.template make<PointQ8>(number_runs(exec, number.view(), starts_point));
  Buffer<uint32_t> point_of_vertex = exec.template make<uint32_t>(int64_t(soup.vertices.size()));
  exec.for_each("store points", at.size(), [&](int64_t i) {
    point_of_vertex[uint32_t(at[i].rest)] = number[i];
    if (starts_point(i)) surface.points[number[i]] = position_of_key(at[i]);
  });

  const Buffer<KeyedIndex> keys = sorted_triangles(exec, soup, point_of_vertex.view());
  const Buffer<uint32_t> kept =
      exec.select(keys.size(), [&](int64_t i) { return i == 0 || !same_corners(keys[i - 1], keys[i]); });
  surface.triangles = exec.template make<TriangleIndices>(kept.size());
  surface.source_face = exec.template make<uint32_t>(kept.size());
  exec.for_each("store triangles", kept.size(), [&](int64_t i) {
    surface.triangles[i] = corners_of(keys[kept[i]]);
    surface.source_face[i] = uint32_t(keys[kept[i]].rest);
  });
  return surface;
}

}  // namespace isoshell
