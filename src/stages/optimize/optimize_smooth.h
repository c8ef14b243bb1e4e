// Shape matching: every triangle asks for its best-fitting equilateral one, every vertex goes to the mean of what its
// triangles ask for, along the surface.
#pragma once

#include "stages/halfedge/half_edges.h"
#include "stages/halfedge/planes.h"
#include "stages/halfedge/triangle_shape.h"
#include "stages/optimize/optimize_size.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell::optimize {

constexpr double kRadiusOfEdge = 0.5773502691896258;  ///< circumradius of the equilateral triangle of edge 1

struct SmoothOptions {
  double momentum = 0;    ///< part of the last move that is added
  double evenness = 0.1;  ///< weight of the mean size against the triangle's own, 0 to 1
  EdgeSize size;
  double most_edges = 0;   ///< longest move, in edges
  double hold = 0;         ///< how much moves are held to the planes of the triangles
  int64_t locked = 0;      ///< the first vertices, so many, stay where they are
  bool onto_sheet = true;  ///< back onto the sheet, or only along the mesh
};

/// From p, the corner of the equilateral triangle that fits (p, b, c) best, by least squares over the corners: around
/// the same centre, in the same plane, its radius mixed with `radius_q8`.
ISOSHELL_HD inline Vector to_equilateral_corner(PointQ8 p, PointQ8 b, PointQ8 c, double evenness, double radius_q8) {
  const Vector pb = from_to(p, b), pc = from_to(p, c);
  const Vector middle = 0.5 * (pb + pc);
  // The rotation by 90 degrees of the opposite edge, in the plane, pointing to p.
  const Vector across = cross(unit(cross(pb, pc)), pc - pb);
  const Vector arm = (1.0 / 3) * (0.8660254037844386 * across - middle);
  const double length_sq = dot(arm, arm);
  if (!(length_sq > 0)) return (2.0 / 3) * middle;
  const double scale = evenness > 0 ? (1 - evenness) + evenness * radius_q8 / rounded_sqrt(length_sq) : 1;
  return (2.0 / 3) * middle + scale * arm;
}

/// What the triangles around a vertex ask of it, summed in their order.
struct SmoothingSums {
  Vector corners = {0, 0, 0};  ///< ways to the corners of the equilateral triangles
  Vector normal = {0, 0, 0};
  PlanesAround planes;
};

struct SmoothVertex {
  using Sums = SmoothingSums;

  MeshView mesh;
  WalkOntoSheet walk;
  SmoothOptions options;
  View<const PointQ8> from, previous;
  View<uint32_t> home;
  View<PointQ8> to;
  ISOSHELL_HD void operator()(int64_t v) const {
    const PointQ8 p = from[v];
    if (is_locked(v)) {
      to[v] = p;
      return;
    }
    const double radius = radius_q8(v);
    SmoothingSums sums;
    for_each_half_edge_around(mesh, uint32_t(v),
                              [&](uint32_t h) { add(h, p, from[mesh.to(h)], from[mesh.opposite(h)], radius, sums); });
    finish(v, sums);
  }

  // The parts of a step.

  ISOSHELL_HD void finish(int64_t v, const SmoothingSums& sums) const {
    to[v] = place(v, sums);
    if (options.onto_sheet) lay_onto_sheet(v);
  }

  ISOSHELL_HD bool is_locked(int64_t v) const { return v < options.locked; }
  /// Of the triangle that is to be around the vertex.
  ISOSHELL_HD double radius_q8(int64_t v) const { return options.size.at(home[v]) * kRadiusOfEdge; }
  /// What the triangle (p, b, c), whose half-edge from p this is, asks of p.
  ISOSHELL_HD void add(uint32_t, PointQ8 p, PointQ8 b, PointQ8 c, double radius, SmoothingSums& sums) const {
    sums.corners = sums.corners + to_equilateral_corner(p, b, c, options.evenness, radius);
    const Vector n = normal_of(p, b, c);
    sums.normal = sums.normal + n;
    sums.planes.add(n);
  }
  /// Where the vertex goes along the mesh.
  ISOSHELL_HD PointQ8 place(int64_t v, const SmoothingSums& sums) const {
    const PointQ8 p = from[v];
    const Vector normal = unit(sums.normal);
    const Vector asked = 1 / double(mesh.valence[v]) * sums.corners + options.momentum * from_to(previous[v], p);
    const Vector wanted = sums.planes.holding(options.hold).solve(asked);
    return moved_by(p, at_most(wanted - dot(wanted, normal) * normal, options.most_edges * options.size.at(home[v])));
  }
  ISOSHELL_HD void lay_onto_sheet(int64_t v) const {
    home[v] = walk.nearest_vertex(home[v], to[v]);
    to[v] = walk.closest_around(home[v], to[v]);
  }
};

struct EdgeLength {
  MeshView mesh;
  View<const PointQ8> position;
  ISOSHELL_HD int64_t operator()(int64_t h) const {
    return int64_t(isqrt(uint64_t(distance_sq_q16(position[mesh.from(uint32_t(h))], position[mesh.to(uint32_t(h))]))));
  }
};

}  // namespace isoshell::optimize
