// Sort keys of a soup's vertices and triangles, shared by what measures it and what snaps it. Host only.
#pragma once

#include <algorithm>
#include <array>

#include "isoshell/stages.h"
#include "voxel/atomic.h"

namespace isoshell {

/// Sorts by `key` first; `rest` carries more key in its high bits and the element's index in its low 32.
struct KeyedIndex {
  uint64_t key, rest;
};
inline bool operator<(const KeyedIndex& a, const KeyedIndex& b) {
  return a.key < b.key || (a.key == b.key && a.rest < b.rest);
}

/// Corners turned so that the triple is the smallest of its three rotations.
inline std::array<uint32_t, 3> smallest_first(std::array<uint32_t, 3> t) {
  const std::array<uint32_t, 3> r = {t[1], t[2], t[0]}, s = {t[2], t[0], t[1]};
  return std::min(t, std::min(r, s));
}

/// Indices of the vertices that triangles use, ascending.
template <class Exec>
Buffer<uint32_t> referenced_vertices(Exec& exec, const TriangleSoup& soup) {
  const int64_t vertices = int64_t(soup.vertices.size());
  Buffer<uint8_t> used = exec.template make<uint8_t>(vertices);
  exec.fill(used.view(), uint8_t(0));
  exec.for_each("mark used vertices", int64_t(soup.triangles.size()), [&](int64_t t) {
    for (uint32_t v : soup.triangles[size_t(t)]) atomic_or(used[v], uint8_t(1));
  });
  return exec.select(vertices, [&](int64_t v) { return used[v] != 0; });
}

/// Numbers runs of equal neighbours: number[i] is the count of starts(j), j <= i, less one. Returns the number of runs.
template <class Exec, class Starts>
int64_t number_runs(Exec& exec, View<uint32_t> number, Starts starts) {
  exec.for_each("mark runs", number.size, [&](int64_t i) { number[i] = starts(i) ? 1 : 0; });
  const int64_t runs = int64_t(exec.exclusive_scan(number));
  exec.for_each("number runs", number.size, [&](int64_t i) { number[i] -= starts(i) ? 0 : 1; });
  return runs;
}

/// Triangles as sorted rotations of point numbers. `rest` holds the third corner, then the triangle's index.
template <class Exec>
Buffer<KeyedIndex> sorted_triangles(Exec& exec, const TriangleSoup& soup, View<const uint32_t> point_of_vertex) {
  Buffer<KeyedIndex> keys = exec.template make<KeyedIndex>(int64_t(soup.triangles.size()));
  exec.for_each("key triangles", keys.size(), [&](int64_t i) {
    const auto& t = soup.triangles[size_t(i)];
    const auto s = smallest_first({point_of_vertex[t[0]], point_of_vertex[t[1]], point_of_vertex[t[2]]});
    keys[i] = {uint64_t(s[0]) << 32 | s[1], uint64_t(s[2]) << 32 | uint64_t(i)};
  });
  exec.sort(keys.view());
  return keys;
}
inline bool same_corners(const KeyedIndex& a, const KeyedIndex& b) {
  return a.key == b.key && a.rest >> 32 == b.rest >> 32;
}
inline TriangleIndices corners_of(const KeyedIndex& k) {
  return {uint32_t(k.key >> 32), uint32_t(k.key), uint32_t(k.rest >> 32)};
}

}  // namespace isoshell
