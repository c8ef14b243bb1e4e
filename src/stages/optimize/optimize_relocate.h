// Vertices taken from where the mesh is flat to where the surface is farthest from it: pits and tips in the middle of a
// triangle, where no step brings a vertex. For each an edge is collapsed and its vertex put into that triangle, so the
// number of vertices stays.
#pragma once

#include "stages/halfedge/collapse_cost.h"
#include "stages/optimize/optimize_flips.h"
#include "stages/optimize/optimize_samples.h"
#include "stages/optimize/optimize_size.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell::optimize {

constexpr double kFarPlace = 0.3;         ///< edges from the mesh; nearer places get no vertex
constexpr double kVeryFarPlace = 0.35;    ///< the same in a second round, for what the first did not reach
constexpr double kFlatPlace = 0.1;        ///< edges; a place whose samples are all as near loses one
constexpr double kFlatNormal = 0.98;      ///< least length of the mean of the unit normals there
constexpr double kStarQuality = 0.7;      ///< least of a star's triangles: the fit and search that follow repair them
constexpr double kStarOf4Quality = 0.9;   ///< of a star of four, which only slopes keep from being poor
constexpr double kStarOf3Quality = 0.95;  ///< and of one of three
constexpr double kStarSlope = 0.1;        ///< least cosine between a star's triangles and the two at the old edge
constexpr int kStarPlaces = 3;            ///< tried: at the sample, and a fifth of its distance nearer each
constexpr uint32_t kLeastValence = 5, kMostValence = 8;  ///< of vertices whose edges are flipped for a star
constexpr int64_t kVerticesPerMove = 100;

/// What is farthest from every triangle.
struct FarSamples {
  View<uint32_t> distance_q8;
  View<uint64_t> offset;  ///< from the triangle's first corner, see FindFarthest; 0 where nothing is far
};
struct FindDistances {
  View<const FitSample> sample;
  View<const int64_t> rest_sq;
  FarSamples far;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t t = sample[i].triangle;
    if (t != kNone) atomic_max(far.distance_q8[t], uint32_t(isqrt(uint64_t(rest_sq[i]))));
  }
};
/// Of samples as far as each other the one of the largest offset: samples have no order.
struct FindFarthest {
  static constexpr int32_t kHalf = 1 << 20;  ///< offsets are 21 bits an axis
  MeshView mesh;
  View<const PointQ8> position;
  View<const FitSample> sample;
  View<const int64_t> rest_sq;
  double least_q8;
  FarSamples far;

  ISOSHELL_HD void operator()(int64_t i) const {
    const FitSample s = sample[i];
    if (s.triangle == kNone) return;
    const uint32_t distance = uint32_t(isqrt(uint64_t(rest_sq[i])));
    if (distance != far.distance_q8[s.triangle] || !(double(distance) > least_q8)) return;
    const PointQ8 a = position[mesh.triangles[s.triangle].a], q = s.position;
    if (fits(q.x - a.x) && fits(q.y - a.y) && fits(q.z - a.z))
      atomic_max(far.offset[s.triangle], packed(q.x - a.x) << 42 | packed(q.y - a.y) << 21 | packed(q.z - a.z));
  }
  ISOSHELL_HD static PointQ8 place(PointQ8 a, uint64_t offset) {
    return {a.x + unpacked(offset >> 42), a.y + unpacked(offset >> 21), a.z + unpacked(offset)};
  }

 private:
  ISOSHELL_HD static bool fits(int32_t x) { return x > -kHalf && x < kHalf; }
  ISOSHELL_HD static uint64_t packed(int32_t x) { return uint64_t(x + kHalf); }
  ISOSHELL_HD static int32_t unpacked(uint64_t x) { return int32_t(x & (2 * kHalf - 1)) - kHalf; }
};

/// A vertex put into a triangle: the three triangles around it, and one more for every edge of the old one that is
/// flipped to it.
struct Star {
  PointQ8 place{};
  uint32_t flipped = 0;  ///< bit k: the half-edge of corner k
  double quality = 0;    ///< least of its triangles; 0: no star would do
};

/// Triangles that a vertex should be put into, each with a key: larger distance first, then the smaller triangle.
struct FarPlace {
  MeshView mesh;
  View<const PointQ8> position;
  View<const uint32_t> home;
  EdgeSize size;
  FarSamples far;
  double least_edges;  ///< kFarPlace or more

