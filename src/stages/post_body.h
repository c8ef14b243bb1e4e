// improve_mesh (see stages.h): valence flips in independent sets and tangential smoothing on the sheet, in rounds.
// Every step is a Jacobi step or an independent set, so the order of the work cannot show.
#pragma once

#include "isoshell/stages.h"
#include "stages/label_body.h"
#include "stages/sheet_walk.h"
#include "voxel/atomic.h"

namespace isoshell {
namespace post {

/// Half-edge 3 t + i runs from corner i of triangle t to corner i + 1.
ISOSHELL_HD inline uint32_t corner(const TriangleIndices& t, int i) { return i == 0 ? t.a : (i == 1 ? t.b : t.c); }
ISOSHELL_HD inline uint32_t next_half_edge(uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
ISOSHELL_HD inline uint32_t previous_half_edge(uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }

/// A closed mesh with its half-edge twins, as steps see it.
struct MeshView {
  View<TriangleIndices> triangles;
  View<uint32_t> twin;
  View<uint32_t> valence;
  View<uint32_t> outgoing;  ///< some half-edge that starts at the vertex

  ISOSHELL_HD uint32_t from(uint32_t h) const { return corner(triangles[h / 3], int(h % 3)); }
  ISOSHELL_HD uint32_t to(uint32_t h) const { return from(next_half_edge(h)); }
  ISOSHELL_HD uint32_t opposite(uint32_t h) const { return from(previous_half_edge(h)); }
  ISOSHELL_HD bool are_neighbours(uint32_t u, uint32_t v) const {
    const uint32_t start = outgoing[u];
    uint32_t h = start;
    do {
      if (to(h) == v) return true;
      h = twin[previous_half_edge(h)];
    } while (h != start);
    return false;
  }
};

struct DirectedEdge {
  uint64_t ends;  ///< smaller vertex << 32 | larger vertex
  uint32_t half_edge;
};
struct ByEnds {
  ISOSHELL_HD bool operator()(const DirectedEdge& a, const DirectedEdge& b) const {
    return a.ends != b.ends ? a.ends < b.ends : a.half_edge < b.half_edge;
  }
};
struct ListEdge {
  View<const TriangleIndices> triangles;
  View<DirectedEdge> out;
  ISOSHELL_HD void operator()(int64_t h) const {
    const uint32_t u = corner(triangles[h / 3], int(h % 3)), v = corner(triangles[h / 3], int((h + 1) % 3));
    out[h] = {u < v ? uint64_t(u) << 32 | v : uint64_t(v) << 32 | u, uint32_t(h)};
  }
};
struct PairTwins {
  View<const DirectedEdge> edges;
  MeshView mesh;
  ISOSHELL_HD void operator()(int64_t pair) const {
    const uint32_t g = edges[2 * pair].half_edge, h = edges[2 * pair + 1].half_edge;
    mesh.twin[g] = h;
    mesh.twin[h] = g;
  }
};
struct CountValence {
  MeshView mesh;
  ISOSHELL_HD void operator()(int64_t h) const {
    const uint32_t v = mesh.from(uint32_t(h));
    atomic_add(mesh.valence[v], 1u);
    atomic_min(mesh.outgoing[v], uint32_t(h));
  }
};

/// Normal of a triangle, not normalised. Doubles hold it exactly: corners differ by less than 2^24.
struct Direction {
  double x, y, z;
};
ISOSHELL_HD inline Direction normal_of(PointQ8 a, PointQ8 b, PointQ8 c) {
  const Vec64 n = cross(difference(b, a), difference(c, a));
  return {double(n.x), double(n.y), double(n.z)};
}
ISOSHELL_HD inline double dot(Direction a, Direction b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
/// Angle below 45 degrees (cosine squared above one half).
ISOSHELL_HD inline bool within_45_degrees(Direction a, Direction b) {
  const double d = dot(a, b);
  return d > 0 && 2 * d * d > dot(a, a) * dot(b, b);
}

/// Square of 2 sqrt(3) |normal| / (sum of the squared edges): 1 for the equilateral triangle, 0 without area.
ISOSHELL_HD inline double shape_of(PointQ8 a, PointQ8 b, PointQ8 c) {
  const Direction n = normal_of(a, b, c);
  const double edges = double(distance_sq_q16(a, b)) + double(distance_sq_q16(b, c)) + double(distance_sq_q16(c, a));
  return edges > 0 ? 12 * dot(n, n) / (edges * edges) : 0;
}
/// Below this, an angle is near 30 degrees or less, and no step may make the triangle worse.
constexpr double kPoorShape = 0.5;
ISOSHELL_HD inline bool harms_shape(double before, double after) { return after < kPoorShape && after < before; }

/// Flips that would make valences more even, each with a key: larger gain first, then the smaller half-edge.
struct FlipKey {
  MeshView mesh;
  View<const PointQ8> position;

  ISOSHELL_HD static int32_t excess_sq(uint32_t valence) { return (int32_t(valence) - 6) * (int32_t(valence) - 6); }

  /// 0 when the flip gains nothing or would harm the mesh.
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    const uint32_t g = mesh.twin[h];
    if (g < h) return 0;
    const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    const uint32_t va = mesh.valence[a], vb = mesh.valence[b], vc = mesh.valence[c], vd = mesh.valence[d];
    const int32_t gain = excess_sq(va) + excess_sq(vb) + excess_sq(vc) + excess_sq(vd) - excess_sq(va - 1) -
                         excess_sq(vb - 1) - excess_sq(vc + 1) - excess_sq(vd + 1);
    if (gain <= 0 || va <= 4 || vb <= 4 || mesh.are_neighbours(c, d)) return 0;
    const PointQ8 pa = position[a], pb = position[b], pc = position[c], pd = position[d];
    const Direction before_1 = normal_of(pa, pb, pc), before_2 = normal_of(pb, pa, pd);
    const Direction before = {before_1.x + before_2.x, before_1.y + before_2.y, before_1.z + before_2.z};
    if (!within_45_degrees(before, normal_of(pa, pd, pc)) || !within_45_degrees(before, normal_of(pd, pb, pc)))
      return 0;
    const double shape_1 = shape_of(pa, pb, pc), shape_2 = shape_of(pb, pa, pd), flipped_1 = shape_of(pa, pd, pc),
                 flipped_2 = shape_of(pd, pb, pc);
    if (harms_shape(shape_1 < shape_2 ? shape_1 : shape_2, flipped_1 < flipped_2 ? flipped_1 : flipped_2)) return 0;
    return uint64_t(gain) << 32 | (0xffffffffu - h);
  }
};
struct ClaimVertices {
  FlipKey key;
  View<uint64_t> claim;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t h = uint32_t(i);
    const uint64_t k = key(h);
    if (k == 0) return;
    atomic_max(claim[key.mesh.from(h)], k);
    atomic_max(claim[key.mesh.to(h)], k);
    atomic_max(claim[key.mesh.opposite(h)], k);
    atomic_max(claim[key.mesh.opposite(key.mesh.twin[h])], k);
  }
};
/// A flip goes ahead when it holds the claim of all its four vertices.
struct WinsItsVertices {
  FlipKey key;
  View<const uint64_t> claim;
  ISOSHELL_HD bool operator()(int64_t i) const {
    const uint32_t h = uint32_t(i);
    const MeshView& m = key.mesh;
    if (0xffffffffu - uint32_t(claim[m.from(h)]) != h) return false;
    const uint64_t k = claim[m.from(h)];
    return k != 0 && claim[m.to(h)] == k && claim[m.opposite(h)] == k && claim[m.opposite(m.twin[h])] == k;
  }
};
/// (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c).
struct Flip {
  MeshView mesh;
  View<const uint32_t> winners;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t h = winners[i], g = mesh.twin[h];
    const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    const uint32_t bc = mesh.twin[next_half_edge(h)], ca = mesh.twin[previous_half_edge(h)];
    const uint32_t ad = mesh.twin[next_half_edge(g)], db = mesh.twin[previous_half_edge(g)];
    const uint32_t s = h / 3 * 3, t = g / 3 * 3;
    mesh.triangles[h / 3] = {a, d, c};
    mesh.triangles[g / 3] = {d, b, c};
    join(s, ad);
    join(s + 1, t + 2);
    join(s + 2, ca);
    join(t, db);
    join(t + 1, bc);
    mesh.outgoing[a] = s;
    mesh.outgoing[d] = s + 1;
    mesh.outgoing[c] = s + 2;
    mesh.outgoing[b] = t + 1;
    --mesh.valence[a];
    --mesh.valence[b];
    ++mesh.valence[c];
    ++mesh.valence[d];
  }
  ISOSHELL_HD void join(uint32_t g, uint32_t h) const {
    mesh.twin[g] = h;
    mesh.twin[h] = g;
  }
};

/// Half-way to the mean of the neighbours, back on the sheet.
struct SmoothVertex {
  MeshView mesh;
  WalkOntoSheet walk;
  View<const PointQ8> from;
  View<uint32_t> home;
  View<PointQ8> to;
  ISOSHELL_HD void operator()(int64_t v) const {
    Vec64 sum = {0, 0, 0};
    const uint32_t start = mesh.outgoing[v];
    uint32_t h = start;
    do {
      sum = sum + difference(from[mesh.to(h)], from[v]);
      h = mesh.twin[previous_half_edge(h)];
    } while (h != start);
    const int64_t twice = 2 * int64_t(mesh.valence[v]);
    const PointQ8 target = {from[v].x + int32_t(round_div(sum.x, twice)), from[v].y + int32_t(round_div(sum.y, twice)),
                            from[v].z + int32_t(round_div(sum.z, twice))};
    home[v] = walk.nearest_vertex(home[v], target);
    to[v] = walk.closest_around(home[v], target);
  }
};

/// Marks the corners of triangles that a step turned by more than 45 degrees or made poor.
struct MarkHarmed {
  View<const TriangleIndices> triangles;
  View<const PointQ8> before, after;
  View<uint32_t> harmed;
  ISOSHELL_HD void operator()(int64_t t) const {
    const TriangleIndices i = triangles[t];
    const PointQ8 a = before[i.a], b = before[i.b], c = before[i.c], d = after[i.a], e = after[i.b], f = after[i.c];
    if (a == d && b == e && c == f) return;
    if (within_45_degrees(normal_of(a, b, c), normal_of(d, e, f)) && !harms_shape(shape_of(a, b, c), shape_of(d, e, f)))
      return;
    atomic_or(harmed[i.a], 1u);
    atomic_or(harmed[i.b], 1u);
    atomic_or(harmed[i.c], 1u);
  }
};
struct IsHarmed {
  View<const uint32_t> harmed;
  ISOSHELL_HD int64_t operator()(int64_t v) const { return harmed[v]; }
};
struct RestoreHarmed {
  View<const PointQ8> before;
  View<const uint32_t> home_before;
  View<uint32_t> harmed;
  View<PointQ8> after;
  View<uint32_t> home_after;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (!harmed[v]) return;
    after[v] = before[v];
    home_after[v] = home_before[v];
  }
};

