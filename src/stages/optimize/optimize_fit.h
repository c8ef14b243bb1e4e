// The fit: vertices move to where the mesh straddles the surface instead of being inscribed in it, against the shape of
// the triangles. The sums of the samples are lumped to the vertices: a Jacobi step each, with the fixed point of the
// least squares of all samples.
#pragma once

#include "stages/halfedge/planes.h"
#include "stages/optimize/optimize_samples.h"
#include "stages/optimize/optimize_smooth.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell::optimize {

struct FitOptions {
  SmoothOptions smooth;  ///< its momentum too
  double stiffness = 0;  ///< weight of the shape, in samples where edges are shortest: an area has as many everywhere
  double damping = 1;    ///< part of the move that is made
  double rms_q8 = 0;     ///< of the samples' residuals
};

/// What the triangles around a vertex ask of it in the fit, summed in their order.
struct FitSums {
  Vector corners = {0, 0, 0};  ///< ways to the corners of the equilateral triangles
  Vector normal = {0, 0, 0};
  Symmetric planes;  ///< sum of w d d^T, the normals times what samples weigh
  Vector pull = {0, 0, 0};
};

/// The place between what the samples and the shapes of the triangles ask for.
struct FitVertex {
  using Sums = FitSums;

  MeshView mesh;
  WalkOntoSheet walk;
  FitOptions options;
  View<const PointQ8> from, previous;
  View<const TrianglePull> triangle_pull;
  View<const VertexPull> vertex_pull;
  View<uint32_t> home;
  View<PointQ8> to;

  ISOSHELL_HD void operator()(int64_t v) const {
    const PointQ8 p = from[v];
    if (is_locked(v)) {
      to[v] = p;
      return;
    }
    const double radius = radius_q8(v);
    FitSums sums;
    for_each_half_edge_around(mesh, uint32_t(v),
                              [&](uint32_t h) { add(h, p, from[mesh.to(h)], from[mesh.opposite(h)], radius, sums); });
    finish(v, sums);
  }

  // The parts of a step.

  ISOSHELL_HD void finish(int64_t v, const FitSums& sums) const { to[v] = place(v, sums); }

  ISOSHELL_HD bool is_locked(int64_t v) const { return v < options.smooth.locked; }
  /// Of the triangle that is to be around the vertex.
  ISOSHELL_HD double radius_q8(int64_t v) const { return options.smooth.size.at(home[v]) * kRadiusOfEdge; }
  /// What the triangle (p, b, c), whose half-edge from p is h, asks of p.
  ISOSHELL_HD void add(uint32_t h, PointQ8 p, PointQ8 b, PointQ8 c, double radius, FitSums& sums) const {
    sums.corners = sums.corners + to_equilateral_corner(p, b, c, options.smooth.evenness, radius);
    const Vector n = normal_of(p, b, c), d = unit(n);
    sums.normal = sums.normal + n;
    const TrianglePull& asked = triangle_pull[h / 3];
    sums.planes.add(double(asked.weight[h % 3]), d);
    sums.pull = sums.pull + double(asked.pull[h % 3]) * d;
  }
  /// Where the vertex goes; its home follows where it is held back.
  ISOSHELL_HD PointQ8 place(int64_t v, const FitSums& sums) const {
    const PointQ8 p = from[v];
    const double size = options.smooth.size.ratio(home[v]), edge_q8 = options.smooth.size.at(home[v]);
    Symmetric a = sums.planes;
    Vector pull = sums.pull;
    add_samples_beyond(vertex_pull[v], a, pull);
    add_anchor(v, p, a, pull);
    const Vector normal = unit(sums.normal);
    Vector shape = 1 / double(mesh.valence[v]) * sums.corners;
    shape = shape - dot(shape, normal) * normal;
    const double stiffness = options.stiffness * (size * size) * kPullScale;
    a.xx += stiffness, a.yy += stiffness, a.zz += stiffness;
    const Vector move =
        options.damping * a.solve(pull + stiffness * shape) + options.smooth.momentum * from_to(previous[v], p);
    return moved_by(p, at_most(move, options.smooth.most_edges * edge_q8));
  }

 private:
  ISOSHELL_HD static void add_samples_beyond(const VertexPull& asked, Symmetric& a, Vector& pull) {
    a.xx += double(asked.weight[0]), a.xy += double(asked.weight[1]), a.xz += double(asked.weight[2]);
    a.yy += double(asked.weight[3]), a.yz += double(asked.weight[4]), a.zz += double(asked.weight[5]);
    pull = pull + Vector{double(asked.pull[0]), double(asked.pull[1]), double(asked.pull[2])};
  }
  /// The planes around a tip meet beyond it: a vertex far off the surface is held back.
  ISOSHELL_HD void add_anchor(int64_t v, PointQ8 p, Symmetric& a, Vector& pull) const {
    const double far_sq = 9 * options.rms_q8 * options.rms_q8;
    if (!(far_sq > 0) || double(distance_sq_q16(p, walk.position[home[v]])) <= far_sq) return;
    home[v] = walk.nearest_vertex(home[v], p);
    const Vector off = from_to(p, walk.closest_around(home[v], p));
    const double off_sq = dot(off, off);
    if (off_sq <= far_sq) return;
    const double part = off_sq / far_sq, w = 4 * kPullScale * (part < kLargestWeight ? part : kLargestWeight);
    a.add(w / off_sq, off);
    pull = pull + w * off;
  }
};

}  // namespace isoshell::optimize
