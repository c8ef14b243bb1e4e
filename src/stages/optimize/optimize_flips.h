// Flips of a mesh's edges, in independent sets, and those that make valences more even.
#pragma once

#include "stages/halfedge/fixed_vertices.h"
#include "stages/halfedge/triangle_shape.h"

namespace isoshell::optimize {

/// Flips that would make valences more even, each with a key: larger gain first, then the smaller half-edge.
struct FlipKey {
  MeshView mesh;
  View<const PointQ8> position;
  double least_quality;  ///< triangles below this may not get worse
  FixedView fixed;

  /// By half-edge. 0 when the flip gains nothing or would harm the mesh.
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    const uint32_t g = mesh.twin[h];
    if (g < h || mesh.is_border(h)) return 0;
    const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    const int32_t ea = excess(a), eb = excess(b), ec = excess(c), ed = excess(d);
    // The valences of a and b fall by one, the others rise: the sum of the squares falls by twice this.
    const int32_t gain = 2 * (ea + eb - ec - ed - 2);
    if (gain <= 0 || ea <= -2 || eb <= -2 || mesh.are_neighbours(c, d) || !fixed.may_join(mesh, c, d)) return 0;
    return keeps_shape(position[a], position[b], position[c], position[d]) ? uint64_t(gain) << 32 | (0xffffffffu - h)
                                                                           : 0;
  }

 private:
  ISOSHELL_HD int32_t excess(uint32_t v) const { return int32_t(mesh.valence[v]) - fixed.even_valence(v); }
  /// Whether (a, d, c) and (d, b, c) may replace (a, b, c) and (b, a, d).
  ISOSHELL_HD bool keeps_shape(PointQ8 a, PointQ8 b, PointQ8 c, PointQ8 d) const {
    const Vector before = normal_of(a, b, c) + normal_of(b, a, d);
    if (!within_45_degrees(before, normal_of(a, d, c)) || !within_45_degrees(before, normal_of(d, b, c))) return false;
    const double flipped = smaller(quality_of(a, d, c), quality_of(d, b, c));
    return flipped >= least_quality || flipped >= smaller(quality_of(a, b, c), quality_of(b, a, d));
  }
  ISOSHELL_HD static double smaller(double a, double b) { return a < b ? a : b; }
};
/// Another key's flips but those that have a blocked vertex.
template <class Key>
struct UnblockedFlip {
  UnblockedFlip(const Key& of, View<const uint32_t> blocked_vertices)
      : mesh(of.mesh), key(of), blocked(blocked_vertices) {}
  MeshView mesh;
  Key key;
  View<const uint32_t> blocked;
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    const uint32_t g = mesh.twin[h];
    if (mesh.is_border(h)) return 0;
    if (blocked[mesh.from(h)] || blocked[mesh.to(h)] || blocked[mesh.opposite(h)] || blocked[mesh.opposite(g)])
      return 0;
    return key(h);
  }
};

template <class Key>
struct ClaimVertices {
  Key key;
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
template <class Key>
ClaimVertices(Key, View<uint64_t>) -> ClaimVertices<Key>;
/// A flip goes ahead when it holds the claim of all its four vertices.
template <class Key>
struct WinsItsVertices {
  Key key;
  View<const uint64_t> claim;
  ISOSHELL_HD bool operator()(int64_t i) const {
    const uint32_t h = uint32_t(i);
    const MeshView& m = key.mesh;
    if (0xffffffffu - uint32_t(claim[m.from(h)]) != h) return false;
    const uint64_t k = claim[m.from(h)];
    return k != 0 && claim[m.to(h)] == k && claim[m.opposite(h)] == k && claim[m.opposite(m.twin[h])] == k;
  }
};
template <class Key>
WinsItsVertices(Key, View<uint64_t>) -> WinsItsVertices<Key>;
/// (a, b, c) and (b, a, d) become (a, d, c) and (d, b, c).
ISOSHELL_HD inline void flip_edge(const MeshView& mesh, uint32_t h) {
  const uint32_t g = mesh.twin[h];
  const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
  const uint32_t bc = mesh.twin[next_half_edge(h)], ca = mesh.twin[previous_half_edge(h)];
  const uint32_t ad = mesh.twin[next_half_edge(g)], db = mesh.twin[previous_half_edge(g)];
  const uint32_t s = h / 3 * 3, t = g / 3 * 3;
  const bool a_border = mesh.is_on_border(a), b_border = mesh.is_on_border(b), c_border = mesh.is_on_border(c),
             d_border = mesh.is_on_border(d);
  mesh.triangles[h / 3] = {a, d, c};
  mesh.triangles[g / 3] = {d, b, c};
  mesh.join(s, ad);
  mesh.join(s + 1, t + 2);
  mesh.join(s + 2, ca);
  mesh.join(t, db);
  mesh.join(t + 1, bc);
  mesh.begin_turn(a, s, a_border);
  mesh.begin_turn(d, d_border ? t : s + 1, d_border);
  mesh.begin_turn(c, s + 2, c_border);
  mesh.begin_turn(b, t + 1, b_border);
  --mesh.valence[a];
  --mesh.valence[b];
  ++mesh.valence[c];
  ++mesh.valence[d];
}
struct Flip {
  MeshView mesh;
  View<const uint32_t> winners;
  ISOSHELL_HD void operator()(int64_t i) const { flip_edge(mesh, winners[i]); }
};

/// Flips in independent sets until none is left or `rounds` are done: of flips that share a vertex, the one with the
/// largest key. Returns how many were made.
struct PlainFlipEdges {
  template <class Exec, class Key>
  static int64_t run(Exec& exec, const Key& key, View<uint64_t> claim, int rounds) {
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
};

}  // namespace isoshell::optimize