struct TakeNormal {
  View<const Normal8> sheet_normal;
  View<const uint32_t> home;
  View<Normal8> normal;
  ISOSHELL_HD void operator()(int64_t v) const { normal[v] = sheet_normal[home[v]]; }
};

struct RotateTriangle {
  View<TriangleIndices> triangles;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    triangles[i] = t.a < t.b && t.a < t.c
                       ? t
                       : (t.b < t.c && t.b < t.a ? TriangleIndices{t.b, t.c, t.a} : TriangleIndices{t.c, t.a, t.b});
  }
};
struct ByIndices {
  ISOSHELL_HD bool operator()(const TriangleIndices& s, const TriangleIndices& t) const {
    return s.a != t.a ? s.a < t.a : (s.b != t.b ? s.b < t.b : s.c < t.c);
  }
};

/// Flips in independent sets until none is left or `rounds` are done. Returns how many were made.
template <class Exec>
int64_t flip_edges(Exec& exec, const FlipKey& key, View<uint64_t> claim, int rounds) {
  const int64_t half_edges = key.mesh.twin.size;
  int64_t flips = 0;
  for (int r = 0; r < rounds; ++r) {
    exec.fill(claim, uint64_t(0));
    exec.for_each("claim flips", half_edges, ClaimVertices{key, claim});
    const Buffer<uint32_t> winners = exec.select(half_edges, WinsItsVertices{key, claim});
    if (winners.empty()) break;
    exec.for_each("flip edges", winners.size(), Flip{key.mesh, winners.view()});
    flips += winners.size();
  }
  return flips;
}

