// Which edge of a mesh to collapse: short ones, rather those whose loss makes valences more even.
#pragma once

#include "stages/halfedge/fixed_vertices.h"
#include "stages/halfedge/triangle_shape.h"
#include "stages/labels/edge_lengths.h"

namespace isoshell::collapse {

/// What it costs to make one vertex of the two ends of an edge: in its middle, or at the end that is fixed. An edge
/// whose ends are both fixed stays.
struct CollapseCost {
  static constexpr int64_t kNever = INT64_MAX;
  optimize::MeshView mesh;
  View<const PointQ8> position;
  View<const uint32_t> home;
  EdgeLengthsView lengths;
  optimize::FixedView fixed;

  /// The square of the edge, beside the lengths there, more where valences get less even. kNever when the mesh would be
  /// no manifold any more or turn over.
  ISOSHELL_HD int64_t operator()(uint32_t h) const {
    const uint32_t a = mesh.from(h), b = mesh.to(h);
    if (a > b || fixed.is_fixed(b)) return kNever;  // fixed vertices come first
    const uint32_t c = mesh.opposite(h), d = mesh.opposite(mesh.twin[h]);
    const uint32_t va = mesh.valence[a], vb = mesh.valence[b], vc = mesh.valence[c], vd = mesh.valence[d];
    if (va + vb - 4 < least_valence(a) || vc - 1 < least_valence(c) || vd - 1 < least_valence(d)) return kNever;
    if (!share_two_neighbours(a, b) || !fixed.may_merge(mesh, a, b)) return kNever;
    const PointQ8 place = merged_position(a, b);
    if (turns_over(a, b, place) || turns_over(b, a, place)) return kNever;
    const int32_t unevenness = excess_sq(a, va + vb - 4) + excess_sq(c, vc - 1) + excess_sq(d, vd - 1) -
                               excess_sq(a, va) - excess_sq(b, vb) - excess_sq(c, vc) - excess_sq(d, vd);
    const int64_t length_sq = distance_sq_q16(position[a], position[b]);
    return lengths.share_of_seeds(length_sq, {home[a], home[a], home[b]}) * (unevenness > -8 ? 8 + unevenness : 1);
  }

  ISOSHELL_HD static PointQ8 middle_of(PointQ8 p, PointQ8 q) {
    return {(p.x + q.x) >> 1, (p.y + q.y) >> 1, (p.z + q.z) >> 1};
  }

 private:
  ISOSHELL_HD PointQ8 merged_position(uint32_t a, uint32_t b) const {
    return fixed.is_fixed(a) ? position[a] : middle_of(position[a], position[b]);
  }
  ISOSHELL_HD uint32_t least_valence(uint32_t v) const { return fixed.is_fixed(v) ? 2 : 3; }
  ISOSHELL_HD int32_t excess_sq(uint32_t v, uint32_t valence) const {
    const int32_t excess = int32_t(valence) - fixed.even_valence(v);
    return excess * excess;
  }

  /// A third one would be joined to the merged vertex by two edges.
  ISOSHELL_HD bool share_two_neighbours(uint32_t a, uint32_t b) const {
    int shared = 0;
    optimize::for_each_neighbour(mesh, a, [&](uint32_t v) { shared += mesh.are_neighbours(v, b); });
    return shared == 2;
  }

  /// Whether a triangle around `v` that stays turns by more than 60 degrees when `v` moves.
  ISOSHELL_HD bool turns_over(uint32_t v, uint32_t other, PointQ8 to) const {
    bool any = false;
    optimize::for_each_triangle_around(mesh, v, [&](uint32_t p, uint32_t q) {
      if (p == other || q == other) return;
      const optimize::Vector before = optimize::normal_of(position[v], position[p], position[q]),
                             after = optimize::normal_of(to, position[p], position[q]);
      const double d = dot(before, after);
      any = any || !(d > 0 && 4 * d * d > dot(before, before) * dot(after, after));
    });
    return any;
  }
};

}  // namespace isoshell::collapse
