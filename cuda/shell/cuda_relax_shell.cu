// CUDA's relax_in_shell: passes of two kernels.
#include "cuda/cuda_backend.h"
#include "cuda/shell/relax_shell_pass.cuh"
#include "stages/sparse/drop_empty_leaves.h"

namespace isoshell {
namespace {

using namespace cuda_relax;

constexpr int kThreads = 128;

RelaxReport relax_by_parts(CudaExecutor& exec, const Shell& shell, const SiteSet& sites, const SiteSamples& samples,
                           SeedSet& seeds, const RelaxOptions& options) {
  const int64_t k = seeds.size(), leaves = shell.voxels.leaf_count();
  const int64_t spacing_q8 = relax_shell::spacing_q8(sites.voxels.voxel_count(), k);
  const int of_leaf = parts_of_leaf(spacing_q8);
  const VoxelSetView voxels = shell.voxels.view();
  Buffer<int64_t> first_part = exec.make<int64_t>(leaves);
  exec.for_each("count parts", leaves, CountLeafParts{voxels, of_leaf, first_part.view()});
  const int64_t parts = exec.exclusive_scan(first_part.view());
  // Cells that hold about five seeds, so that two in a bucket rarely overfill it.
  SeedBuckets buckets = make_seed_buckets(exec, BlockExtent(shell.voxels.view()).vox, 7 * spacing_q8 / 4, k, 2);
  Buffer<SeedRecord> records = exec.make<SeedRecord>(k);
  Buffer<relax_shell::CellSums> cells = exec.make<relax_shell::CellSums>(k);
  Buffer<ShellPart> descriptions = exec.make<ShellPart>(parts);
  Buffer<uint16_t> offsets = exec.make<uint16_t>(shell.voxels.voxel_count());
  Buffer<int32_t> reach = exec.make<int32_t>(parts);
  Buffer<PassState> state = exec.make<PassState>(1);
  Buffer<PassProgress> progress = exec.make<PassProgress>(1);

  ShellPass pass{
      descriptions.data(), offsets.data(),          parts,        {buckets.grid, buckets.table(0), records.data(), 0},
      reach.data(),        int32_t(spacing_q8 / 8), cells.data(), state.data(),
      progress.data(),     options.tolerance_ppb};
  ShellMove move{{voxels, shell.closest_site.view(), sites.voxels.view(), samples.sample.view(),
                  options.max_step_q8 > 0 ? options.max_step_q8 : kOneVoxelQ8, cells.view(), seeds.position.view(),
                  seeds.normal.view(), seeds.home.view(), state.view()},
                 cells.data(),
                 records.data(),
                 buckets.grid,
                 buckets.table(1),
                 buckets.table(0),
                 progress.data()};
  start_shell_seeds<<<blocks_for(k, kThreads), kThreads, 0, exec.stream()>>>(move, state.data(), progress.data());
  describe_parts<<<blocks_for(leaves, kThreads / 32), kThreads, 0, exec.stream()>>>(
      voxels, of_leaf, first_part.view(), descriptions.data(), offsets.data());
  exec.fill(reach.view(), int32_t(spacing_q8 * 5 / 4));
  exec.check("start passes");
  constexpr int kRounds = 8;  // so that blocks that are done early take more, and that few have to end a pass
  const unsigned blocks = exec.device().resident_blocks(blocks_for(parts, kPartWarps), kRounds * kPartBlocks);
  int searched = 0;
  RelaxReport report = run_passes(exec, View<const PassState>(state.view()), options.max_passes, [&] {
    pass.search.table = move.from = buckets.table(searched);
    searched = 1 - searched;
    move.to = buckets.table(searched);
    sum_parts<<<blocks, kPartWarps * 32, 0, exec.stream()>>>(pass);
    move_shell_seeds<<<blocks_for(k, kThreads), kThreads, 0, exec.stream()>>>(move);
    exec.check("relaxation pass");
  });
  report.normalised_energy_factor =
      relax_shell::normalised_energy_factor(k, shell.voxels.voxel_count(), sites.voxels.voxel_count());
  return report;
}

}  // namespace

RelaxReport CudaBackend::relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples,
                                        SeedSet& seeds, const RelaxOptions& options, Context& context) const {
  CudaExecutor exec(context, "relax_shell");
  return relax_by_parts(exec, *OnDevice<Shell>(exec, shell), *OnDevice<SiteSet>(exec, sites),
                        *OnDevice<SiteSamples>(exec, samples), on_device(exec, seeds), options);
}

}  // namespace isoshell
