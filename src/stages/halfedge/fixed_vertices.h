// Vertices of a mesh with borders that are fixed: how many triangles they want, and which edges they may not get.
#pragma once

#include "stages/halfedge/half_edges.h"
#include "stages/halfedge/triangle_shape.h"

namespace isoshell::optimize {

/// What steps see of the fixed vertices, which come first: all those on borders.
struct FixedView {
  View<const uint32_t> joined;   ///< see FixedSeeds
  View<const uint32_t> valence;  ///< that each is to have, by the angle of its patch

  ISOSHELL_HD bool is_fixed(uint32_t v) const { return v < joined.size; }
  /// Edges around a vertex whose triangles are equilateral.
  ISOSHELL_HD int32_t even_valence(uint32_t v) const { return is_fixed(v) ? int32_t(valence[v]) : 6; }

  /// Whether a new edge would be the only one between its ends once copies are joined. None is made between two fixed
  /// vertices: another patch may have it too.
  ISOSHELL_HD bool may_join(const MeshView& mesh, uint32_t u, uint32_t v) const {
    if (!is_fixed(u) && !is_fixed(v)) return true;
    if (is_fixed(u) && is_fixed(v)) return false;
    return is_fixed(u) ? !has_copy_around(mesh, v, u) : !has_copy_around(mesh, u, v);
  }
  /// The same for the edges from a to the neighbours of b, whose end a is to be.
  ISOSHELL_HD bool may_merge(const MeshView& mesh, uint32_t a, uint32_t b) const {
    if (joined.size == 0) return true;
    bool may = true;
    for_each_neighbour(mesh, b, [&](uint32_t v) {
      if (v == a || (!is_fixed(v) && !is_fixed(a)) || mesh.are_neighbours(v, a)) return;
      may = may && may_join(mesh, a, v);
    });
    return may;
  }

 private:
  /// Whether v has as a neighbour another copy of a fixed vertex.
  ISOSHELL_HD bool has_copy_around(const MeshView& mesh, uint32_t v, uint32_t fixed) const {
    bool any = false;
    for_each_neighbour(mesh, v,
                       [&](uint32_t u) { any = any || (u != fixed && is_fixed(u) && joined[u] == joined[fixed]); });
    return any;
  }
};

/// The angle between two vectors over 60 degrees, to a few millionths: sums of such are to be rounded.
ISOSHELL_HD inline double angle_over_60(Vector p, Vector q) {
  const Vector n = cross(p, q);
  const double sine = rounded_sqrt(dot(n, n)), cosine = dot(p, q);
  if (!(sine > 0)) return cosine < 0 ? 3 : 0;
  // The tangent of half the angle, or of what half the angle lacks of 90 degrees, whichever is below 1.
  const double beside = rounded_sqrt(dot(p, p)) * rounded_sqrt(dot(q, q)) + cosine;
  const bool is_sharp = sine < beside;
  const double t = is_sharp ? sine / beside : beside / sine, s = t * t;
  const double arctangent =
      t * (0.99997726 + s * (-0.33262347 + s * (0.19354346 + s * (-0.11643287 + s * (0.05265332 - s * 0.01172120)))));
  const double part = 6 / 3.141592653589793 * arctangent;
  return is_sharp ? part : 3 - part;
}

/// One edge more than equilateral triangles fit into the angle of the patch at a fixed vertex, at least one. Half a
/// triangle counts as one, and so does what is less by little: right angles have two.
struct MeasureEvenValence {
  MeshView mesh;
  View<const PointQ8> position;
  View<uint32_t> valence;
  ISOSHELL_HD void operator()(int64_t v) const {
    constexpr double kLittle = 0.01;
    double angle = 0;
    for_each_triangle_around(mesh, uint32_t(v), [&](uint32_t b, uint32_t c) {
      angle += angle_over_60(from_to(position[v], position[b]), from_to(position[v], position[c]));
    });
    const auto triangles = uint32_t(angle + 0.5 + kLittle);
    valence[v] = triangles > 1 ? triangles + 1 : 2;
  }
};

/// Of all fixed vertices of a mesh as it comes in.
template <class Exec>
Buffer<uint32_t> even_valences(Exec& exec, const FixedSeeds& fixed, const MeshView& mesh,
                               View<const PointQ8> position) {
  Buffer<uint32_t> valence = exec.template make<uint32_t>(fixed.count);
  exec.for_each("measure angles", fixed.count, MeasureEvenValence{mesh, position, valence.view()});
  return valence;
}

}  // namespace isoshell::optimize
