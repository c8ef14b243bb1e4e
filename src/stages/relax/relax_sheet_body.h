// relax_on_sheet (see stages.h): centroidal Voronoi tessellation restricted to the sheet (paper section 3.3, with the
// sheet in place of the shell and cells clipped by their bisectors instead of counted in voxels).
//
// A pass: look ahead along the last move (Nesterov), label the sheet, sum area and moments of every clipped cell in
// integers, move each seed past its cell's centre, walk it back onto the sheet. Momentum starts anew when the energy
// rose. Fixed seeds take part in all but the moves.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/labels/label_body.h"
#include "stages/relax/cell_sums_body.h"
#include "stages/relax/pass_state.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell {
namespace relax_sheet {

/// Bits that the energy loses at last (twelve times the doubled second moments of all cells about their seeds, summed
/// exactly), so that it (about 2^6 times area times h^2 at the worst) stays below 2^60: 12 on all but the largest
/// sheets with the fewest seeds.
inline int energy_shift(const SeedSpacing& spacing) {
  const bool vary = spacing.lengths.vary();
  int bits = vary ? 6 + EdgeLengthsView::kDensityBits : 6;
  for (int64_t rest = spacing.area2_q16; rest > 0; rest >>= 1) ++bits;
  const int64_t largest_h_sq = vary ? spacing.largest_h_q8 * spacing.largest_h_q8 : spacing.h_sq_q16;
  for (int64_t rest = largest_h_sq; rest > 0; rest >>= 1) ++bits;
  return bits - 60 > 12 ? bits - 60 : 12;
}

/// Seeds while they move. `here` is where the cells are measured, `last` the outcome of the pass before.
struct MovingSeeds {
  WalkOntoSheet walk;
  View<PointQ8> here;
  View<PointQ8> last;
  View<uint32_t> home;
  View<Normal8> normal;
  int64_t max_step_q8;  ///< where lengths are least
  EdgeLengthsView lengths;
  int64_t fixed;  ///< so many of the first stay where they are

  ISOSHELL_HD bool is_free(int64_t i) const { return i >= fixed; }
  /// The step of seed i, shortened to the bound where it is at home.
  ISOSHELL_HD PointQ8 moved(int64_t i, PointQ8 from, Vec64 step) const {
    const int64_t length_sq = dot(step, step), most = lengths.scaled(max_step_q8, home[i]);
    if (length_sq > most * most) {
      const int64_t length = int64_t(isqrt(uint64_t(length_sq))) + 1;
      step = {step.x * most / length, step.y * most / length, step.z * most / length};
    }
    return {from.x + int32_t(step.x), from.y + int32_t(step.y), from.z + int32_t(step.z)};
  }
  /// Seed i is on the sheet again, nearest to the vertex.
  ISOSHELL_HD void arrives(int64_t i, uint32_t vertex, PointQ8 p) const {
    home[i] = vertex;
    normal[i] = walk.normal[vertex];
    here[i] = p;
  }
};

inline MovingSeeds moving_seeds(const WalkOntoSheet& walk, SeedSet& seeds, View<PointQ8> last,
                                const SeedSpacing& spacing, const RelaxOptions& options) {
  const int64_t most = options.max_step_q8;
  return {walk,
          seeds.position.view(),
          last,
          seeds.home.view(),
          seeds.normal.view(),
          most > 0 ? most : spacing.h_q8 * 2 / 5,
          most > 0 ? EdgeLengthsView{} : spacing.lengths,
          seeds.fixed.count};
}

/// s + beta (s - last).
ISOSHELL_HD inline PointQ8 point_ahead(const MovingSeeds& seeds, PointQ8 s, int64_t beta_q15, int64_t i) {
  const Vec64 step = difference(s, seeds.last[i]) * beta_q15;
  return seeds.moved(i, s, {step.x >> 15, step.y >> 15, step.z >> 15});
}

/// One component of the way from a seed to its cell's centre; `first` is that of the cell, which must have an area.
ISOSHELL_HD inline int64_t way_to_centre(int64_t first, int64_t mass) { return round_div(first, 3 * mass); }

/// Seeds go 1.3 times as far as their centres: neighbours follow, and fewer passes are needed.
ISOSHELL_HD inline int64_t past_centre(int64_t way) { return way + way * 3 / 10; }

/// A place beyond the centre of the cell measured at here, no farther than a step. The cell must have an area.
ISOSHELL_HD inline PointQ8 point_past_centre(const MovingSeeds& seeds, const CellSum& c, int64_t i) {
  const auto step = [&](int64_t first) { return past_centre(way_to_centre(first, c.mass)); };
  return seeds.moved(i, seeds.here[i], {step(c.first_x), step(c.first_y), step(c.first_z)});
}

struct LookAhead {
  MovingSeeds seeds;
  View<const PassState> state;
  ISOSHELL_HD bool aims(int64_t i, PointQ8& target) const {
    if (state[0].converged || !seeds.is_free(i)) return false;
    const int64_t beta_q15 = state[0].beta_q15;
    const PointQ8 s = seeds.here[i];
    target = point_ahead(seeds, s, beta_q15, i);
    seeds.last[i] = s;
    return beta_q15 != 0;
  }
  ISOSHELL_HD void arrives(int64_t i, uint32_t vertex, PointQ8 p) const { seeds.arrives(i, vertex, p); }
};

struct MovePastCentre {
  MovingSeeds seeds;
  View<const CellSum> cell;
  View<const PassState> state;
  ISOSHELL_HD bool aims(int64_t i, PointQ8& target) const {
    if (state[0].converged || !seeds.is_free(i) || cell[i].mass <= 0) return false;
    target = point_past_centre(seeds, cell[i], i);
    return true;
  }
  ISOSHELL_HD void arrives(int64_t i, uint32_t vertex, PointQ8 p) const { seeds.arrives(i, vertex, p); }
};

/// Nesterov's momentum factors, capped: the one for the next pass. One square root a pass.
ISOSHELL_HD inline void advance_momentum(PassState& state) {
  constexpr double kCap = 0.9;
  const double after = (1 + rounded_sqrt(1 + 4 * state.momentum * state.momentum)) / 2;
  const double beta = (state.momentum - 1) / after;
  state.momentum = after;
  state.beta_q15 = int64_t((beta < kCap ? beta : kCap) * 32768);
}

/// True when the energy fell by less than `tolerance_ppb` of itself a pass over the last five passes.
ISOSHELL_HD inline bool has_converged(const PassState& state, int32_t tolerance_ppb) {
  constexpr int kWindow = 5;
  if (state.passes <= kWindow) return false;
  const double before = double(state.energy_of(state.passes - 1 - kWindow)),
               now = double(state.energy_of(state.passes - 1));
  return before - now < before * (double(tolerance_ppb) * 1e-9 * kWindow) && now <= before;
}

/// State before the first pass, which has no momentum.
struct StartPasses {
  View<PassState> state;
  ISOSHELL_HD void operator()(int64_t) const {
    PassState& s = state[0];
    s = {};
    s.momentum = 1;
    advance_momentum(s);
  }
};

/// Ends a pass: notes its energy, starts momentum anew when it rose, stops when it no longer falls.
struct FinishPass {
  View<PassState> state;
  View<const int64_t> energy;  ///< high and low part of a SplitSum
  int shift;
  int32_t tolerance_ppb;
  ISOSHELL_HD void operator()(int64_t) const {
    PassState& s = state[0];
    if (s.converged) return;
    const int64_t now = int64_t(SplitSum{energy[0], energy[1]}.value() >> shift);
    if (s.passes > 0 && double(now) > double(s.energy_of(s.passes - 1))) s.momentum = 1;
    s.add(now);
    s.converged = has_converged(s, tolerance_ppb);
    advance_momentum(s);
  }
};

/// What passes spend their time on, as it is defined.
class PlainPassWork {
 public:
  template <class Exec>
  PlainPassWork(Exec& exec, const SurfaceMesh& surface, const SeedSpacing& spacing)
      : surface_(surface),
        spacing_(spacing),
        patches_(make_patches(exec, surface)),
        labels_(exec.template make<uint32_t>(surface.vertex_count())) {}

