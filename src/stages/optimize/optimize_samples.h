// What the surface asks of the mesh: samples are sheet vertices, and points that the sheet misses, each attached to
// the closest triangle of the mesh; their residuals, summed as integers, pull the corners.
#pragma once

#include "stages/halfedge/half_edges.h"
#include "stages/halfedge/triangle_shape.h"

namespace isoshell::optimize {

/// A point of the surface and the triangle of the mesh that it belongs to.
struct FitSample {
  PointQ8 position;
  Normal8 normal;
  bool is_off_surface;
  uint32_t triangle;
};

/// The point of a triangle closest to q, in barycentric coordinates, and what is left to q.
struct Foot {
  double weight[3];
  Vector rest;
};
ISOSHELL_HD inline Foot foot_on_triangle(PointQ8 q, PointQ8 a, PointQ8 b, PointQ8 c) {
  const Vector ab = from_to(a, b), ac = from_to(a, c), aq = from_to(a, q), bq = from_to(b, q), cq = from_to(c, q);
  const double d1 = dot(ab, aq), d2 = dot(ac, aq), d3 = dot(ab, bq), d4 = dot(ac, bq), d5 = dot(ab, cq),
               d6 = dot(ac, cq);
  if (d1 <= 0 && d2 <= 0) return {{1, 0, 0}, aq};
  if (d3 >= 0 && d4 <= d3) return {{0, 1, 0}, bq};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) {
    const double t = d1 - d3 > 0 ? d1 / (d1 - d3) : 0;
    return {{1 - t, t, 0}, aq - t * ab};
  }
  if (d6 >= 0 && d5 <= d6) return {{0, 0, 1}, cq};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) {
    const double t = d2 - d6 > 0 ? d2 / (d2 - d6) : 0;
    return {{1 - t, 0, t}, aq - t * ac};
  }
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double length = (d4 - d3) + (d5 - d6), t = length > 0 ? (d4 - d3) / length : 0;
    return {{0, 1 - t, t}, bq - t * (ac - ab)};
  }
  const double sum = va + vb + vc, v = vb / sum, w = vc / sum;
  return {{1 - v - w, v, w}, aq - (v * ab + w * ac)};
}

/// Sheet vertices at even distances in their order, then the off-surface points, on the triangle around its label's
/// vertex that is closest and faces its way. Off-surface points take label and normal of the sheet vertex nearest to
/// them.
struct AttachSample {
  MeshView mesh;
  View<const PointQ8> position;
  View<const PointQ8> sheet_position;
  View<const Normal8> sheet_normal;
  View<const uint32_t> label;
  View<const PointQ8> missed;
  View<const uint32_t> missed_vertex;
  View<FitSample> sample;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t of_sheet = sample.size - missed.size, off_surface_number = i - of_sheet;
    const bool is_off_surface = off_surface_number >= 0;
    const int64_t s = is_off_surface ? missed_vertex[off_surface_number] : i * sheet_position.size / of_sheet;
    FitSample out{is_off_surface ? missed[off_surface_number] : sheet_position[s], sheet_normal[s], is_off_surface,
                  kNone};
    double best = 0;
    for_each_half_edge_around(mesh, label[s], [&](uint32_t h) {
      const TriangleIndices t = mesh.triangles[h / 3];
      const PointQ8 a = position[t.a], b = position[t.b], c = position[t.c];
      const Vector rest = foot_on_triangle(out.position, a, b, c).rest;
      const double distance_sq = dot(rest, rest);
      if ((out.triangle == kNone || distance_sq < best) && faces(out.normal, normal_of(a, b, c)))
        out.triangle = h / 3, best = distance_sq;
    });
    sample[i] = out;
  }
  ISOSHELL_HD static bool faces(Normal8 n, Vector normal) {
    return n.x * normal.x + n.y * normal.y + n.z * normal.z > 0;
  }
};

