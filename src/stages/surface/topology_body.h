// measure_topology (see stages.h), written once over an executor.
#pragma once

#include <cmath>
#include <cstring>

#include "geometry/world_vector.h"
#include "stages/surface/soup_keys.h"
#include "voxel/random.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace topology_steps {

/// Hash of a position; equal for equal positions, of which +0 and -0 are one.
ISOSHELL_HD inline uint64_t position_hash(WorldPoint p) {
  const double c[3] = {p.x + 0.0, p.y + 0.0, p.z + 0.0};
  uint64_t hash = 0, bits;
  for (double x : c) {
    std::memcpy(&bits, &x, sizeof bits);
    hash = mix64(hash + 0x9e3779b97f4a7c15ull) ^ bits;
  }
  return mix64(hash);
}
ISOSHELL_HD inline bool are_apart(const WorldPoint& p, const WorldPoint& q) {
  return p.x != q.x || p.y != q.y || p.z != q.z;
}

struct HashVertices {
  SoupView soup;
  View<const uint32_t> used;
  View<KeyedIndex> at;
  ISOSHELL_HD void operator()(int64_t i) const { at[i] = {position_hash(soup.vertices[used[i]]), used[i]}; }
};
/// Order of welding: by hash, then position, then index. It does not depend on the order of the file's vertices.
struct BeforeInWeld {
  View<const WorldPoint> vertices;
  ISOSHELL_HD bool operator()(const KeyedIndex& a, const KeyedIndex& b) const {
    if (a.key != b.key) return a.key < b.key;
    const WorldPoint &p = vertices[a.rest], &q = vertices[b.rest];
    if (p.x != q.x) return p.x < q.x;
    if (p.y != q.y) return p.y < q.y;
    if (p.z != q.z) return p.z < q.z;
    return a.rest < b.rest;
  }
};
struct StartsWelded {
  View<const WorldPoint> vertices;
  View<const KeyedIndex> at;
  ISOSHELL_HD bool operator()(int64_t i) const {
    return i == 0 || at[i - 1].key != at[i].key || are_apart(vertices[at[i - 1].rest], vertices[at[i].rest]);
  }
};
struct StoreWelded {
  StartsWelded starts;
  View<const uint32_t> number;
  View<uint32_t> welded, vertex;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t v = uint32_t(starts.at[i].rest);
    welded[v] = number[i];
    if (starts(i)) vertex[number[i]] = v;
  }
};

/// Of the sorted triangles: three distinct corners, and not seen before.
struct IsRepeat {
  View<const KeyedIndex> keys;
  ISOSHELL_HD bool has_corners(int64_t i) const {
    const TriangleIndices t = corners_of(keys[i]);
    return t.a != t.b && t.b != t.c && t.c != t.a;
  }
  ISOSHELL_HD bool is_repeat(int64_t i) const { return i > 0 && same_corners(keys[i - 1], keys[i]); }
  ISOSHELL_HD int64_t operator()(int64_t i) const { return has_corners(i) && is_repeat(i) ? 1 : 0; }
};
struct IsFaceToKeep {
  IsRepeat of;
  ISOSHELL_HD bool operator()(int64_t i) const { return of.has_corners(i) && !of.is_repeat(i); }
};
struct StoreFaces {
  View<const KeyedIndex> keys;
  View<const uint32_t> kept;
  View<TriangleIndices> faces;
  ISOSHELL_HD void operator()(int64_t i) const { faces[i] = corners_of(keys[kept[i]]); }
};

/// The soup after welding: distinct positions, and the faces with three distinct corners, once per orientation, sorted.
struct WeldedMesh {
  Buffer<uint32_t> vertex;  ///< of the soup, one per position
  Buffer<TriangleIndices> faces;
  int64_t repeats = 0;  ///< triangles left out because the same one was there already
};