  /// By triangle; 0 where nothing is far, where a vertex would harm the mesh, and on borders.
  ISOSHELL_HD uint64_t operator()(uint32_t t) const {
    const uint32_t distance = far.distance_q8[t];
    if (mesh.is_border(3 * t) || mesh.is_border(3 * t + 1) || mesh.is_border(3 * t + 2)) return 0;
    if (far.offset[t] == 0 || !(double(distance) > least_edges * size.at(home[mesh.triangles[t].a]))) return 0;
    return best_star(t).quality > 0 ? uint64_t(distance) << 32 | (0xffffffffu - t) : 0;
  }
  /// One of those below.
  ISOSHELL_HD uint32_t a_vertex(uint32_t t) const { return mesh.from(3 * t); }
  /// The corners, and those opposite of the edges.
  template <class Visit>
  ISOSHELL_HD void for_each_vertex(uint32_t t, Visit visit) const {
    for (uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
      visit(mesh.from(h));
      visit(mesh.opposite(mesh.twin[h]));
    }
  }
  /// The best one at the first place where any is good enough.
  ISOSHELL_HD Star best_star(uint32_t t) const {
    const TriangleIndices i = mesh.triangles[t];
    const PointQ8 farthest = FindFarthest::place(position[i.a], far.offset[t]);
    const Vector rest = foot_on_triangle(farthest, position[i.a], position[i.b], position[i.c]).rest;
    Star best;
    for (int nearer = 0; nearer < kStarPlaces && !(best.quality > 0); ++nearer) {
      const PointQ8 place = moved_by(farthest, -0.2 * double(nearer) * rest);
      for (uint32_t flipped = 0; flipped < 8; ++flipped) {
        const double quality = quality_of_star(t, place, flipped);
        if (quality > best.quality) best = {place, flipped, quality};
      }
    }
    return best;
  }

 private:
  /// 0 where that is too little, a triangle turns over, or valences become too uneven.
  ISOSHELL_HD double quality_of_star(uint32_t t, PointQ8 place, uint32_t flipped) const {
    const TriangleIndices i = mesh.triangles[t];
    const Vector up = unit(normal_of(position[i.a], position[i.b], position[i.c]));
    double least = 2;
    const auto add = [&](uint32_t a, uint32_t b, Vector facing) {
      const double quality = quality_of(position[a], position[b], place);
      if (quality < least) least = quality;
      if (!(dot(facing, unit(normal_of(position[a], position[b], place))) > kStarSlope)) least = 0;
    };
    uint32_t flips = 0;
    for (uint32_t k = 0; k < 3; ++k) {
      const uint32_t h = 3 * t + k, a = mesh.from(h), b = mesh.to(h), d = mesh.opposite(mesh.twin[h]);
      // A star beyond an edge leans over to the triangle there.
      const Vector facing = unit(up + unit(normal_of(position[b], position[a], position[d])));
      if ((flipped >> k & 1) == 0) {
        add(a, b, facing);
        continue;
      }
      ++flips;
      add(a, d, facing);
      add(d, b, facing);
      // The corner gains an edge, and loses one to each flip beside it.
      const uint32_t before = flipped >> ((k + 2) % 3) & 1, after = flipped >> ((k + 1) % 3) & 1;
      if (mesh.valence[a] < kLeastValence + before || mesh.valence[b] < kLeastValence + after) return 0;
      if (mesh.valence[d] >= kMostValence) return 0;
    }
    const double needed = flips == 0 ? kStarOf3Quality : (flips == 1 ? kStarOf4Quality : kStarQuality);
    return least >= needed ? least : 0;
  }
};

/// Edges that may be collapsed, each with a key: smaller cost first, then the smaller half-edge.
struct SpareEdge {
  collapse::CollapseCost cost;
  View<const uint32_t> distance_q8;  ///< of the farthest sample, by triangle
  EdgeSize size;

