// Passes of relax_on_sheet on the CPU: the definitions of stages/labels/label_body.h and relax_sheet_body.h, with what
// stays the same between passes kept.
#pragma once

#include "cpu/executor_tbb.h"
#include "cpu/relax/label_simd.h"
#include "stages/relax/relax_sheet_body.h"

namespace isoshell {

/// Triangles by the block of their smallest vertex.
struct BlockPatches {
  Buffer<int64_t> first;  ///< block_count + 1
  Buffer<uint32_t> triangles;
  Buffer<uint32_t> mass;  ///< EdgeLengthsView::mass of each, which divides; empty where lengths do not vary
};

/// relax_sheet::PlainPassWork in lanes.
class CpuPassSimd {
 public:
  CpuPassSimd(CpuExecutor& exec, const SurfaceMesh& surface, const SeedSpacing& spacing);

  void measure(CpuExecutor& exec, const SeedSet& seeds, View<relax_sheet::CellSum> cells, View<SplitSum> block_energy,
               View<const PassState> state);

 private:
  const SurfaceMesh& surface_;
  LabelSimd labels_;
  BlockPatches patches_;
  Buffer<uint32_t> label_;
};

}  // namespace isoshell
