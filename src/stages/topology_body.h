// measure_topology (see stages.h) over an executor. Host only: world units are double.
#pragma once

#include <cmath>
#include <cstring>

#include "stages/soup_keys.h"
#include "voxel/random.h"
#include "voxel/union_find.h"

namespace isoshell {

/// Hash of a position; equal for equal positions, of which +0 and -0 are one.
inline uint64_t position_hash(WorldPoint p) {
  const double c[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
  uint64_t hash = 0, bits;
  for (double x : c) {
    std::memcpy(&bits, &x, sizeof bits);
    hash = mix64(hash + 0x9e3779b97f4a7c15ull) ^ bits;
  }
  return mix64(hash);
}

/// Order of welding: by hash, then position, then index. It does not depend on the order of the file's vertices.
struct BeforeInWeld {
  const TriangleSoup* soup;
  bool operator()(const KeyedIndex& a, const KeyedIndex& b) const {
    if (a.key != b.key) return a.key < b.key;
    const WorldPoint &p = soup->vertices[a.rest], &q = soup->vertices[b.rest];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a.rest < b.rest;
  }
};

/// The soup after welding: distinct positions, and the faces with three distinct corners, once per orientation, sorted.
struct WeldedMesh {
  Buffer<uint32_t> vertex;  ///< of the soup, one per position
  Buffer<TriangleIndices> faces;
  int64_t repeats = 0;  ///< triangles left out because the same one was there already
};

template <class Exec>
WeldedMesh weld(Exec& exec, const TriangleSoup& soup) {
  const Buffer<uint32_t> used = referenced_vertices(exec, soup);
  Buffer<KeyedIndex> at = exec.template make<KeyedIndex>(used.size());
  exec.for_each("hash vertices", used.size(), [&](int64_t i) {
    at[i] = {position_hash(soup.vertices[used[i]]), used[i]};
  });
  exec.sort(at.view(), BeforeInWeld{&soup});
  const auto starts = [&](int64_t i) {
    if (i == 0 || at[i - 1].key != at[i].key) return true;
    const WorldPoint &p = soup.vertices[at[i - 1].rest], &q = soup.vertices[at[i].rest];
    return p.x != q.x || p.y != q.y || p.z != q.z;
  };
  Buffer<uint32_t> number = exec.template make<uint32_t>(at.size());
  WeldedMesh mesh;
  mesh.vertex = exec.template make<uint32_t>(number_runs(exec, number.view(), starts));
  Buffer<uint32_t> welded = exec.template make<uint32_t>(int64_t(soup.vertices.size()));
  exec.for_each("store welded", at.size(), [&](int64_t i) {
    welded[uint32_t(at[i].rest)] = number[i];
    if (starts(i)) mesh.vertex[number[i]] = uint32_t(at[i].rest);
  });

  const Buffer<KeyedIndex> keys = sorted_triangles(exec, soup, welded.view());
  const auto has_corners = [&](int64_t i) {
    const TriangleIndices t = corners_of(keys[i]);
    return t.a != t.b && t.b != t.c && t.c != t.a;
  };
  const auto is_repeat = [&](int64_t i) { return i > 0 && same_corners(keys[i - 1], keys[i]); };
  const Buffer<uint32_t> kept = exec.select(keys.size(), [&](int64_t i) { return has_corners(i) && !is_repeat(i); });
  mesh.repeats = exec.sum(keys.size(), [&](int64_t i) { return int64_t(has_corners(i) && is_repeat(i)); });
  mesh.faces = exec.template make<TriangleIndices>(kept.size());
  exec.for_each("store faces", kept.size(), [&](int64_t i) { mesh.faces[i] = corners_of(keys[kept[i]]); });
  return mesh;
}

/// Twice the vector area.
inline WorldPoint doubled_area(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double ux = b.x - a.x, uy = b.y - a.y, uz = b.z - a.z, vx = c.x - a.x, vy = c.y - a.y, vz = c.z - a.z;
  return {uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx};
}

/// Sum over the welded faces: their order is that of the welded mesh, and the partial sums have a fixed shape.
template <class Exec>
double area_of(Exec& exec, const TriangleSoup& soup, const WeldedMesh& mesh) {
  constexpr int64_t kChunk = 4096;
  const int64_t faces = mesh.faces.size(), chunks = (faces + kChunk - 1) / kChunk;
  Buffer<double> part = exec.template make<double>(chunks);
  const auto corner = [&](uint32_t v) -> const WorldPoint& { return soup.vertices[mesh.vertex[v]]; };
  exec.for_each("add areas", chunks, [&](int64_t c) {
    double sum = 0;
    for (int64_t f = c * kChunk; f < std::min(faces, (c + 1) * kChunk); ++f) {
      const TriangleIndices t = mesh.faces[f];
      const WorldPoint n = doubled_area(corner(t.a), corner(t.b), corner(t.c));
      sum += 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
    }
    part[c] = sum;
  });
  double area = 0;
  for (double p : part) area += p;
  return area;
}

/// Half-edges of the welded faces, number 3 f + corner, in the order of their undirected edges.
struct EdgeRuns {
  static constexpr uint64_t kReversed = uint64_t(1)
                                        << 63;  ///< set in `rest` when it goes from the larger to the smaller
  Buffer<KeyedIndex> half;
  Buffer<uint32_t> first;  ///< where each edge's run starts

  int64_t count() const { return first.size(); }
  int64_t faces_of(int64_t e) const { return (e + 1 < first.size() ? int64_t(first[e + 1]) : half.size()) - first[e]; }
  bool agrees(int64_t e) const { return ((half[first[e]].rest ^ half[first[e] + 1].rest) & kReversed) != 0; }
  uint32_t half_edge(int64_t e, int which) const { return uint32_t(half[first[e] + which].rest); }
};

template <class Exec>
EdgeRuns edges_of(Exec& exec, const WeldedMesh& mesh) {
  EdgeRuns edges;
  edges.half = exec.template make<KeyedIndex>(3 * mesh.faces.size());
  exec.for_each("key edges", mesh.faces.size(), [&](int64_t f) {
    const TriangleIndices t = mesh.faces[f];
    const uint32_t corner[4] = {t.a, t.b, t.c, t.a};
    for (int i = 0; i < 3; ++i) {
      const uint32_t from = corner[i], to = corner[i + 1];
      edges.half[3 * f + i] = {uint64_t(std::min(from, to)) << 32 | std::max(from, to),
                               uint64_t(3 * f + i) | (from > to ? EdgeRuns::kReversed : 0)};
    }
  });
  exec.sort(edges.half.view());
  edges.first =
      exec.select(edges.half.size(), [&](int64_t i) { return i == 0 || edges.half[i - 1].key != edges.half[i].key; });
  return edges;
}

template <class Exec>
Buffer<uint32_t> singletons(Exec& exec, int64_t count) {
  Buffer<uint32_t> parent = exec.template make<uint32_t>(count);
  exec.for_each("make singletons", count, StartAlone{parent.view()});
  return parent;
}
template <class Exec>
int64_t count_roots(Exec& exec, const Buffer<uint32_t>& parent) {
  return exec.sum(parent.size(), [&](int64_t i) { return int64_t(parent[i] == uint32_t(i)); });
}

/// Connected through shared vertices. Vertices that no face kept are not components.
template <class Exec>
int64_t count_components(Exec& exec, const WeldedMesh& mesh, int64_t unused_vertices) {
  Buffer<uint32_t> parent = singletons(exec, mesh.vertex.size());
  exec.for_each("join corners", mesh.faces.size(), [&](int64_t f) {
    join(parent.view(), mesh.faces[f].a, mesh.faces[f].b);
    join(parent.view(), mesh.faces[f].a, mesh.faces[f].c);
  });
  return count_roots(exec, parent) - unused_vertices;
}

template <class Exec>
int64_t count_boundary_loops(Exec& exec, const EdgeRuns& edges, int64_t vertices) {
  Buffer<uint32_t> parent = singletons(exec, vertices);
  Buffer<uint8_t> touched = exec.template make<uint8_t>(vertices);
  exec.fill(touched.view(), uint8_t(0));
  exec.for_each("join boundary", edges.count(), [&](int64_t e) {
    if (edges.faces_of(e) != 1) return;
    const uint64_t key = edges.half[edges.first[e]].key;
    join(parent.view(), uint32_t(key >> 32), uint32_t(key));
    atomic_or(touched[uint32_t(key >> 32)], uint8_t(1));
    atomic_or(touched[uint32_t(key)], uint8_t(1));
  });
  return exec.sum(vertices, [&](int64_t v) { return int64_t(touched[v] && parent[v] == uint32_t(v)); });
}

/// Of a closed mesh: corners connected around their vertex through shared edges. One fan per vertex makes a manifold.
template <class Exec>
int64_t count_fans(Exec& exec, const WeldedMesh& mesh, const EdgeRuns& edges) {
  Buffer<uint32_t> parent = singletons(exec, 3 * mesh.faces.size());
  const auto next = [](uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; };
  exec.for_each("join fans", edges.count(), [&](int64_t e) {
    uint32_t g = edges.half_edge(e, 0), h = edges.half_edge(e, 1);
    join(parent.view(), g, edges.agrees(e) ? next(h) : h);
    join(parent.view(), next(g), edges.agrees(e) ? h : next(h));
  });
  return count_roots(exec, parent);
}

/// Of a closed mesh: can its faces be turned so that all agree? Each face stands for two nodes, as it is and turned;
/// agreement joins them, and a face that meets its own turned self shows that there is no way.
template <class Exec>
bool is_orientable(Exec& exec, const WeldedMesh& mesh, const EdgeRuns& edges) {
  Buffer<uint32_t> parent = singletons(exec, 2 * mesh.faces.size());
  exec.for_each("join sides", edges.count(), [&](int64_t e) {
    const uint32_t f = edges.half_edge(e, 0) / 3, g = edges.half_edge(e, 1) / 3, turn = edges.agrees(e) ? 0 : 1;
    join(parent.view(), 2 * f, 2 * g + turn);
    join(parent.view(), 2 * f + 1, 2 * g + 1 - turn);
  });
  return exec.sum(mesh.faces.size(), [&](int64_t f) {
    return int64_t(find_root(parent.view(), uint32_t(2 * f)) == find_root(parent.view(), uint32_t(2 * f + 1)));
  }) == 0;
}

/// Faces of the soup without area, by its own coordinates.
template <class Exec>
int64_t count_degenerate(Exec& exec, const TriangleSoup& soup) {
  return exec.sum(int64_t(soup.triangles.size()), [&](int64_t i) {
    const auto& t = soup.triangles[size_t(i)];
    const WorldPoint n = doubled_area(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]);
    return int64_t(n.x == 0 && n.y == 0 && n.z == 0);
  });
}

/// Welded faces whose mirror image is there as well, counted once a pair.
template <class Exec>
int64_t count_mirrored(Exec& exec, const WeldedMesh& mesh) {
  const auto before = [](const TriangleIndices& s, const TriangleIndices& t) {
    return s.a != t.a ? s.a < t.a : s.b != t.b ? s.b < t.b : s.c < t.c;
  };
  return exec.sum(mesh.faces.size(), [&](int64_t f) {
    const TriangleIndices t = mesh.faces[f];
    return int64_t(t.b > t.c && std::binary_search(mesh.faces.begin(), mesh.faces.begin() + f,
                                                   TriangleIndices{t.a, t.c, t.b}, before));
  });
}

/// Welded vertices that a face kept.
template <class Exec>
int64_t count_vertices(Exec& exec, const WeldedMesh& mesh) {
  Buffer<uint8_t> used = exec.template make<uint8_t>(mesh.vertex.size());
  exec.fill(used.view(), uint8_t(0));
  exec.for_each("mark welded", mesh.faces.size(), [&](int64_t f) {
    const TriangleIndices t = mesh.faces[f];
    for (uint32_t v : {t.a, t.b, t.c}) atomic_or(used[v], uint8_t(1));
  });
  return exec.sum(mesh.vertex.size(), [&](int64_t v) { return int64_t(used[v]); });
}

template <class Exec>
InputTopology measure_topology_body(Exec& exec, const TriangleSoup& soup, DirtCounts& dirt) {
  InputTopology topology;
  const WeldedMesh mesh = weld(exec, soup);
  dirt.degenerate_faces += count_degenerate(exec, soup);
  dirt.duplicate_faces += mesh.repeats + count_mirrored(exec, mesh);
  topology.area_world = area_of(exec, soup, mesh);
  const EdgeRuns edges = edges_of(exec, mesh);
  const int64_t faces = mesh.faces.size();

  const auto count_edges = [&](auto is) { return exec.sum(edges.count(), [&](int64_t e) { return int64_t(is(e)); }); };
  dirt.nonmanifold_edges += count_edges([&](int64_t e) { return edges.faces_of(e) > 2; });
  const int64_t inconsistent = count_edges([&](int64_t e) { return edges.faces_of(e) == 2 && !edges.agrees(e); });
  dirt.inconsistent_edges += inconsistent;
  topology.closed = faces > 0 && count_edges([&](int64_t e) { return edges.faces_of(e) != 2; }) == 0;
  topology.oriented = topology.closed && inconsistent == 0;

  const int64_t vertices = count_vertices(exec, mesh);
  topology.euler = vertices - edges.count() + faces;
  topology.components = count_components(exec, mesh, mesh.vertex.size() - vertices);
  topology.boundary_loops = count_boundary_loops(exec, edges, mesh.vertex.size());
  const bool manifold = topology.closed && count_fans(exec, mesh, edges) == vertices;
  if (manifold && (topology.oriented || is_orientable(exec, mesh, edges)))
    topology.genus = topology.components - topology.euler / 2;
  return topology;
}

}  // namespace isoshell
