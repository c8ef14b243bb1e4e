// What is inside of Prepared: products up to the sheet, for the steps of a run.
#pragma once

#include <memory>
#include <optional>

#include "isoshell/remesh.h"
#include "pipeline/grid/plan.h"

namespace isoshell {

/// What a sheet bounds instead of the solid of the sites, where edges could not follow both sides of the surface's
/// walls: voxels up to a distance from them.
struct GrownSolid {
  int32_t distance_vox = 0;  ///< from a site; 0: nothing was grown
  bool only_flaps = false;   ///< grown are only the sites of parts that bound nothing, and the others are as they were
  SiteSet voxels;            ///< the sites and what was grown

  explicit operator bool() const { return distance_vox > 0; }
};

class CreaseSearch;
struct CutSurface;
struct RegionWalls;
struct RelaxedMeanwhile;

struct PreparedSurface {
  RemeshOptions options;  ///< as checked()
  LatticeSurface surface;
  std::shared_ptr<const TriangleSoup> exact;  ///< what was snapped, positions and triangles; null unless asked for
  SiteSet sites;
  SiteSamples samples;
  Shell shell;
  Sheet sheet;
  int32_t closing_vox = 0;
  GrownSolid grown;                               ///< for the stages that follow
  Target target_of_input;                         ///< for the area of the surface as it was given
  std::optional<int64_t> vertices_of_lengths;     ///< as many as a sizing field asks for that decides the count
  Target target;                                  ///< of the run: by the lengths, or for the area of the sheet
  std::shared_ptr<const PreviousFrame> previous;  ///< that of the options, where the run begins with it
  std::shared_ptr<CreaseSearch> creases;          ///< looked for while a device makes the sheet
  bool own_faces_meet = false;                    ///< on the lattice, even where they are cut along one another
  bool needs_own_triangles = false;               ///< even without curves: the sheet lacks the input's topology
  std::shared_ptr<const CutSurface> cut;      ///< the input's own triangles in patches; null where no features are kept
  std::shared_ptr<const RegionWalls> walls;   ///< of regions, which the surface parts; null: it bounds one solid
  std::shared_ptr<RelaxedMeanwhile> relaxed;  ///< on a device while creases were looked for, in case there are none
  RemeshReport report;                        ///< up to here; the log is there once all is prepared
};

/// The library's own way into a Prepared.
struct PreparedParts {
  static const PreparedSurface& of(const Prepared& prepared) { return *prepared.parts_; }
  static Prepared hold(PreparedSurface parts);
};

/// A surface that a run begins with.
PreparedSurface begin_with(LatticeSurface surface, const RemeshOptions& checked_options);

/// Sets p.target, once the sheet and its lengths are there; a surface without a sheet keeps that of the input.
void set_target(PreparedSurface& p);

/// How long edges are for the area of the sheet. Cost: O(sheet).
double edge_length_on_sheet_world(const PreparedSurface& p);

inline bool has_sheet(const PreparedSurface& p) { return p.sheet.vertex_count() > 0; }

}  // namespace isoshell
