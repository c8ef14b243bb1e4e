// Moving along the surface: how seeds and vertices get back onto it after a step.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "voxel/closest_point.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// Puts a position back onto the sheet: walks from vertex to neighbouring vertex as long as one is nearer, then takes
/// the closest point of the triangles around the last one. Never jumps through a thin wall. Result: a function of
/// (start vertex, position) alone.
struct WalkOntoSheet {
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<const TriangleIndices> triangles;
  View<const uint32_t> vertex_first;
  View<const uint32_t> vertex_triangles;
  View<const uint32_t> border_before;

  ISOSHELL_HD bool is_on_border(uint32_t v) const { return border_before.size > 0 && border_before[v] != kNone; }
  ISOSHELL_HD uint32_t nearest_vertex(uint32_t from, PointQ8 p) const {
    int64_t best = distance_sq_q16(position[from], p);
    for (;;) {
      uint32_t next = from;
      const auto consider = [&](uint32_t v) {
        const int64_t d = distance_sq_q16(position[v], p);
        if (d < best || (d == best && v < next)) best = d, next = v;
      };
      for (int64_t n = vertex_first[from]; n < vertex_first[from + 1]; ++n) {
        const TriangleIndices t = triangles[vertex_triangles[n]];
        consider(t.a == from ? t.b : (t.b == from ? t.c : t.a));  // each neighbour follows in one triangle
      }
      if (is_on_border(from)) consider(border_before[from]);  // but this one
      if (next == from) return from;
      from = next;
    }
  }
  ISOSHELL_HD PointQ8 closest_around(uint32_t vertex, PointQ8 p) const {
    PointQ8 closest = position[vertex];
    int64_t best = INT64_MAX;
    for (int64_t n = vertex_first[vertex]; n < vertex_first[vertex + 1]; ++n) {
      const TriangleIndices t = triangles[vertex_triangles[n]];
      const PointQ8 q = closest_point_on_triangle(p, position[t.a], position[t.b], position[t.c]);
      const int64_t d = distance_sq_q16(q, p);
      if (d < best) best = d, closest = q;
    }
    return closest;
  }
};

inline WalkOntoSheet walk_onto(const SurfaceMesh& surface) {
  return {surface.position.view(),     surface.normal.view(),           surface.triangles.view(),
          surface.vertex_first.view(), surface.vertex_triangles.view(), surface.border_before.view()};
}

/// Takes element i, where step.aims(i, target) says so, from vertex home[i] to the target, and tells the step the
/// vertex and the point on the sheet where it arrives.
template <class Step>
struct WalkToTarget {
  WalkOntoSheet walk;
  View<const uint32_t> home;
  Step step;
  ISOSHELL_HD void operator()(int64_t i) const {
    PointQ8 target;
    if (!step.aims(i, target)) return;
    const uint32_t vertex = walk.nearest_vertex(home[i], target);
    step.arrives(i, vertex, walk.closest_around(vertex, target));
  }
};

struct PlainWalks {
  /// Runs a step whose element i walks from vertex home[i].
  template <class Exec, class Step>
  static void for_each(Exec& exec, const char* name, const WalkOntoSheet&, View<const uint32_t> home, Step step) {
    exec.for_each(name, home.size, step);
  }
  /// Takes every element that aims at a target there. See WalkToTarget.
  template <class Exec, class Step>
  static void to_targets(Exec& exec, const char* name, const WalkOntoSheet& walk, View<uint32_t> home, Step step) {
    exec.for_each(name, home.size, WalkToTarget<Step>{walk, home, step});
  }
};

}  // namespace isoshell