/// Integer sums of what samples ask for. A sample over the inside of a triangle pulls along its normal; one beyond an
/// edge or a corner pulls the ends towards itself.
struct TrianglePull {
  int64_t weight[3], pull[3];  ///< per corner; scaled by kPullScale
};
struct VertexPull {
  int64_t weight[6], pull[3];  ///< sum of w d d^T (xx, xy, xz, yy, yz, zz) and of w r d
};
constexpr double kPullScale = 1024;
constexpr double kLargestWeight = 64;
constexpr double kNearWeight = 4;  ///< of samples that are nearest to the mesh, in those at the root mean square
constexpr double kOffSurfaceWeight =
    4;  ///< of off-surface points where tails begin; other samples have 1 / tail_of_rms there
// Where the tails begin. With vertices in proportion to curvature residuals are alike everywhere: then the largest are
// no tips that vertices are missing for, but samples that those around them outweigh.
constexpr double kTailOfRms = 4, kSizedTailOfRms = 2.5;

struct PullOptions {
  double rms_q8 = 0;  ///< of the residuals; 0: all samples weigh the same, and off-surface points nothing
  double far_q8 = 0;  ///< samples farther than this look around, and those twice as far weigh ever more
  double tail_of_rms = kTailOfRms;
  bool steep_tails = false;  ///< weights rise there by the fourth power instead of the square
};

/// Lets a sample slide to a closer triangle near its own, and adds what it asks for.
struct PullCorners {
  MeshView mesh;
  View<const PointQ8> position;
  PullOptions options;
  View<FitSample> sample;
  View<TrianglePull> triangle_pull;
  View<VertexPull> vertex_pull;
  View<int64_t> rest_sq;
  ISOSHELL_HD void operator()(int64_t i) const {
    FitSample s = sample[i];
    Foot foot;
    if (slide_to_foot(i, s, foot)) pull(i, s, foot);
  }

  // The parts of a step.

  /// Lets the sample slide, and finds where its foot is. False where it has no triangle.
  ISOSHELL_HD bool slide_to_foot(int64_t i, FitSample& s, Foot& foot) const {
    if (s.triangle == kNone) {
      rest_sq[i] = 0;
      return false;
    }
    foot = foot_on(s.triangle, s.position);
    const uint32_t before = s.triangle;
    for (int step = 0; step < 4 && slide(s, foot); ++step) {
    }
    if (s.triangle != before) sample[i].triangle = s.triangle;
    return true;
  }
  ISOSHELL_HD Foot foot_on(uint32_t t, PointQ8 q) const {
    const TriangleIndices i = mesh.triangles[t];
    return foot_on_triangle(q, position[i.a], position[i.b], position[i.c]);
  }
  /// Whether a sample looks at all triangles around its own one.
  ISOSHELL_HD bool is_far(double distance_sq) const { return distance_sq > options.far_q8 * options.far_q8; }
  /// Adds what a sample asks for where it is.
  ISOSHELL_HD void pull(int64_t i, const FitSample& s, const Foot& foot) const {
    add_to_triangle(s.triangle, asked_of_triangle(i, s, foot));
  }
  ISOSHELL_HD void add_to_triangle(uint32_t triangle, const TrianglePull& asked) const {
    TrianglePull& sum = triangle_pull[triangle];
    for (int k = 0; k < 3; ++k) {
      if (asked.weight[k] != 0) atomic_add(sum.weight[k], asked.weight[k]);
      if (asked.pull[k] != 0) atomic_add(sum.pull[k], asked.pull[k]);
    }
  }
  /// What a sample asks of its triangle, to be added; what it asks of vertices is added here.
  ISOSHELL_HD TrianglePull asked_of_triangle(int64_t i, const FitSample& s, const Foot& foot) const {
    const double distance_sq = dot(foot.rest, foot.rest);
    rest_sq[i] = int64_t(distance_sq);
    TrianglePull asked{};
    const double w = weight_of(s, distance_sq);
    if (!(w > 0)) return asked;
    const TriangleIndices corners = mesh.triangles[s.triangle];
    const Vector normal = unit(normal_of(position[corners.a], position[corners.b], position[corners.c]));
    const double along = dot(foot.rest, normal);
    // Beyond an edge or a corner, unless that is as good as along the normal, or level with the triangle.
    const bool beyond = distance_sq > 1 && along * along < 0.96 * distance_sq && along * along > 0.04 * distance_sq;
    for (int k = 0; k < 3; ++k) {
      if (!(foot.weight[k] > 0)) continue;
      const double part = w * foot.weight[k];
      if (beyond)
        add(vertex_pull[corner(corners, k)], part, foot.rest, distance_sq);
      else
        asked.weight[k] = scaled(part), asked.pull[k] = scaled(part * along);
    }
    return asked;
  }

