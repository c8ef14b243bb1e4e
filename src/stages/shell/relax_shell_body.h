// relax_in_shell (see stages.h), written once over an executor. The paper's Lloyd loop, sections 3.2 and 3.3.
//
// Result of a pass. Cell of a seed: the active voxels whose smallest (squared distance from the voxel's centre in q16,
// seed id) is its own. C: their mean centre, from integer sums and one rounding division (density 1). The seed moves to
// C, at most u towards it. When the voxel it comes to is not active, it goes back to M: to the sample point of the
// smallest (squared distance to the new position, site id) among the closest sites of the active voxels around that
// voxel, else of its home. Home is the closest site of the seed's voxel. An empty cell keeps its seed.
#pragma once

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "stages/relax/pass_state.h"
#include "stages/shell/nearest_seed_body.h"
#include "stages/sparse/drop_empty_leaves.h"

namespace isoshell {
namespace relax_shell {

constexpr int kEnergyShift = 8;  ///< energies are in 1/256 voxel^2: the exact sum is cut there
constexpr int kStallPasses = 5;  ///< over which the tolerance is measured

/// Sums of one cell. Relative to its seed, so they stay small: moment < 2^28 voxels * 2^21.
struct CellSums {
  int64_t count, x, y, z;
};

/// What labelling does with its labels: adds them up per cube and seed near it, then once per cube to the cells.
struct SumCells {
  VoxelSetView voxels;
  View<const PointQ8> position;
  View<CellSums> cells;
  View<SplitSum> energy;  ///< per leaf, zero at first

  /// Sums over voxels by their offsets from the leaf's voxel 0: count, x, y, z in 16 bits each, 512 * 7 fits.
  struct Cube {
    const SumCells& to;
    int64_t leaf;
    const PointList& near;
    int64_t energy = 0;
    uint64_t sums[kMaxNear];

    ISOSHELL_HD Cube(const SumCells& sink, int64_t of_leaf, const PointList& around)
        : to(sink), leaf(of_leaf), near(around) {
      for (int i = 0; i < near.count; ++i) sums[i] = 0;
    }
    ISOSHELL_HD void voxel(int number, int offset, int64_t distance_sq_q16) {
      sums[number] += one_voxel(offset);
      energy += distance_sq_q16;
    }
    ISOSHELL_HD void finish() const {
      for (int i = 0; i < near.count; ++i)
        if (sums[i]) add(to.cells[near.id[i]], near.place(i), sums[i]);
      to.add_energy(leaf, energy);
    }
  };
  ISOSHELL_HD Cube open(int64_t leaf, const PointList& near) const { return {*this, leaf, near}; }

  ISOSHELL_HD void voxel(int64_t leaf, int offset, uint32_t seed) const {
    const Voxel at = leaf_of_key(voxels.leaf_key[leaf]);
    add(cells[seed], difference(position[seed], voxel_centre(voxel_at(at, 0))), one_voxel(offset));
    add_energy(leaf, distance_sq_q16(position[seed], voxel_centre(voxel_at(at, offset))));
  }

  ISOSHELL_HD static uint64_t one_voxel(int offset) {
    const uint64_t x = uint64_t(offset) >> 6, y = uint64_t(offset) >> 3 & 7, z = uint64_t(offset) & 7;
    return 1 | x << 16 | y << 32 | z << 48;
  }
  /// To the cell of a seed that is at `a` from the centre of the leaf's voxel 0.
  ISOSHELL_HD static void add(CellSums& cell, Vec64 a, uint64_t sums) {
    const int64_t n = int64_t(sums & 0xffff);
    const Vec64 first = {int64_t(sums >> 16 & 0xffff), int64_t(sums >> 32 & 0xffff), int64_t(sums >> 48)};
    const Vec64 moment = first * kOneVoxelQ8 - a * n;
    atomic_add(cell.count, n);
    atomic_add(cell.x, moment.x);
    atomic_add(cell.y, moment.y);
    atomic_add(cell.z, moment.z);
  }
  ISOSHELL_HD void add_energy(int64_t leaf, int64_t share) const {
    const SplitSum parts = SplitSum::of(share);
    energy[leaf].high += parts.high;
    energy[leaf].low += parts.low;
  }
};

/// `step` shortened to at most `most`, in q8.
ISOSHELL_HD inline Vec64 bounded_step(Vec64 step, int64_t most) {
  const int64_t length_sq = dot(step, step);
  if (length_sq <= most * most) return step;
  const int64_t length = int64_t(isqrt(uint64_t(length_sq - 1))) + 1;
  return {round_div(step.x * most, length), round_div(step.y * most, length), round_div(step.z * most, length)};
}

ISOSHELL_HD inline PointQ8 sample_point(const VoxelSetView& sites, View<const SiteSample> samples, uint32_t site) {
  const PointQ8 centre = voxel_centre(voxel_of_index(sites, site));
  const SiteSample& s = samples[site];
  return {centre.x + s.dx, centre.y + s.dy, centre.z + s.dz};
}

struct MoveSeed {
  VoxelSetView voxels;
  View<const uint32_t> closest_site;
  VoxelSetView sites;
  View<const SiteSample> samples;
  int64_t most_q8;
  View<const CellSums> cells;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  View<const PassState> state;

  ISOSHELL_HD void operator()(int64_t i) const {
    if (!state[0].converged) move(i);
  }

