// What relaxation keeps from pass to pass, where its steps run: so the host enqueues passes without looking at each.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/stages.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// One element, next to the seeds. Steps of a pass do nothing once it has converged.
struct PassState {
  static constexpr int kKept = 64;  ///< energies that are kept; no batch of passes is longer

  int64_t energy[kKept];  ///< of pass p at p % kKept
  int32_t passes;
  int32_t converged;
  int64_t beta_q15;  ///< Nesterov's factor for the next pass
  double momentum;   ///< and what it is made from

  ISOSHELL_HD int64_t energy_of(int32_t pass) const { return energy[pass % kKept]; }
  ISOSHELL_HD void add(int64_t pass_energy) { energy[passes++ % kKept] = pass_energy; }
};

template <>
constexpr bool kHasNoPadding<PassState> = sizeof(PassState) == (PassState::kKept + 3) * sizeof(int64_t);

/// An exact sum that may pass 64 bits, as two that do not: of the terms' upper parts and of their lower 32 bits.
struct SplitSum {
  int64_t high, low;

  ISOSHELL_HD static SplitSum of(Int128 term) { return {int64_t(term >> 32), int64_t(term & 0xffffffff)}; }
  ISOSHELL_HD Int128 value() const { return (Int128(high) << 32) + low; }
};

struct HighPart {
  View<const SplitSum> terms;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return terms[i].high; }
};
struct LowPart {
  View<const SplitSum> terms;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return terms[i].low; }
};

/// Both sums over the terms, into out[0] and out[1].
template <class Exec>
void sum_split_into(Exec& exec, View<int64_t> out, View<const SplitSum> terms) {
  exec.sum_into({out.data, 1}, terms.size, HighPart{terms});
  exec.sum_into({out.data + 1, 1}, terms.size, LowPart{terms});
}

/// Runs passes in the executor's batches until one has converged or all are done. `pass()` enqueues one.
template <class Exec, class Pass>
RelaxReport run_passes(Exec& exec, View<const PassState> state, int32_t max_passes, Pass pass) {
  static_assert(Exec::kPassBatch <= PassState::kKept, "energies of a batch are read after it");
  RelaxReport report;
  while (report.passes < max_passes && !report.converged) {
    const int32_t left = max_passes - report.passes;
    for (int32_t b = 0; b < (left < Exec::kPassBatch ? left : Exec::kPassBatch); ++b) pass();
    const PassState now = exec.value(state, int64_t(0));
    for (; report.passes < now.passes; ++report.passes) report.energy.push_back(double(now.energy_of(report.passes)));
    report.converged = now.converged != 0;
    if (exec.context().progress) exec.context().progress("relax", double(report.passes) / max_passes);
  }
  return report;
}

}  // namespace isoshell
