// The small steps of optimize_mesh, and the plain form of those that take the time.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/optimize/optimize_fit.h"
#include "stages/optimize/optimize_smooth.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell::optimize {

/// Seeds go where the vertices are: position, home and normal.
struct UpdateSeed {
  WalkOntoSheet walk;
  View<const PointQ8> vertex;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  int64_t locked;  ///< the first seeds, so many, are where they began
  ISOSHELL_HD void operator()(int64_t v) const {
    if (v < locked) return;
    position[v] = vertex[v];
    home[v] = walk.nearest_vertex(home[v], vertex[v]);
    normal[v] = walk.normal[home[v]];
  }
};

/// Marks the neighbours of marked vertices too.
struct SpreadMarks {
  MeshView mesh;
  View<const uint32_t> marked;
  View<uint32_t> spread;
  ISOSHELL_HD void operator()(int64_t v) const {
    uint32_t any = marked[v];
    for_each_neighbour(mesh, uint32_t(v), [&](uint32_t b) { any |= marked[b]; });
    spread[v] = any;
  }
};
struct ReturnMarked {
  View<const uint32_t> marked;
  View<const PointQ8> to;
  View<PointQ8> position;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (marked[v]) position[v] = to[v];
  }
};
/// Whether a marked vertex is not where it would be taken back to.
struct IsAway {
  View<const uint32_t> marked;
  View<const PointQ8> from, position;
  ISOSHELL_HD int64_t operator()(int64_t v) const {
    return marked[v] && distance_sq_q16(position[v], from[v]) > 0 ? 1 : 0;
  }
};
struct IsMarked {
  View<const uint32_t> marked;
  ISOSHELL_HD int64_t operator()(int64_t v) const { return marked[v]; }
};

struct BlockMarked {
  View<const uint32_t> marked;
  View<uint32_t> blocked;
  ISOSHELL_HD void operator()(int64_t v) const { blocked[v] |= marked[v]; }
};

struct RotateTriangle {
  View<TriangleIndices> triangles;
  ISOSHELL_HD void operator()(int64_t i) const { triangles[i] = smallest_first(triangles[i]); }
};

/// The steps that take the time, each as it is defined.
struct PlainStepWork {
  /// Before steps between which the triangles stay.
  template <class Exec>
  void begin(Exec&, const MeshView&) {}
  template <class Exec>
  void smooth(Exec& exec, const SmoothVertex& step) {
    if (step.options.onto_sheet)
      Exec::Kernels::Walks::for_each(exec, "smooth", step.walk, step.home, step);
    else
      exec.for_each("smooth", step.to.size, step);
  }
  /// Before they are pulled: samples may take another order, but for off-surface points, which come after the sheet's.
  template <class Exec>
  void sort(Exec&, int64_t /*triangles*/, int64_t /*of_sheet*/, Buffer<FitSample>&) {}
  template <class Exec>
  void pull(Exec& exec, const PullCorners& step) {
    exec.for_each("pull corners", step.sample.size, step);
  }
  template <class Exec>
  void fit(Exec& exec, const FitVertex& step) {
    Exec::Kernels::Walks::for_each(exec, "fit", step.walk, step.home, step);
  }
};

}  // namespace isoshell::optimize