  /// By half-edge; 0 where the mesh or the surface would suffer, and at fixed vertices.
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    if (cost.fixed.is_fixed(cost.mesh.from(h))) return 0;
    const int64_t c = cost(h), most = 0xfffffffe;  // longer edges are as good as each other
    if (c <= 0 || c == collapse::CollapseCost::kNever) return 0;
    if (!is_flat(cost.mesh.from(h)) || !is_flat(cost.mesh.to(h))) return 0;
    return (0xffffffffu - uint64_t(c < most ? c : most)) << 32 | (0xffffffffu - h);
  }
  /// One of those below.
  ISOSHELL_HD uint32_t a_vertex(uint32_t h) const { return cost.mesh.to(h); }
  /// The neighbours of both ends, which are neighbours.
  template <class Visit>
  ISOSHELL_HD void for_each_vertex(uint32_t h, Visit visit) const {
    for_each_neighbour(cost.mesh, cost.mesh.from(h), visit);
    for_each_neighbour(cost.mesh, cost.mesh.to(h), visit);
  }

 private:
  ISOSHELL_HD bool is_flat(uint32_t v) const {
    const MeshView& mesh = cost.mesh;
    const double most_q8 = kFlatPlace * size.at(cost.home[v]);
    Vector sum = {0, 0, 0};
    const bool any_far = mesh.any_from(mesh.outgoing[v], [&](uint32_t h) {
      sum = sum + unit(normal_of(cost.position[v], cost.position[mesh.to(h)], cost.position[mesh.opposite(h)]));
      return double(distance_q8[h / 3]) > most_q8;
    });
    if (any_far) return false;
    const double least = kFlatNormal * double(mesh.valence[v]);
    return dot(sum, sum) > least * least;
  }
};

/// The triangle or half-edge of a key.
ISOSHELL_HD inline uint32_t number_of(uint64_t key) { return 0xffffffffu - uint32_t(key); }

template <class Places>
struct ClaimPlaces {
  Places places;
  View<uint64_t> claim;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint64_t key = places(uint32_t(i));
    if (key != 0) places.for_each_vertex(uint32_t(i), [&](uint32_t v) { atomic_max(claim[v], key); });
  }
};
template <class Places>
struct HoldsItsVertices {
  Places places;
  View<const uint64_t> claim;
  ISOSHELL_HD bool operator()(int64_t i) const {
    // Few are claimed by it at all; the others need no key.
    if (number_of(claim[places.a_vertex(uint32_t(i))]) != uint32_t(i)) return false;
    const uint64_t key = places(uint32_t(i));
    bool holds = key != 0;
    if (holds) places.for_each_vertex(uint32_t(i), [&](uint32_t v) { holds = holds && claim[v] == key; });
    return holds;
  }
};
template <class Places>
struct CopyKey {
  Places places;
  View<const uint32_t> chosen;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const { key[i] = places(chosen[i]); }
};
struct LargestFirst {
  ISOSHELL_HD bool operator()(uint64_t a, uint64_t b) const { return a > b; }
};
/// Keys of places without a vertex in common, the largest first. What `claim` holds already is respected.
template <class Exec, class Places>
Buffer<uint64_t> choose_apart(Exec& exec, const Places& places, int64_t count, View<uint64_t> claim) {
  exec.for_each("claim places", count, ClaimPlaces<Places>{places, claim});
  const Buffer<uint32_t> chosen = exec.select(count, HoldsItsVertices<Places>{places, claim});
  Buffer<uint64_t> keys = exec.template make<uint64_t>(chosen.size());
  exec.for_each("copy keys", keys.size(), CopyKey<Places>{places, chosen.view(), keys.view()});
  exec.sort(keys.view(), LargestFirst{});
  return keys;
}

/// So that no edge is collapsed there.
struct BlockPlaces {
  FarPlace places;
  View<const uint64_t> far;
  View<uint64_t> claim;
  ISOSHELL_HD void operator()(int64_t i) const {
    places.for_each_vertex(number_of(far[i]), [&](uint32_t v) { atomic_max(claim[v], ~uint64_t(0)); });
  }
};

