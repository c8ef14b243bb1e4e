// Undoing a step of the optimisation where it would harm the mesh.
#pragma once

#include "stages/halfedge/half_edges.h"
#include "stages/halfedge/triangle_shape.h"

namespace isoshell::optimize {

/// Marks the corners of triangles that a step turned by more than 45 degrees, or that are below the bound and got
/// worse.
struct MarkHarmed {
  View<const TriangleIndices> triangles;
  View<const PointQ8> before, after;
  double least_quality;
  View<uint32_t> harmed;
  ISOSHELL_HD void operator()(int64_t t) const {
    const TriangleIndices i = triangles[t];
    const PointQ8 a = before[i.a], b = before[i.b], c = before[i.c], d = after[i.a], e = after[i.b], f = after[i.c];
    if (a == d && b == e && c == f) return;
    if (within_45_degrees(normal_of(a, b, c), normal_of(d, e, f))) {
      const double quality = quality_of(d, e, f);
      if (quality >= least_quality || quality >= quality_of(a, b, c)) return;
    }
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

/// Undoes the step where it would harm a triangle (ends: what is restored stays so); a restored vertex can harm
/// another, so up to a fixed point.
struct PlainUndoHarm {
  template <class Exec>
  static void run(Exec& exec, View<const TriangleIndices> triangles, double least_quality,
                  const RestoreHarmed& restore) {
    const int64_t vertices = restore.harmed.size;
    const MarkHarmed mark{triangles, restore.before, restore.after, least_quality, restore.harmed};
    for (;;) {
      exec.fill(restore.harmed, 0u);
      exec.for_each("mark harmed", triangles.size, mark);
      if (exec.sum(vertices, IsHarmed{restore.harmed}) == 0) return;
      exec.for_each("restore harmed", vertices, restore);
    }
  }
};

}  // namespace isoshell::optimize
