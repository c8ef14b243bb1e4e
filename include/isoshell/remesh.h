// The call most people need: a surface in, an isotropic closed mesh out. And the same in three steps, for those who
// keep or resume from the products between them.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/gaps.h"
#include "isoshell/polylines.h"
#include "isoshell/previous_frame.h"
#include "isoshell/repair.h"
#include "isoshell/sizing.h"

namespace isoshell {

enum class Method {
  sheet,  ///< clipped cells on the sheet, the default
  shell,  ///< the paper's Lloyd loop on shell voxels
};

/// Which edges of the input become edges of the result.
struct Features {
  enum class Creases {
    off,        ///< none: sharp edges are rounded off
    automatic,  ///< those of crisp parts, and none of a scan; none with the method shell
    threshold,  ///< all whose faces turn by `degrees` or more
  };
  Creases creases = Creases::automatic;
  double degrees = 0;                           ///< only of a threshold
  std::string line_file = {};                   ///< where a run reads `lines` from; remesh() itself reads no file
  std::shared_ptr<const Polylines> lines = {};  ///< become edges of the result, whatever the creases; null: none

  bool has_lines() const { return lines || !line_file.empty(); }
};

/// What becomes of the borders of a surface that is not closed.
enum class Boundary {
  close,  ///< narrow holes are capped or bridged, and the result is closed
  keep,   ///< borders wider than the gaps to close are borders of the result
};

/// What has no value is chosen by the run. The numbers that stood for that before, 0 or -1 by option, mean it still.
struct RemeshOptions {
  std::optional<int64_t> vertices = 10000;  ///< target count; without it as `sizing` asks for, or 10000
  std::optional<double> edge_length_world;  ///< target edge length, instead of `vertices`
  std::optional<int32_t> resolution;        ///< voxels along the longest side
  std::optional<double> voxel_size_world;   ///< instead of `resolution`
  int32_t band_vox = 2;                     ///< d
  std::optional<int32_t> closing_vox;       ///< r; without it 0 for a closed surface, else as much as closes leaks
  std::optional<double> closing_world;      ///< width of gaps to close, world units, instead of closing_vox
  Method method = Method::sheet;
  std::optional<int32_t> max_passes;   ///< of the finest level of seeds; without it the method's own
  std::optional<double> tolerance;     ///< relative fall of the energy a pass; without it the method's own
  std::optional<double> max_step_vox;  ///< u; without it the method's own
  uint64_t seed = 0;
  std::shared_ptr<const SizingField> sizing;  ///< edge lengths to aim at; null: the same everywhere
  double adaptivity = 0;                      ///< part of the vertices that goes by curvature, 0 to 1
  double gradation = 1.2;                     ///< most that an edge may be longer than its neighbours, above 1
  Fit fit = Fit::balanced;
  bool uniform_area = false;            ///< triangles of even size rather than of the best shape
  Features features;                    ///< a threshold needs the method sheet
  Boundary boundary = Boundary::close;  ///< keep needs the method sheet
  /// Names of the attributes that a run keeps; without a value all. Where texture coordinates, materials or groups that
  /// are kept jump, the result has edges. remesh() itself makes positions only.
  std::optional<std::vector<std::string>> attributes;
  /// The frame before this one of a sequence: vertices keep their numbers; null: there is none. Needs the method sheet.
  /// Where the surface is another than before, or cannot be meshed from there, the run begins as without it, and
  /// vertices get the numbers of those that lie nearest.
  std::shared_ptr<const PreviousFrame> previous = {};
  bool color_features = false;  ///< a run colours patches, curves and corners, and writes the curves' edges to PLY
  bool outer_only = false;      ///< drop what lies inside of a closed surface
  bool want_shell = false;      ///< build the shell even when the method does not need it, to keep it
  bool want_samples = true;     ///< keep Prepared::samples when the sheet is made, though it and no shell reads them
  bool want_digests = false;    ///< fill RemeshReport::digests
};

/// A curve of the input that the result does not have.
struct LostCurve {
  int64_t index = 0;        ///< among the curves that were found; of a line that was given its segment
  std::string kind;         ///< "crease", "seam", "line" or "border"
  double length_world = 0;  ///< along it
  WorldPoint at{0, 0, 0};   ///< where it begins
  std::string reason;
};

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
};