/// Undoes the step where it would harm a triangle (ends: what is restored stays so); a restored vertex can harm
/// another, so up to a fixed point.
template <class Exec>
void undo_harm(Exec& exec, View<const TriangleIndices> triangles, const RestoreHarmed& restore) {
  const int64_t vertices = restore.harmed.size;
  for (;;) {
    exec.fill(restore.harmed, 0u);
    exec.for_each("mark harmed", triangles.size, MarkHarmed{triangles, restore.before, restore.after, restore.harmed});
    if (exec.sum(vertices, IsHarmed{restore.harmed}) == 0) return;
    exec.for_each("restore harmed", vertices, restore);
  }
}

/// The mesh and its scratch while it is improved.
template <class Exec>
class Improvement {
 public:
  Improvement(Exec& exec, const Sheet& sheet, SeedSet& seeds, DualMesh& mesh)
      : exec_(exec),
        seeds_(seeds),
        mesh_(mesh),
        vertices_(mesh.position.size()),
        half_edges_(3 * mesh.triangles.size()),
        walk_{sheet.position.view(), sheet.normal.view(), sheet.triangles.view(), sheet.vertex_first.view(),
              sheet.vertex_triangles.view()} {
    twin_ = exec.template make<uint32_t>(half_edges_);
    valence_ = exec.template make<uint32_t>(vertices_);
    outgoing_ = exec.template make<uint32_t>(vertices_);
    claim_ = exec.template make<uint64_t>(vertices_);
    moved_ = exec.template make<PointQ8>(vertices_);
    moved_home_ = exec.template make<uint32_t>(vertices_);
    harmed_ = exec.template make<uint32_t>(vertices_);
    connect();
  }

