// CUDA's relax_on_sheet: passes of three kernels over patches, the plain body where a sheet has no patches.
#include <algorithm>

#include "cuda/cuda_backend.h"
#include "cuda/relax/label_cooperative.cuh"
#include "cuda/relax/relax_sheet_pass.cuh"

namespace isoshell {
namespace {

using namespace cuda_relax;

constexpr int kThreads = 128;

/// About four cells at most, so that lists of candidates stay short, but whole leaves, which have about 65 vertices;
/// few enough that patches take about the same time and that small sheets, too, give every multiprocessor some.
int own_vertices_for(int64_t h_sq_q16, int64_t vertices) {
  constexpr int64_t kFewest = 40, kLeaf = 64, kMost = 160, kPatches = 3000;
  const int64_t of_cells = std::max(kLeaf, 4 * h_sq_q16 >> (2 * kFractionBits)), of_sheet = vertices / kPatches;
  return int(std::clamp(std::min(of_cells, of_sheet), kFewest, kMost));
}

struct PassKernels {
  void (*label)(SheetPass);
  void (*sum)(SheetPass);
  void (*move)(SheetMove);
  int label_blocks, sum_blocks;  ///< a multiprocessor
  bool closely;                  ///< a kernel's first blocks wait beside the last ones of the kernel before
};

/// A pass of few patches takes as long as one warp needs for some of them: warps get all registers they can use, and
/// kernels start early. Of many patches more are worked on at once; blocks that wait would only take their room.
PassKernels kernels_for(int64_t patches, int processors) {
  if (patches > 256 * int64_t(processors)) return {label_patches<32>, sum_patches<24>, move_seeds<12>, 32, 24, false};
  return {label_patches<24>, sum_patches<16>, move_seeds<8>, 24, 16, true};
}

RelaxReport relax_by_patches(CudaExecutor& exec, const SurfaceMesh& surface, const SheetPatches& patches,
                             const SeedSpacing& spacing, SeedSet& seeds, const RelaxOptions& options) {
  const int64_t count = seeds.size(), parts = patches.patch.size();
  SeedBuckets buckets = make_seed_buckets(exec, surface.extent_vox, 2 * spacing.h_q8, count, 2);
  Buffer<SeedRecord> records = exec.make<SeedRecord>(count);
  Buffer<PointQ8> last = exec.make<PointQ8>(count);
  Buffer<relax_sheet::CellSum> cells = exec.make<relax_sheet::CellSum>(count);
  Buffer<uint8_t> label = exec.make<uint8_t>(patches.vertex.size());
  Buffer<PatchWinners> winners = exec.make<PatchWinners>(parts);
  Buffer<PassState> state = exec.make<PassState>(1);
  Buffer<PassProgress> progress = exec.make<PassProgress>(1);
  const Buffer<uint32_t> patch_of_seed = find_patches_of_seeds(exec, surface, seeds);

  const WalkOntoSheet walk = walk_onto(surface);
  const relax_sheet::MovingSeeds moving = relax_sheet::moving_seeds(walk, seeds, last.view(), spacing, options);
  SheetPass pass{patches.view(),
                 {buckets.grid, buckets.table(0), records.data(), spacing.penalty_q16, patch_of_seed.data()},
                 winners.data(),
                 label.data(),
                 int32_t(spacing.h_q8 / 8),
                 cells.data(),
                 state.data(),
                 progress.data(),
                 relax_sheet::energy_shift(spacing),
                 options.tolerance_ppb};
  SheetMove move{moving,           cells.data(), records.data(),  buckets.grid,       buckets.table(1),
                 buckets.table(0), state.data(), progress.data(), options.max_passes, count};
  start_seeds<<<blocks_for(count, kThreads), kThreads, 0, exec.stream()>>>(move, state.data(), progress.data());
  exec.fill(label.view(), uint8_t(0));
  exec.fill(winners.view(), PatchWinners{{}, 0, int32_t(spacing.h_q8 * 5 / 4), {}});
  exec.check("start passes");
  const PassKernels kernels = kernels_for(parts, exec.device().processors());
  const unsigned label_blocks = exec.device().resident_blocks(parts, kernels.label_blocks),
                 sum_blocks = exec.device().resident_blocks(parts, kernels.sum_blocks),
                 move_blocks = blocks_for(count, kMoveThreads / kWalkLanes);
  CloseLauncher launcher(exec, kernels.closely, kernels.label);
  int searched = 0;
  return run_passes(exec, View<const PassState>(state.view()), options.max_passes, [&] {
    pass.search.table = move.from = buckets.table(searched);
    searched = 1 - searched;
    move.to = buckets.table(searched);
    launcher.launch(kernels.label, label_blocks, 32, pass);
    launcher.launch(kernels.sum, sum_blocks, 32, pass);
    launcher.launch(kernels.move, move_blocks, kMoveThreads, move);
    exec.check("relaxation pass");
  });
}

}  // namespace

RelaxReport CudaBackend::relax_on_sheet(const SurfaceMesh& surface, SeedSet& seeds, const RelaxOptions& options,
                                        Context& context) const {
  CudaExecutor exec(context, "relax_sheet");
  const OnDevice<SurfaceMesh> here(exec, surface);
  on_device(exec, seeds);
  const SeedSpacing spacing = seed_spacing(exec, *here, seeds.size());
  const SheetPatches patches =
      make_sheet_patches(exec, *here, seeds.fixed, own_vertices_for(spacing.h_sq_q16, here->vertex_count()));
  if (!patches.fits) return relax_on_sheet_body(exec, *here, seeds, options);
  return relax_by_patches(exec, *here, patches, spacing, seeds, options);
}

}  // namespace isoshell