 private:
  /// To the closest of the triangles that share the edge that the foot lies on, or, where it lies on a corner or far
  /// from the sample, any corner. False when that is the sample's own.
  ISOSHELL_HD bool slide(FitSample& s, Foot& foot) const {
    const int zeros = (foot.weight[0] <= 0) + (foot.weight[1] <= 0) + (foot.weight[2] <= 0);
    double best = dot(foot.rest, foot.rest);
    const bool far = is_far(best);
    if (zeros == 0 && !far) return false;
    const uint32_t own = s.triangle;
    const auto consider = [&](uint32_t t) {
      const TriangleIndices i = mesh.triangles[t];
      const PointQ8 a = position[i.a], b = position[i.b], c = position[i.c];
      const Foot there = foot_on_triangle(s.position, a, b, c);
      const double distance_sq = dot(there.rest, there.rest);
      if (distance_sq < best && AttachSample::faces(s.normal, normal_of(a, b, c)))
        best = distance_sq, s.triangle = t, foot = there;
    };
    if (zeros == 1 && !far) {  // on the edge opposite of the corner without weight
      const uint32_t h = own * 3 + (foot.weight[0] <= 0 ? 1 : (foot.weight[1] <= 0 ? 2 : 0));
      if (!mesh.is_border(h)) consider(mesh.twin[h] / 3);
      return s.triangle != own;
    }
    const bool at[3] = {foot.weight[0] > 0, foot.weight[1] > 0, foot.weight[2] > 0};
    for (uint32_t k = 0; k < 3; ++k) {
      if (!far && !at[k]) continue;
      mesh.any_from(own * 3 + k, [&](uint32_t h) {
        if (h / 3 != own) consider(h / 3);
        return false;
      });
    }
    return s.triangle != own;
  }
  /// Weights fall with the residual: the mean distance is to shrink, not the mean of its square. In the tails they rise
  /// again, for the largest distance, and steeply where it is a good part of an edge. Off-surface points count only
  /// there: they are not spread evenly.
  ISOSHELL_HD double weight_of(const FitSample& s, double distance_sq) const {
    if (!(options.rms_q8 > 0)) return s.is_off_surface ? 0 : 1;
    const double part = rounded_sqrt(distance_sq) / options.rms_q8;
    if (part <= options.tail_of_rms) {
      if (s.is_off_surface) return 0;
      return part * kNearWeight > 1 ? 1 / part : kNearWeight;
    }
    const double beyond = part / options.tail_of_rms, square = beyond * beyond,
                 far = distance_sq / (4 * options.far_q8 * options.far_q8);
    const double steep = far > 1 ? far * far * far : 1;
    const double w = (s.is_off_surface ? kOffSurfaceWeight : 1 / options.tail_of_rms) *
                     (options.steep_tails ? square * square : square) * steep;
    return w < kLargestWeight ? w : kLargestWeight;
  }
  ISOSHELL_HD static int64_t scaled(double x) { return int64_t(x * kPullScale); }
  ISOSHELL_HD static void add(VertexPull& sum, double w, Vector rest, double distance_sq) {
    const double part = w / distance_sq;
    atomic_add(sum.weight[0], scaled(part * rest.x * rest.x));
    atomic_add(sum.weight[1], scaled(part * rest.x * rest.y));
    atomic_add(sum.weight[2], scaled(part * rest.x * rest.z));
    atomic_add(sum.weight[3], scaled(part * rest.y * rest.y));
    atomic_add(sum.weight[4], scaled(part * rest.y * rest.z));
    atomic_add(sum.weight[5], scaled(part * rest.z * rest.z));
    atomic_add(sum.pull[0], scaled(w * rest.x));
    atomic_add(sum.pull[1], scaled(w * rest.y));
    atomic_add(sum.pull[2], scaled(w * rest.z));
  }
};

struct RestSq {
  View<const int64_t> rest_sq;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return rest_sq[i]; }
};

}  // namespace isoshell::optimize