  ISOSHELL_HD void move(int64_t i) const {
    const CellSums& cell = cells[i];
    if (cell.count == 0) return;
    const Vec64 to_centre = {round_div(cell.x, cell.count), round_div(cell.y, cell.count),
                             round_div(cell.z, cell.count)};
    const Vec64 step = bounded_step(to_centre, most_q8);
    PointQ8 p = {position[i].x + int32_t(step.x), position[i].y + int32_t(step.y), position[i].z + int32_t(step.z)};
    const int64_t voxel = find_voxel(voxels, voxel_of(p));
    if (voxel >= 0) {
      home[i] = closest_site[voxel];
    } else {
      home[i] = site_around(p, home[i]);
      p = sample_point(sites, samples, home[i]);
    }
    normal[i] = samples[home[i]].normal;
    position[i] = p;
  }

  /// Where a seed goes that left the shell.
  ISOSHELL_HD uint32_t site_around(PointQ8 p, uint32_t otherwise) const {
    const Voxel v = voxel_of(p);
    int64_t best = INT64_MAX;
    uint32_t site = otherwise;
    for (int n = 0; n < 27; ++n) {
      const int64_t voxel = find_voxel(voxels, {v.x + n / 9 - 1, v.y + n / 3 % 3 - 1, v.z + n % 3 - 1});
      if (voxel < 0) continue;
      const uint32_t other = closest_site[voxel];
      const int64_t d = distance_sq_q16(p, sample_point(sites, samples, other));
      if (d < best || (d == best && other < site)) {
        best = d;
        site = other;
      }
    }
    return site;
  }
};

/// True when the energy fell by less than ppb parts in 10^9 a pass, over the last kStallPasses passes.
ISOSHELL_HD inline bool stalled(const PassState& state, int32_t tolerance_ppb) {
  const int32_t last = state.passes - 1;
  if (last < kStallPasses) return false;
  constexpr int64_t kBillion = 1000000000;
  const int64_t before = state.energy_of(last - kStallPasses), part = int64_t(kStallPasses) * tolerance_ppb;
  return before - state.energy_of(last) < part * (before / kBillion) + part * (before % kBillion) / kBillion;
}

struct StartPasses {
  View<PassState> state;
  ISOSHELL_HD void operator()(int64_t) const { state[0] = {}; }
};

/// Ends a pass: notes its energy, stops when it no longer falls.
struct FinishPass {
  View<PassState> state;
  View<const int64_t> energy;  ///< high and low part of a SplitSum
  int32_t tolerance_ppb;
  ISOSHELL_HD void operator()(int64_t) const {
    PassState& s = state[0];
    if (s.converged) return;
    s.add(int64_t(SplitSum{energy[0], energy[1]}.value() >> kEnergyShift));
    s.converged = stalled(s, tolerance_ppb);
  }
};

/// Edge of a square that holds one seed, by the count of sites, which are about one a unit of area.
inline int64_t spacing_q8(int64_t sites, int64_t seeds) {
  return int64_t(isqrt(uint64_t((sites << 2 * kFractionBits) / (seeds > 0 ? seeds : 1)))) + 1;
}

/// See RelaxReport.
inline double normalised_energy_factor(int64_t seeds, int64_t voxels, int64_t sites) {
  return double(seeds) / (double(1 << (2 * kFractionBits - kEnergyShift)) * double(voxels) * double(sites));
}

}  // namespace relax_shell

template <class Exec>
RelaxReport relax_in_shell_body(Exec& exec, const Shell& shell, const SiteSet& sites, const SiteSamples& samples,
                                SeedSet& seeds, const RelaxOptions& options) {
  using namespace relax_shell;
  const int64_t k = seeds.size(), leaves = shell.voxels.leaf_count();
  const int64_t spacing = spacing_q8(sites.voxels.voxel_count(), k);
  const VoxelSetView voxels = shell.voxels.view();
  PointGrid grid = make_point_grid(exec, BlockExtent(shell.voxels.view()).vox, (spacing >> kFractionBits) + 1, k);
  Buffer<CellSums> cells = exec.template make<CellSums>(k);
  Buffer<SplitSum> leaf_energy = exec.template make<SplitSum>(leaves);
  Buffer<int32_t> reach_q8 = exec.template make<int32_t>(leaves);
  Buffer<int64_t> energy = exec.template make<int64_t>(2);
  Buffer<PassState> state = exec.template make<PassState>(1);
  exec.for_each("start passes", 1, StartPasses{state.view()});
  exec.fill(reach_q8.view(), int32_t(spacing * 5 / 4));
  const LabelLeaf<SumCells> sum_leaf{voxels,
                                     grid.view(),
                                     {voxels, seeds.position.view(), cells.view(), leaf_energy.view()},
                                     reach_q8.view(),
                                     int32_t(spacing / 8)};
  const MoveSeed move{voxels,
                      shell.closest_site.view(),
                      sites.voxels.view(),
                      samples.sample.view(),
                      options.max_step_q8 > 0 ? options.max_step_q8 : kOneVoxelQ8,
                      cells.view(),
                      seeds.position.view(),
                      seeds.normal.view(),
                      seeds.home.view(),
                      state.view()};
  const FinishPass finish{state.view(), energy.view(), options.tolerance_ppb};
  RelaxReport report = run_passes(exec, state.view(), options.max_passes, [&] {
    fill_point_grid(exec, grid, View<const PointQ8>(seeds.position.view()));
    exec.fill(cells.view(), CellSums{});
    exec.fill(leaf_energy.view(), SplitSum{0, 0});
    exec.for_each("sum cells", leaves, sum_leaf);
    exec.for_each("move seeds", k, move);
    sum_split_into(exec, energy.view(), leaf_energy.view());
    exec.for_each("finish pass", 1, finish);
  });
  report.normalised_energy_factor = normalised_energy_factor(k, shell.voxels.voxel_count(), sites.voxels.voxel_count());
  return report;
}

}  // namespace isoshell
