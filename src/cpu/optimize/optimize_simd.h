// Steps of the optimisation on the CPU: the definitions of stages/optimize/optimize_smooth.h, optimize_samples.h and
// optimize_fit.h, with what stays the same between steps kept.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/optimize/optimize_fit.h"

namespace isoshell {

/// The triangles (v, b, c) around every vertex v, in the order of for_each_triangle_around.
struct TrianglesAround {
  struct Triangle {
    uint32_t b, c, half_edge;  ///< the half-edge runs from v to b
  };
  Buffer<uint32_t> first;  ///< vertex_count + 1
  Buffer<Triangle> triangles;
};

/// optimize::PlainStepWork in lanes.
class CpuStepSimd {
 public:
  void begin(CpuExecutor& exec, const optimize::MeshView& mesh);
  void smooth(CpuExecutor& exec, const optimize::SmoothVertex& step);
  /// By triangle.
  void sort(CpuExecutor& exec, int64_t triangles, int64_t of_sheet, Buffer<optimize::FitSample>& samples);
  void pull(CpuExecutor& exec, const optimize::PullCorners& step);
  void fit(CpuExecutor& exec, const optimize::FitVertex& step);

 private:
  TrianglesAround around_;
};

}  // namespace isoshell