template <class Exec>
WeldedMesh weld(Exec& exec, const SoupView& soup) {
  const Buffer<uint32_t> used = referenced_vertices(exec, soup);
  Buffer<KeyedIndex> at = exec.template make<KeyedIndex>(used.size());
  exec.for_each("hash vertices", used.size(), HashVertices{soup, used.view(), at.view()});
  exec.sort(at.view(), BeforeInWeld{soup.vertices});
  const StartsWelded starts{soup.vertices, at.view()};
  Buffer<uint32_t> number = exec.template make<uint32_t>(at.size());
  WeldedMesh mesh;
  mesh.vertex = exec.template make<uint32_t>(number_runs(exec, number.view(), starts));
  Buffer<uint32_t> welded = exec.template make<uint32_t>(soup.vertices.size);
  exec.for_each("store welded", at.size(), StoreWelded{starts, number.view(), welded.view(), mesh.vertex.view()});

  const Buffer<KeyedIndex> keys = sorted_triangles(exec, soup, welded.view(), mesh.vertex.size());
  const IsRepeat is_repeat{keys.view()};
  const Buffer<uint32_t> kept = exec.select(keys.size(), IsFaceToKeep{is_repeat});
  mesh.repeats = exec.sum(keys.size(), is_repeat);
  mesh.faces = exec.template make<TriangleIndices>(kept.size());
  exec.for_each("store faces", kept.size(), StoreFaces{keys.view(), kept.view(), mesh.faces.view()});
  return mesh;
}

/// Areas of a run of faces, added one after the other.
struct AddAreas {
  static constexpr int64_t kChunk = 4096;
  View<const WorldPoint> vertices;
  View<const uint32_t> vertex;
  View<const TriangleIndices> faces;
  View<double> part;
  ISOSHELL_HD double area(int64_t f) const {
    const TriangleIndices t = faces[f];
    const WorldPoint n = doubled_area(vertices[vertex[t.a]], vertices[vertex[t.b]], vertices[vertex[t.c]]);
    return 0.5 * std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  }
  ISOSHELL_HD int64_t end(int64_t chunk) const {
    return (chunk + 1) * kChunk < faces.size ? (chunk + 1) * kChunk : faces.size;
  }
  ISOSHELL_HD void operator()(int64_t chunk) const {
    double sum = 0;
    for (int64_t f = chunk * kChunk; f < end(chunk); ++f) sum += area(f);
    part[chunk] = sum;
  }
};
/// Sum over the welded faces: their order is that of the welded mesh, and the partial sums have a fixed shape.
template <class Exec>
double area_of(Exec& exec, const SoupView& soup, const WeldedMesh& mesh) {
  const int64_t chunks = (mesh.faces.size() + AddAreas::kChunk - 1) / AddAreas::kChunk;
  Buffer<double> part = exec.template make<double>(chunks);
  exec.for_each("add areas", chunks, AddAreas{soup.vertices, mesh.vertex.view(), mesh.faces.view(), part.view()});
  double area = 0;
  for (double p : part.to_host()) area += p;
  return area;
}

/// Half-edges of the welded faces, number 3 f + corner, in the order of their undirected edges.
struct EdgeRunsView {
  static constexpr uint64_t kReversed = uint64_t(1)
                                        << 63;  ///< set in `rest` when it goes from the larger to the smaller
  View<const KeyedIndex> half;
  View<const uint32_t> first;  ///< where each edge's run starts

  ISOSHELL_HD int64_t faces_of(int64_t e) const {
    return (e + 1 < first.size ? int64_t(first[e + 1]) : half.size) - first[e];
  }
  ISOSHELL_HD bool agrees(int64_t e) const {
    return ((half[first[e]].rest ^ half[first[e] + 1].rest) & kReversed) != 0;
  }
  ISOSHELL_HD uint32_t half_edge(int64_t e, int which) const { return uint32_t(half[first[e] + which].rest); }
};
struct EdgeRuns {
  Buffer<KeyedIndex> half;
  Buffer<uint32_t> first;
  int64_t count() const { return first.size(); }
  EdgeRunsView view() const { return {half.view(), first.view()}; }
};

struct KeyEdges {
  View<const TriangleIndices> faces;
  View<KeyedIndex> half;
  ISOSHELL_HD void operator()(int64_t f) const {
    const TriangleIndices t = faces[f];
    const uint32_t corner[4] = {t.a, t.b, t.c, t.a};
    for (int i = 0; i < 3; ++i) {
      const uint32_t from = corner[i], to = corner[i + 1];
      const uint64_t smaller = from < to ? from : to, larger = from < to ? to : from;
      half[3 * f + i] = {smaller << 32 | larger, uint64_t(3 * f + i) | (from > to ? EdgeRunsView::kReversed : 0)};
    }
  }
};
struct StartsEdge {
  View<const KeyedIndex> half;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || half[i - 1].key != half[i].key; }
};
template <class Exec>
EdgeRuns edges_of(Exec& exec, const WeldedMesh& mesh) {
  EdgeRuns edges;
  edges.half = exec.template make<KeyedIndex>(3 * mesh.faces.size());
  exec.for_each("key edges", mesh.faces.size(), KeyEdges{mesh.faces.view(), edges.half.view()});
  Exec::Kernels::SortKeys::run(exec, edges.half.view(), mesh.vertex.size());
  edges.first = exec.select(edges.half.size(), StartsEdge{edges.half.view()});
  return edges;
}