  /// Flips until none is left or `rounds` are done. Returns how many were made.
  int64_t flip(int rounds) { return flip_edges(exec_, FlipKey{view(), mesh_.position.view()}, claim_.view(), rounds); }

  void smooth(int steps) {
    for (int s = 0; s < steps; ++s) {
      exec_.copy(View<const uint32_t>(seeds_.home.view()), moved_home_.view());
      exec_.for_each("smooth", vertices_,
                     SmoothVertex{view(), walk_, mesh_.position.view(), moved_home_.view(), moved_.view()});
      undo_harm(
          exec_, mesh_.triangles.view(),
          RestoreHarmed{mesh_.position.view(), seeds_.home.view(), harmed_.view(), moved_.view(), moved_home_.view()});
      exec_.copy(View<const PointQ8>(moved_.view()), mesh_.position.view());
      exec_.copy(View<const uint32_t>(moved_home_.view()), seeds_.home.view());
    }
  }

  void finish() {
    exec_.for_each("rotate triangles", mesh_.triangles.size(), RotateTriangle{mesh_.triangles.view()});
    exec_.sort(mesh_.triangles.view(), ByIndices{});
    exec_.copy(View<const PointQ8>(mesh_.position.view()), seeds_.position.view());
    exec_.for_each("seed normals", vertices_, TakeNormal{walk_.normal, seeds_.home.view(), seeds_.normal.view()});
  }

 private:
  MeshView view() { return {mesh_.triangles.view(), twin_.view(), valence_.view(), outgoing_.view()}; }

  void connect() {
    Buffer<DirectedEdge> edges = exec_.template make<DirectedEdge>(half_edges_);
    exec_.for_each("list edges", half_edges_, ListEdge{mesh_.triangles.view(), edges.view()});
    exec_.sort(edges.view(), ByEnds{});
    exec_.for_each("pair twins", half_edges_ / 2, PairTwins{edges.view(), view()});
    exec_.fill(valence_.view(), 0u);
    exec_.fill(outgoing_.view(), kNone);
    exec_.for_each("count valences", half_edges_, CountValence{view()});
  }

  Exec& exec_;
  SeedSet& seeds_;
  DualMesh& mesh_;
  int64_t vertices_, half_edges_;
  WalkOntoSheet walk_;
  Buffer<uint32_t> twin_, valence_, outgoing_, moved_home_, harmed_;
  Buffer<uint64_t> claim_;
  Buffer<PointQ8> moved_;
};

}  // namespace post

template <class Exec>
int64_t improve_mesh_body(Exec& exec, const Sheet& sheet, const PostOptions& options, SeedSet& seeds, DualMesh& mesh) {
  post::Improvement<Exec> work(exec, sheet, seeds, mesh);
  int64_t flips = 0;
  for (int round = 0; round < options.rounds; ++round) {
    flips += work.flip(options.flip_rounds);
    work.smooth(options.smoothing_steps);
  }
  work.finish();
  return flips;
}

}  // namespace isoshell
