// CUDA's relax_on_sheet: passes of two kernels over patches, the plain body where a sheet has no patches.
#include "cuda/cuda_backend.h"
#include "cuda/label_forms.cuh"
#include "cuda/relax_sheet_pass.cuh"

namespace isoshell {
namespace {

using namespace cuda_relax;

constexpr int kThreads = 128;

/// About four cells at most, so that lists of candidates stay short; few enough that patches take about the same time
/// and that small sheets, too, give every multiprocessor some. Leaves have about 65 vertices.
int own_vertices_for(int64_t h_sq_q16, int64_t vertices) {
  constexpr int64_t kFewest = 40, kMost = 160, kPatches = 3000;
  const int64_t of_cells = 4 * h_sq_q16 >> (2 * kFractionBits), of_sheet = vertices / kPatches;
  const int64_t least = of_cells < of_sheet ? of_cells : of_sheet;
  return int(least < kFewest ? kFewest : least > kMost ? kMost : least);
}

RelaxReport relax_by_patches(CudaExecutor& exec, const Sheet& sheet, const SheetPatches& patches,
                             const SeedSpacing& spacing, SeedSet& seeds, const RelaxOptions& options) {
  const int64_t count = seeds.size(), parts = patches.patch.size();
  SeedBuckets buckets = make_seed_buckets(exec, sheet.corners.block_dims, 2 * spacing.h_q8, count, 2);
  Buffer<SeedRecord> records = exec.make<SeedRecord>(count);
  Buffer<PointQ8> last = exec.make<PointQ8>(count);
  Buffer<relax_sheet::CellSum> cells = exec.make<relax_sheet::CellSum>(count);
  Buffer<int32_t> reach = exec.make<int32_t>(parts);
  Buffer<PassState> state = exec.make<PassState>(1);
  Buffer<PassProgress> progress = exec.make<PassProgress>(1);

  const WalkOntoSheet walk{sheet.position.view(), sheet.normal.view(), sheet.triangles.view(),
                           sheet.vertex_first.view(), sheet.vertex_triangles.view()};
  const relax_sheet::MovingSeeds moving = relax_sheet::moving_seeds(walk, seeds, last.view(), spacing, options);
  SheetPass pass{patches.view(),       {buckets.grid, buckets.table(0), records.data(), spacing.penalty_q16},
                 reach.data(),         int32_t(spacing.h_q8 / 8),
                 cells.data(),         state.data(),
                 progress.data(),      relax_sheet::energy_shift(spacing),
                 options.tolerance_ppb};
  SheetMove move{moving,           cells.data(), records.data(),  buckets.grid,       buckets.table(1),
                 buckets.table(0), state.data(), progress.data(), options.max_passes, count};
  start_seeds<<<blocks_for(count, kThreads), kThreads, 0, exec.stream()>>>(move, state.data(), progress.data());
  exec.fill(reach.view(), int32_t(spacing.h_q8 * 5 / 4));
  exec.check("start passes");
  const unsigned sum_blocks = exec.device().resident_blocks(parts, kSumBlocks);
  int searched = 0;
  return run_passes(exec, View<const PassState>(state.view()), options.max_passes, [&] {
    pass.search.table = move.from = buckets.table(searched);
    searched = 1 - searched;
    move.to = buckets.table(searched);
    sum_patches<<<sum_blocks, 32, 0, exec.stream()>>>(pass);
    move_seeds<<<blocks_for(count, kMoveThreads / kWalkLanes), kMoveThreads, 0, exec.stream()>>>(move);
    exec.check("relaxation pass");
  });
}

}  // namespace

RelaxReport cuda_relax_on_sheet(const Sheet& sheet, SeedSet& seeds, const RelaxOptions& options, Context& context) {
  CudaExecutor exec(context, "relax_sheet");
  const OnDevice<Sheet> here(exec, sheet);
  on_device(exec, seeds);
  const SeedSpacing spacing = seed_spacing(exec, *here, seeds.size());
  const SheetPatches patches =
      make_sheet_patches(exec, *here, own_vertices_for(spacing.h_sq_q16, here->vertex_count()));
  if (!patches.fits) return relax_on_sheet_body(exec, *here, seeds, options);
  return relax_by_patches(exec, *here, patches, spacing, seeds, options);
}

}  // namespace isoshell