struct HasManyFaces {
  EdgeRunsView edges;
  ISOSHELL_HD int64_t operator()(int64_t e) const { return edges.faces_of(e) > 2 ? 1 : 0; }
};
struct IsInconsistent {
  EdgeRunsView edges;
  ISOSHELL_HD int64_t operator()(int64_t e) const { return edges.faces_of(e) == 2 && !edges.agrees(e) ? 1 : 0; }
};
struct HasOtherThanTwoFaces {
  EdgeRunsView edges;
  ISOSHELL_HD int64_t operator()(int64_t e) const { return edges.faces_of(e) != 2 ? 1 : 0; }
};

struct IsRoot {
  View<const uint32_t> parent;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return parent[i] == uint32_t(i) ? 1 : 0; }
};
template <class Exec>
Buffer<uint32_t> singletons(Exec& exec, int64_t count) {
  Buffer<uint32_t> parent = exec.template make<uint32_t>(count);
  exec.for_each("make singletons", count, StartAlone{parent.view()});
  return parent;
}

/// Connected through shared vertices. Vertices that no face kept are not components.
struct JoinFaceCorners {
  View<const TriangleIndices> faces;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t f) const {
    join(parent, faces[f].a, faces[f].b);
    join(parent, faces[f].a, faces[f].c);
  }
};
template <class Exec>
int64_t count_components(Exec& exec, const WeldedMesh& mesh, int64_t unused_vertices) {
  Buffer<uint32_t> parent = singletons(exec, mesh.vertex.size());
  exec.for_each("join corners", mesh.faces.size(), JoinFaceCorners{mesh.faces.view(), parent.view()});
  return exec.sum(parent.size(), IsRoot{parent.view()}) - unused_vertices;
}

struct JoinBoundary {
  EdgeRunsView edges;
  View<uint32_t> parent, touched;
  ISOSHELL_HD void operator()(int64_t e) const {
    if (edges.faces_of(e) != 1) return;
    const uint64_t key = edges.half[edges.first[e]].key;
    join(parent, uint32_t(key >> 32), uint32_t(key));
    atomic_or(touched[uint32_t(key >> 32)], 1u);
    atomic_or(touched[uint32_t(key)], 1u);
  }
};
struct IsTouchedRoot {
  View<const uint32_t> parent, touched;
  ISOSHELL_HD int64_t operator()(int64_t v) const { return touched[v] && parent[v] == uint32_t(v) ? 1 : 0; }
};
template <class Exec>
int64_t count_boundary_loops(Exec& exec, const EdgeRuns& edges, int64_t vertices) {
  Buffer<uint32_t> parent = singletons(exec, vertices), touched = exec.template make<uint32_t>(vertices);
  exec.fill(touched.view(), 0u);
  exec.for_each("join boundary", edges.count(), JoinBoundary{edges.view(), parent.view(), touched.view()});
  return exec.sum(vertices, IsTouchedRoot{parent.view(), touched.view()});
}

