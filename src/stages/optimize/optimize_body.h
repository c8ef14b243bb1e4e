// optimize_mesh (see stages.h): valence flips, shape-matching smoothing with momentum, a fit to the surface, searches
// around the worst triangles, and vertices for what is far from the mesh. Every step is a Jacobi step or an independent
// set, so the order of the work cannot show.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/optimize/optimization_body.h"

namespace isoshell {
namespace optimize {

// No step may make a triangle below its bound worse; bounds rise to where the search begins, kGoodQuality. What flips
// make poor is smoothed after them.
constexpr double kFlippedQuality = 0.7, kPoorQuality = 0.8, kFairQuality = 0.9;

// Smoothing. The first one goes far: with much momentum, and held to the planes of the triangles, since it would slide
// vertices off tips and ridges. The second one only repairs around flips, in few steps, and is free.
constexpr double kHold = 64;  ///< 16 to 256 differ by little; 0 wears tips down
constexpr double kSmoothingMomentum = 0.95, kRepairMomentum = 0.5;
constexpr int kSmoothingStepsPerRepair = 8;

// The fit. It starts with whole moves, from vertices that are all on the surface and so far from where the mesh
// straddles it. Then it is damped: neighbours move at once, and whole moves would go too far together.
constexpr double kFirstDamping = 1, kDamping = 0.6;
constexpr int kFirstFitSteps = 5;      ///< until samples show which edges are chords
constexpr int kChordFitSteps = 3;      ///< around flipped chords, which may be poor
constexpr int kFairFitSteps = 4;       ///< before the search, within a higher bound
constexpr int kLastFitSteps = 3;       ///< the fit has the last word, within the bound of the search
constexpr int kRelocatedFitSteps = 5;  ///< around relocated vertices, as at the start

// Searches, in OptimizeOptions::search_rounds. Most are held to the planes; the last ones are free, as in smoothing.
constexpr int kHeldSearches = 3, kFreeSearches = 1;
constexpr int kRelocatedSearches = 5;  ///< stars of relocated vertices begin worse than what smoothing leaves
constexpr int kUndoneSearches = 3;     ///< what went back may be poor

/// Moves the mesh to where it straddles the surface.
template <class Exec>
void fit_to_surface(Optimization<Exec>& work, OptimizeReport& report) {
  work.attach_samples();
  work.fit(kFirstFitSteps, kFirstDamping, kPoorQuality);
  report.flips += work.flip_chords();
  work.fit(kChordFitSteps, kDamping, kPoorQuality);
  work.fit(kFairFitSteps, kDamping, kFairQuality);
}

/// Brings vertices to where the surface is far from the mesh, after the search: only among good triangles can those of
/// a star be good.
template <class Exec>
void relocate_to_far_places(Optimization<Exec>& work, const OptimizeOptions& options, double free_hold) {
  if (work.relocate(kFarPlace) == 0) return;
  work.fit(kRelocatedFitSteps, kDamping, kPoorQuality);
  if (work.relocate(kVeryFarPlace) > 0) work.fit(kRelocatedFitSteps, kDamping, kPoorQuality);
  work.search(kRelocatedSearches * options.search_rounds, free_hold, false);
  work.fit(kLastFitSteps, kDamping, kGoodQuality);
}

}  // namespace optimize

template <class Exec>
OptimizeReport optimize_mesh_body(Exec& exec, const SurfaceMesh& surface, const OptimizeOptions& options,
                                  SeedSet& seeds, DualMesh& mesh) {
  using namespace optimize;
  if (mesh.triangles.empty()) return {};
  Optimization<Exec> work(exec, surface, options, seeds, mesh);
  OptimizeReport report;
  // Triangles at fixed vertices may stay poor: a free search would take their other corners far off the surface.
  const double free_hold = seeds.fixed.count > 0 ? kHold : 0;
  const bool flips_only = options.smoothing_steps == 0;
  if (options.mesh_passes > 0) work.relax_on_mesh({options.mesh_passes, options.noise_edges});
  report.flips = work.flip(options.flip_rounds, kPoorQuality);
  if (!flips_only) {
    work.smooth(options.smoothing_steps, kSmoothingMomentum, kHold, kPoorQuality);
    report.flips += work.flip(options.flip_rounds, kFlippedQuality);
    work.smooth(options.smoothing_steps / kSmoothingStepsPerRepair, kRepairMomentum, 0, kFairQuality);
  }
  if (!flips_only && !options.for_seeds) {
    const bool balanced = options.fit == Fit::balanced;
    if (balanced) fit_to_surface(work, report);
    work.search(kHeldSearches * options.search_rounds, kHold, !balanced);
    work.search(kFreeSearches * options.search_rounds, free_hold, !balanced);
    if (balanced) {
      work.fit(kLastFitSteps, kDamping, kGoodQuality);
      if (!options.uniform_area && !options.keep_apart) relocate_to_far_places(work, options, free_hold);
      work.drop_samples();
    }
    work.undo_intersections(report);
    if (report.undone_vertices > 0) {
      work.search(kUndoneSearches * options.search_rounds, 0, true);
      work.undo_intersections(report);
    }
  }
  if (!options.for_seeds) work.turn_inside_out();
  work.finish();
  return report;
}

}  // namespace isoshell
