// What is measured on the way of a run, and said of its input and its result.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/gaps.h"
#include "isoshell/previous_frame.h"
#include "isoshell/repair.h"
#include "isoshell/sizing.h"

namespace isoshell {

/// A curve of the input that the result does not have.
struct LostCurve {
  int64_t index = 0;        ///< among the curves that were found; of a line that was given its segment
  std::string kind;         ///< "crease", "seam", "line" or "border"
  double length_world = 0;  ///< along it
  WorldPoint at{0, 0, 0};   ///< where it begins
  std::string reason;
};

/// Curves that were lost for one reason.
struct LostForReason {
  std::string reason;
  int64_t curves = 0;
  double length_world = 0;  ///< of all of them
};

/// The reasons, those of the longest lengths first, at most so many. Cost: n log n.
std::vector<LostForReason> lost_by_reason(const std::vector<LostCurve>& lost, size_t most);

/// The longest curves, at most so many, of one length in their order. Cost: n log n.
std::vector<LostCurve> longest_of(std::vector<LostCurve> lost, size_t most);

double lost_length_world(const std::vector<LostCurve>& lost);

/// What was kept of the input's creases and borders.
struct FeatureReport {
  bool kept = false;             ///< the result has the curves as edges
  std::string given_up;          ///< why there are none, though curves were found; empty otherwise
  std::string on_sheet;          ///< why curves were laid onto the sheet instead of cutting the input; empty otherwise
  int64_t patches = 0;           ///< of the surface between the curves
  int64_t curves = 0;            ///< creases, seams and lines
  int64_t seams = 0;             ///< of the curves: where attributes jump and the surface does not turn
  int64_t lines = 0;             ///< of the curves: where lines were given and the surface does not turn
  int64_t corners = 0;           ///< where curves end or turn sharply
  int64_t vertices = 0;          ///< of the result on curves
  int64_t segments = 0;          ///< edges of the result on curves, borders too
  int64_t border_loops = 0;      ///< of the result
  double length_world = 0;       ///< of the curves found
  double kept_length_world = 0;  ///< of these the length that the result has as edges
  double passed_over_world = 0;  ///< length of sharp edges that were not taken for creases: of scans, or too short
  std::vector<LostCurve> lost;   ///< in the order of the curves, after the lines

  /// More than a few short edges, on an input of this area.
  bool passes_over_much(double area_world) const { return passed_over_world > 2 * std::sqrt(area_world); }
};

struct StageTime {
  std::string stage;
  double ms;
};

/// What was given, and what was done to it before there was a grid.
struct InputReport {
  InputTopology topology;  ///< as given; of a resumed run, as repaired
  DirtCounts dirt;
  FarVertexReport far;
  RepairReport repair;
  UnionReport united;
};

/// The voxels.
struct GridReport {
  LatticeFrame frame;
  int32_t band_vox = 0, closing_vox = 0, grown_vox = 0;
  /// Leaves and active voxels of the shell, 0 when it was not built; active ones of the level set that a run ends with.
  int64_t sites = 0, leaves = 0, active_voxels = 0;
  int64_t memory_estimate_bytes = 0;  ///< of the largest grid that was tried; see memory_estimate.h
};

/// The closed surface that seeds move on.
struct SheetReport {
  int64_t vertices = 0;
  SheetTopology topology;
  bool is_compared = false;  ///< the input, as repaired, is closed and oriented
  bool agrees = false;       ///< components and genus of the sheet equal the input's
};

/// How many vertices the result has, and was to have.
struct CountReport {
  std::optional<int64_t> asked;  ///< none where lengths of edges decide
  int64_t made = 0;
  std::string why;  ///< there are not as many; empty where that is not known

  /// To a tenth.
  bool is_near() const { return !asked || 10 * std::abs(made - *asked) <= *asked; }
  bool is_met() const { return !asked || made == *asked; }
  /// Of a count that is not met, without a full stop.
  std::string words() const {
    return "the result has " + std::to_string(made) + " vertices instead of " + std::to_string(*asked) +
           (why.empty() ? "" : ": " + why);
  }
};

/// Everything measured on the way.
struct RemeshReport {
  InputReport input;
  GridReport grid;
  SheetReport sheet;
  int64_t seeds = 0;
  RelaxReport relax;
  DualReport dual;
  OptimizeReport optimize;                    ///< of the final mesh, when is_optimized
  bool is_optimized = false;                  ///< false when cells failed: nothing is improved then, nor tested for
                                              ///< intersections
  std::optional<WorldPoint> intersection_at;  ///< a corner of triangles that intersect in the result
  SizingReport sizing;
  GapReport gaps;
  FeatureReport features;
  CountReport count;
  CoherenceReport coherence;     ///< of a run with a frame before
  std::vector<StageTime> times;  ///< in order; a stage that ran more than once has one entry
  std::map<std::string, std::string> digests;
  std::vector<std::string> warnings;
};

}  // namespace isoshell