/// Collapses the i-th spare edge and puts its vertex into the i-th far triangle.
struct RelocateVertex {
  FarPlace places;
  WalkOntoSheet walk;
  View<const uint64_t> far, spare;
  View<PointQ8> position, on_sheet, begin;
  View<uint32_t> home;
  View<uint32_t> heir;  ///< by triangle: where the samples of one that is taken away go; kNone for others

  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t t = number_of(far[i]), h = number_of(spare[i]), g = places.mesh.twin[h];
    const uint32_t from = places.mesh.from(h), v = places.mesh.to(h);
    const Star star = places.best_star(t);
    collapse(h);
    put(from, home[from], collapse::CollapseCost::middle_of(position[from], position[v]));
    put(v, home_in(t, star.place), star.place);
    split(t, v, h / 3, g / 3);
    const uint32_t edges[3] = {3 * t, h / 3 * 3, g / 3 * 3};
    for (int k = 0; k < 3; ++k)
      if (star.flipped >> k & 1) flip_edge(places.mesh, edges[k]);
  }

 private:
  ISOSHELL_HD void put(uint32_t v, uint32_t near, PointQ8 p) const {
    position[v] = p;
    home[v] = walk.nearest_vertex(near, p);
    on_sheet[v] = begin[v] = walk.closest_around(home[v], p);
  }
  /// The nearest sheet vertex that walks from the corners' find.
  ISOSHELL_HD uint32_t home_in(uint32_t t, PointQ8 p) const {
    const TriangleIndices i = places.mesh.triangles[t];
    uint32_t best = walk.nearest_vertex(home[i.a], p);
    for (int k = 1; k < 3; ++k) {
      const uint32_t near = walk.nearest_vertex(home[corner(i, k)], p);
      const int64_t d = distance_sq_q16(walk.position[near], p), least = distance_sq_q16(walk.position[best], p);
      if (d < least || (d == least && near < best)) best = near;
    }
    return best;
  }
  /// The end of a half-edge becomes its start; the triangles beside it are free then.
  ISOSHELL_HD void collapse(uint32_t h) const {
    const MeshView& mesh = places.mesh;
    const uint32_t g = mesh.twin[h], a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    const uint32_t bc = mesh.twin[next_half_edge(h)], ca = mesh.twin[previous_half_edge(h)];
    const uint32_t ad = mesh.twin[next_half_edge(g)], db = mesh.twin[previous_half_edge(g)];
    mesh.any_from(g, [&](uint32_t k) {
      TriangleIndices& t = mesh.triangles[k / 3];
      (k % 3 == 0 ? t.a : (k % 3 == 1 ? t.b : t.c)) = a;
      return false;
    });
    mesh.join(bc, ca);
    mesh.join(ad, db);
    heir[h / 3] = ca / 3;
    heir[g / 3] = ad / 3;
    mesh.outgoing[a] = ca;
    mesh.begin_turn(c, bc, mesh.is_on_border(c));
    mesh.begin_turn(d, ad, mesh.is_on_border(d));
    mesh.valence[a] += mesh.valence[b] - 4;
    --mesh.valence[c];
    --mesh.valence[d];
  }
  /// (a, b, c) becomes (a, b, v) and, in the free triangles s and u, (b, c, v) and (c, a, v).
  ISOSHELL_HD void split(uint32_t t, uint32_t v, uint32_t s, uint32_t u) const {
    const MeshView& mesh = places.mesh;
    const TriangleIndices i = mesh.triangles[t];
    const uint32_t bc = mesh.twin[3 * t + 1], ca = mesh.twin[3 * t + 2];
    const bool a_border = mesh.is_on_border(i.a), b_border = mesh.is_on_border(i.b), c_border = mesh.is_on_border(i.c);
    mesh.triangles[t] = {i.a, i.b, v};
    mesh.triangles[s] = {i.b, i.c, v};
    mesh.triangles[u] = {i.c, i.a, v};
    mesh.join(3 * s, bc);
    mesh.join(3 * u, ca);
    mesh.join(3 * t + 1, 3 * s + 2);
    mesh.join(3 * s + 1, 3 * u + 2);
    mesh.join(3 * u + 1, 3 * t + 2);
    mesh.begin_turn(i.a, 3 * t, a_border);
    mesh.begin_turn(i.b, 3 * s, b_border);
    mesh.begin_turn(i.c, 3 * u, c_border);
    mesh.outgoing[v] = 3 * t + 2;
    mesh.valence[v] = 3;
    ++mesh.valence[i.a];
    ++mesh.valence[i.b];
    ++mesh.valence[i.c];
  }
};
struct InheritSamples {
  View<const uint32_t> heir;
  View<FitSample> sample;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t t = sample[i].triangle;
    if (t != kNone && heir[t] != kNone) sample[i].triangle = heir[t];
  }
};

}  // namespace isoshell::optimize
