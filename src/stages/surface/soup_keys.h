// Sort keys of a soup's vertices and triangles, shared by what measures it and what snaps it.
#pragma once

#include <array>

#include "isoshell/advanced/stages.h"
#include "stages/halfedge/labelled_triangles.h"
#include "voxel/atomic.h"

namespace isoshell {

/// What a kernel sees of a soup.
struct SoupView {
  View<const WorldPoint> vertices;
  View<const std::array<uint32_t, 3>> triangles;
};
inline SoupView view_of(const TriangleSoup& soup) {
  return {{soup.vertices.data(), int64_t(soup.vertices.size())},
          {soup.triangles.data(), int64_t(soup.triangles.size())}};
}

/// Sorts by `key` first; `rest` carries more key in its high bits and the element's index in its low 32.
struct KeyedIndex {
  uint64_t key, rest;
};
struct KeyedLess {
  ISOSHELL_HD bool operator()(const KeyedIndex& a, const KeyedIndex& b) const {
    return a.key < b.key || (a.key == b.key && a.rest < b.rest);
  }
};

/// Sorts keys whose upper words are below `numbers`.
struct PlainSortKeys {
  template <class Exec>
  static void run(Exec& exec, View<KeyedIndex> keys, int64_t) {
    exec.sort(keys, KeyedLess{});
  }
};

struct MarkUsedVertices {
  SoupView soup;
  View<uint32_t> used;
  ISOSHELL_HD void operator()(int64_t t) const {
    for (int i = 0; i < 3; ++i) atomic_or(used[soup.triangles[t][i]], 1u);
  }
};
struct IsUsed {
  View<const uint32_t> used;
  ISOSHELL_HD bool operator()(int64_t i) const { return used[i] != 0; }
};
/// Indices of the vertices that triangles use, ascending.
template <class Exec>
Buffer<uint32_t> referenced_vertices(Exec& exec, const SoupView& soup) {
  Buffer<uint32_t> used = exec.template make<uint32_t>(soup.vertices.size);
  exec.fill(used.view(), 0u);
  exec.for_each("mark used vertices", soup.triangles.size, MarkUsedVertices{soup, used.view()});
  return exec.select(used.size(), IsUsed{used.view()});
}

template <class Starts>
struct NumberRuns {
  View<uint32_t> number;
  Starts starts;
  ISOSHELL_HD void operator()(int64_t i) const { number[i] -= starts(i) ? 0 : 1; }
};
/// Numbers runs of equal neighbours: number[i] is the count of starts(j), j <= i, less one. Returns the number of runs.
template <class Exec, class Starts>
int64_t number_runs(Exec& exec, View<uint32_t> number, Starts starts) {
  const int64_t runs = int64_t(exec.exclusive_scan_of(number.size, starts, number));
  exec.for_each("number runs", number.size, NumberRuns<Starts>{number, starts});
  return runs;
}

struct KeyTriangles {
  SoupView soup;
  View<const uint32_t> point_of_vertex;
  View<KeyedIndex> keys;
  ISOSHELL_HD void operator()(int64_t i) const {
    const std::array<uint32_t, 3>& t = soup.triangles[i];
    const TriangleIndices s = smallest_first({point_of_vertex[t[0]], point_of_vertex[t[1]], point_of_vertex[t[2]]});
    keys[i] = {uint64_t(s.a) << 32 | s.b, uint64_t(s.c) << 32 | uint64_t(i)};
  }
};
/// Triangles as sorted rotations of point numbers, which are below `points`. `rest` holds the third corner, then the
/// triangle's index.
template <class Exec>
Buffer<KeyedIndex> sorted_triangles(Exec& exec, const SoupView& soup, View<const uint32_t> point_of_vertex,
                                    int64_t points) {
  Buffer<KeyedIndex> keys = exec.template make<KeyedIndex>(soup.triangles.size);
  exec.for_each("key triangles", keys.size(), KeyTriangles{soup, point_of_vertex, keys.view()});
  Exec::Kernels::SortKeys::run(exec, keys.view(), points);
  return keys;
}
ISOSHELL_HD inline bool same_corners(const KeyedIndex& a, const KeyedIndex& b) {
  return a.key == b.key && a.rest >> 32 == b.rest >> 32;
}
ISOSHELL_HD inline TriangleIndices corners_of(const KeyedIndex& k) {
  return {uint32_t(k.key >> 32), uint32_t(k.key), uint32_t(k.rest >> 32)};
}

}  // namespace isoshell