/// Of a closed mesh: corners connected around their vertex through shared edges. One fan per vertex makes a manifold.
struct JoinFans {
  EdgeRunsView edges;
  View<uint32_t> parent;
  ISOSHELL_HD static uint32_t next(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  ISOSHELL_HD void operator()(int64_t e) const {
    const uint32_t g = edges.half_edge(e, 0), h = edges.half_edge(e, 1);
    join(parent, g, edges.agrees(e) ? next(h) : h);
    join(parent, next(g), edges.agrees(e) ? h : next(h));
  }
};
template <class Exec>
int64_t count_fans(Exec& exec, const WeldedMesh& mesh, const EdgeRuns& edges) {
  Buffer<uint32_t> parent = singletons(exec, 3 * mesh.faces.size());
  exec.for_each("join fans", edges.count(), JoinFans{edges.view(), parent.view()});
  return exec.sum(parent.size(), IsRoot{parent.view()});
}

/// Of a closed mesh: can its faces be turned so that all agree? Each face stands for two nodes, as it is and turned;
/// agreement joins them, and a face that meets its own turned self shows that there is no way.
struct JoinSides {
  EdgeRunsView edges;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t e) const {
    const uint32_t f = edges.half_edge(e, 0) / 3, g = edges.half_edge(e, 1) / 3, turn = edges.agrees(e) ? 0 : 1;
    join(parent, 2 * f, 2 * g + turn);
    join(parent, 2 * f + 1, 2 * g + 1 - turn);
  }
};
struct MeetsItself {
  View<uint32_t> parent;
  ISOSHELL_HD int64_t operator()(int64_t f) const {
    return find_root(parent, uint32_t(2 * f)) == find_root(parent, uint32_t(2 * f + 1)) ? 1 : 0;
  }
};
template <class Exec>
bool is_orientable(Exec& exec, const WeldedMesh& mesh, const EdgeRuns& edges) {
  Buffer<uint32_t> parent = singletons(exec, 2 * mesh.faces.size());
  exec.for_each("join sides", edges.count(), JoinSides{edges.view(), parent.view()});
  return exec.sum(mesh.faces.size(), MeetsItself{parent.view()}) == 0;
}

/// Faces of the soup without area, by its own coordinates.
struct IsDegenerate {
  SoupView soup;
  ISOSHELL_HD int64_t operator()(int64_t i) const {
    const std::array<uint32_t, 3>& t = soup.triangles[i];
    const WorldPoint n = doubled_area(soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]);
    return n.x == 0 && n.y == 0 && n.z == 0 ? 1 : 0;
  }
};

/// Welded faces whose mirror image is there as well, counted once a pair.
struct HasMirrorBefore {
  View<const TriangleIndices> faces;
  ISOSHELL_HD int64_t operator()(int64_t f) const {
    const TriangleIndices t = faces[f], mirror = {t.a, t.c, t.b};
    if (t.b <= t.c) return 0;
    int64_t lo = 0, hi = f;
    while (lo < hi) {
      const int64_t middle = lo + (hi - lo) / 2;
      if (less_corners(faces[middle], mirror))
        lo = middle + 1;
      else
        hi = middle;
    }
    return lo < f && faces[lo] == mirror ? 1 : 0;
  }
};

/// Welded vertices that a face kept.
struct MarkWelded {
  View<const TriangleIndices> faces;
  View<uint32_t> used;
  ISOSHELL_HD void operator()(int64_t f) const {
    atomic_or(used[faces[f].a], 1u);
    atomic_or(used[faces[f].b], 1u);
    atomic_or(used[faces[f].c], 1u);
  }
};
struct CountUsed {
  View<const uint32_t> used;
  ISOSHELL_HD int64_t operator()(int64_t v) const { return used[v]; }
};
template <class Exec>
int64_t count_vertices(Exec& exec, const WeldedMesh& mesh) {
  Buffer<uint32_t> used = exec.template make<uint32_t>(mesh.vertex.size());
  exec.fill(used.view(), 0u);
  exec.for_each("mark welded", mesh.faces.size(), MarkWelded{mesh.faces.view(), used.view()});
  return exec.sum(used.size(), CountUsed{used.view()});
}

}  // namespace topology_steps

template <class Exec>
InputTopology measure_topology_body(Exec& exec, const SoupView& soup, DirtCounts& dirt) {
  using namespace topology_steps;
  InputTopology topology;
  const WeldedMesh mesh = weld(exec, soup);
  dirt.degenerate_faces += exec.sum(soup.triangles.size, IsDegenerate{soup});
  dirt.duplicate_faces += mesh.repeats + exec.sum(mesh.faces.size(), HasMirrorBefore{mesh.faces.view()});
  topology.area_world = area_of(exec, soup, mesh);
  const EdgeRuns edges = edges_of(exec, mesh);
  const int64_t faces = mesh.faces.size();

  dirt.nonmanifold_edges += exec.sum(edges.count(), HasManyFaces{edges.view()});
  const int64_t inconsistent = exec.sum(edges.count(), IsInconsistent{edges.view()});
  dirt.inconsistent_edges += inconsistent;
  topology.closed = faces > 0 && exec.sum(edges.count(), HasOtherThanTwoFaces{edges.view()}) == 0;
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