  /// Labels the sheet, adds to the cells, and writes each block's part of the energy. Nothing counts once the passes
  /// have converged.
  template <class Exec>
  void measure(Exec& exec, const SeedSet& seeds, View<CellSum> cells, View<SplitSum> block_energy,
               View<const PassState> state) {
    Exec::Kernels::LabelSheet::run(exec, surface_, seeds, spacing_, labels_.view());
    exec.for_each(
        "sum cells", surface_.blocks.count(),
        SumBlock<>{surface_.blocks.centre.view(), patches_.first.view(), patches_.triangles.view(),
                   surface_.position.view(), labels_.view(), seeds.position.view(), cells, block_energy, state});
  }

 private:
  const SurfaceMesh& surface_;
  const SeedSpacing spacing_;
  const Patches patches_;
  Buffer<uint32_t> labels_;
};

}  // namespace relax_sheet

template <class Exec>
RelaxReport relax_on_sheet_body(Exec& exec, const SurfaceMesh& surface, SeedSet& seeds, const RelaxOptions& options) {
  using namespace relax_sheet;
  using Kernels = typename Exec::Kernels;
  const int64_t count = seeds.size();
  const SeedSpacing spacing = seed_spacing(exec, surface, count);
  typename Kernels::PassWork pass(exec, surface, spacing);
  Buffer<PointQ8> last = exec.template make<PointQ8>(count);
  Buffer<CellSum> cells = exec.template make<CellSum>(count);
  Buffer<SplitSum> block_energy = exec.template make<SplitSum>(surface.blocks.count());
  Buffer<int64_t> energy = exec.template make<int64_t>(2);
  Buffer<PassState> state = exec.template make<PassState>(1);
  exec.copy(View<const PointQ8>(seeds.position.view()), last.view());
  exec.for_each("start passes", 1, StartPasses{state.view()});

  const WalkOntoSheet walk = walk_onto(surface);
  const MovingSeeds moving = moving_seeds(walk, seeds, last.view(), spacing, options);
  const FinishPass finish{state.view(), energy.view(), energy_shift(spacing), options.tolerance_ppb};

  return run_passes(exec, state.view(), options.max_passes, [&] {
    Kernels::Walks::to_targets(exec, "look ahead", walk, seeds.home.view(), LookAhead{moving, state.view()});
    exec.fill(cells.view(), CellSum{0, 0, 0, 0});
    pass.measure(exec, seeds, cells.view(), block_energy.view(), state.view());
    Kernels::Walks::to_targets(exec, "move past centre", walk, seeds.home.view(),
                               MovePastCentre{moving, cells.view(), state.view()});
    sum_split_into(exec, energy.view(), block_energy.view());
    exec.for_each("finish pass", 1, finish);
  });
}

}  // namespace isoshell