/// Walls that were nearer to one another than edges can follow, and became one: the last resort against intersections.
struct MergeReport {
  int32_t grown_vox = 0;   ///< walls there grew so far to each side; 0: none were merged
  int64_t places = 0;      ///< corners of triangles that intersected before
  WorldPoint at{0, 0, 0};  ///< one of them
};

struct StageTime {
  std::string stage;
  double ms;
};

/// Everything measured on the way.
struct RemeshReport {
  InputTopology input;  ///< as given; of a resumed run, as repaired
  DirtCounts dirt;
  RepairReport mend;
  UnionReport unite;
  JoinReport join;
  LatticeFrame frame;
  int32_t band_vox = 0, closing_vox = 0, grown_vox = 0;
  int64_t sites = 0, leaves = 0, active_voxels = 0;  ///< leaves and active voxels of the shell, 0 when it was not built
  int64_t sheet_vertices = 0, seeds = 0;
  SheetTopology sheet;
  bool topology_compared = false;  ///< the input, as repaired, is closed and oriented
  bool topology_agrees = false;    ///< components and genus of the sheet equal the input's
  RelaxReport relax;
  DualReport dual;
  OptimizeReport post;                      ///< of the final mesh, when post_done
  int64_t seeds_against_intersections = 0;  ///< put in where triangles intersected; others were taken out for them
  MergeReport merged;
  std::optional<WorldPoint> intersection_at;  ///< a corner of triangles that intersect in the result
  SizingReport sizing;
  GapReport gaps;
  FeatureReport features;
  CoherenceReport coherence;  ///< of a run with a frame before
  bool post_done = false;     ///< false when cells failed: nothing is improved then, nor tested for intersections
  int64_t memory_estimate_bytes = 0;  ///< of the finest grid that was begun; see memory_estimate.h
  std::vector<StageTime> times;       ///< in order; a stage that ran more than once has one entry
  std::map<std::string, std::string> digests;
  std::vector<std::string> warnings;
};

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
struct RelaxedMeanwhile;

/// Products up to the sheet.
struct Prepared {
  LatticeSurface surface;
  SiteSet sites;
  SiteSamples samples;  ///< empty where want_samples, the shell and digests let them go
  Shell shell;          ///< empty unless the method or want_shell asks for it
  Sheet sheet;          ///< with edge lengths where they vary
  int32_t closing_vox = 0;
  std::optional<int64_t> vertices;  ///< as many as the sizing field asks for; without it as the options say
  std::shared_ptr<const PreviousFrame> previous;  ///< that of the options, where the run begins with it
  GrownSolid grown;                               ///< for the stages that follow
  std::shared_ptr<CreaseSearch> creases;          ///< looked for while a device makes the sheet
  std::shared_ptr<const CutSurface> cut;      ///< the input's own triangles in patches; null where no features are kept
  std::shared_ptr<RelaxedMeanwhile> relaxed;  ///< on a device while creases were looked for, in case there are none
};

/// Repairs the faces of an input that is not closed and oriented; holes are capped unless a closing is asked for.
/// Unites the components of one that is: what lies in solid goes, surfaces of hollows stay unless only outer ones are
/// wanted. Then chooses the grid, voxelises, builds the sheet. For a closed, oriented input the grid is refined by
/// halves until the sheet's components and genus are the input's, at most to four times the first choice (never beyond
/// a given resolution), or until two finer grids in a row brought nothing. Throws: nothing_to_mesh, usage,
/// out_of_memory, interrupted.
Prepared prepare(const TriangleSoup& soup, const RemeshOptions& options, RemeshReport& report, Context& context);
/// The same from a surface that is on its lattice already, with the closing that was chosen for it: a resumed run.
Prepared prepare(LatticeSurface surface, int32_t closing_vox, const RemeshOptions& options, RemeshReport& report,
                 Context& context);
/// Places and relaxes the seeds.
SeedSet relax(const Prepared& prepared, const RemeshOptions& options, RemeshReport& report, Context& context);
/// Dual, repair and the final mesh. Repair may add seeds and drop others to keep the count; ids then change.
TriangleMesh triangulate(const Prepared& prepared, SeedSet& seeds, const RemeshOptions& options, RemeshReport& report,
                         Context& context);

struct RemeshResult {
  TriangleMesh mesh;
  RemeshReport report;
};

/// Algorithm 1 of the paper: prepare, relax, triangulate.
RemeshResult remesh(const TriangleSoup& soup, const RemeshOptions& options, Context& context);

}  // namespace isoshell
