// prepare (see remesh.h): has the input repaired and united, chooses the grid, voxelises, builds the sheet. Where that
// lacks the input's topology, its own triangles are meshed, and if that cannot be, the grid is made finer.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/copy_product.h"
#include "geometry/given_surface.h"
#include "isoshell/error.h"
#include "isoshell/part_regions.h"
#include "isoshell/remesh.h"
#include "isoshell/repair.h"
#include "options/check_options.h"
#include "pipeline/grid/memory_estimate.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/regions/region_walls.h"
#include "pipeline/repaired_input.h"
#include "pipeline/sheet/prepare_surface.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

constexpr double kNeedleVoxelsPerVertex = 1.1;  ///< along it: grown by two to each side its cells are 4.5 voxels wide

/// None when the run finds it.
std::optional<int32_t> requested_closing(const Plan& plan, const LatticeFrame& frame) {
  const RemeshOptions& options = plan.options;
  if (options.closing_world) {
    const double r = std::ceil(*options.closing_world / frame.voxel_size / 2);
    if (r > kMaxClosingVox && options.boundary == Boundary::keep) return kMaxClosingVox;  // caps close wider gaps
    if (r > kMaxClosingVox) {
      std::ostringstream text;
      text << "a gap of " << *options.closing_world << " is " << 2 * r << " voxels wide on this grid; at most "
           << 2 * kMaxClosingVox << " can be closed: lower the resolution";
      throw Error(ErrorCode::usage, "close-gaps", text.str());
    }
    return int32_t(r);
  }
  return !options.closing_vox && plan.input.closed ? 0 : options.closing_vox;
}

/// A surface of slivers alone gives a sheet around a line, not a mesh that anyone asked for.
void check_area(const InputTopology& input) {
  if (!(input.area_world > 0))
    throw Error(ErrorCode::nothing_to_mesh, "topology",
                "no face has an area: the surface is a line or a point; give one with faces that span an area");
}

/// False when a refinement does not fit the memory limit, which is only worth a warning. Throws when nothing was made
/// yet.
bool memory_allows(const RunEstimate& estimate, bool refining, Run& run) {
  const int64_t limit = run.context.memory_limit_bytes;
  if (limit <= 0 || estimate.bytes <= limit) {
    run.memory_estimate_bytes = std::max(run.memory_estimate_bytes, estimate.bytes);
    return true;
  }
  const std::string what = over_memory_limit(estimate, limit);
  if (!refining) throw Error(ErrorCode::out_of_memory, "memory", what);
  run.warn("the grid was not refined further: " + what);
  return false;
}

void note_digests(const PreparedSurface& p, Run& run) {
  run.note_digest("surface", p.surface);
  if (!has_sheet(p)) return;
  run.note_digest("sites", p.sites);
  run.note_digest("samples", p.samples);
  run.note_digest("sheet", p.sheet);
}

void report_surface(PreparedSurface& p) {
  p.report.input.topology = p.surface.topology;
  p.report.grid.frame = p.surface.frame;
  p.report.grid.band_vox = p.options.band_vox;
  report_sheet(p);
}

void finish(PreparedSurface& p, const PatchSource& source, Run& run) {
  const RemeshOptions& options = p.options;
  if (options.want_shell || options.method == Method::shell) {
    p.shell = run.timed("shell", [&] { return build_shell(p.sites, {options.band_vox}, run.context); });
    p.report.grid.active_voxels = p.shell.voxels.voxel_count();
    p.report.grid.leaves = p.shell.voxels.leaf_count();
    run.note_digest("shell", p.shell);
  }
  report_surface(p);
  for (std::string& text : run.timed("lengths", [&] { return set_lengths(p, run.context); })) run.warn(std::move(text));
  if (wants_lengths(options)) p.report.coherence.why_cold = choose_beginning(p);
  cut_into_patches(source, p, run);
  note_digests(p, run);
}

std::shared_ptr<const TriangleSoup> positions_and_triangles(const TriangleSoup& soup) {
  TriangleSoup copy;
  copy.vertices = soup.vertices;
  copy.triangles = soup.triangles;
  return std::make_shared<const TriangleSoup>(std::move(copy));
}

Prepared held(PreparedSurface p, Run& run) {
  run.exchange_log(p.report);
  return PreparedParts::hold(std::move(p));
}

/// Finishes a closed surface on its own triangles, with curves or none, where its sheet lacks its components or
/// handles. False where that is not so or cannot be done: nothing is told of it then.
bool finish_on_own_triangles(PreparedSurface& p, const PatchSource& source, Run& run) {
  if (topology_gap(p) == 0 || !may_be_on_own_triangles(p)) return false;
  const size_t warnings = run.warnings.size();
  const int64_t bytes = run.memory_estimate_bytes;
  p.needs_own_triangles = true;
  finish(p, source, run);
  if (is_on_own_triangles(p)) return true;
  p.needs_own_triangles = p.own_faces_meet = false;
  p.cut.reset();
  p.report.features = {};
  run.warnings.resize(warnings);
  run.memory_estimate_bytes = bytes;
  return false;
}

/// Sheets of a surface on finer and finer grids.
class GridSearch {
 public:
  /// The soup is that of `source`, repaired.
  GridSearch(const TriangleSoup& soup, const Plan& plan, const PatchSource& source, Run& run)
      : soup_(soup), plan_(plan), source_(source), run_(run), context_(run.context) {}

  /// The coarsest grid whose sheet has the input's topology, or the one that comes nearest.
  PreparedSurface best_grid() {
    const int32_t by_area = plan_.first_resolution(), usual = resolution_for_needle(by_area);
    const int32_t first = plan_.chooses_grid() && wants_lengths(plan_.options) && usual == by_area
                              ? resolution_for_lengths(usual)
                              : usual;
    // Where the vertices cannot show the input's topology, a finer grid only brings more parts for them to miss.
    const bool reachable = can_compare(plan_.input) && shows_all_parts(plan_.target.vertices, plan_.input);
    const int32_t cap =
        plan_.chooses_grid() && reachable ? std::max(first, std::min(4 * usual, kMaxResolution)) : first;
    const bool had_curves = plan_.options.previous && plan_.options.previous->had_curves;
    if (had_curves && allows(first, false))
      if (std::optional<PreparedSurface> cut = cut_at_once(snapped(first))) return std::move(*cut);
    PreparedSurface best;
    int64_t best_gap = INT64_MAX;
    int fruitless = 0;
    for (int32_t resolution = first; resolution <= cap && best_gap > 0 && fruitless < 2;
         resolution += std::max(1, resolution / 2)) {
      const bool is_refining = best_gap < INT64_MAX;
      if (!allows(resolution, is_refining)) break;
      std::optional<PreparedSurface> p = with_sheet(snapped(resolution), is_refining);
      if (!p) break;
      const int64_t gap = topology_gap(*p);
      if (gap > 0 && !is_refining && plan_.options.previous && !had_curves)
        if (std::optional<PreparedSurface> cut = cut_at_once(host_copy(p->surface))) return std::move(*cut);
      if (!is_refining && finish_on_own_triangles(*p, source_, run_)) return std::move(*p);
      fruitless = gap < best_gap ? 0 : fruitless + 1;
      if (gap < best_gap) {
        best_gap = gap;
        best = std::move(*p);
      }
    }
    finish(best, source_, run_);
    if (!is_on_own_triangles(best)) warn_of_topology(best, plan_.input, run_);
    return best;
  }

 private:
  bool allows(int32_t resolution, bool is_refining) {
    return memory_allows(estimate_plan(plan_, soup_, resolution), is_refining, run_);
  }

  /// Width of the smallest cells that the lengths ask for, as far as the grid that even cells would have carries them.
  /// They are looked for on that grid, but curvature asks for the smallest ones anyway. None where lengths are even.
  std::optional<double> smallest_cell_world(int32_t usual, double voxel_size) {
    if (plan_.options.adaptivity > 0) return kFewestCellVox * voxel_size;
    PreparedSurface p = *with_sheet(snapped(usual), false);
    run_.timed("lengths", [&] { set_lengths(p, context_); });
    if (p.sheet.lengths.at.empty()) return {};
    return smallest_cell_vox(p, context_) * voxel_size;
  }

  /// The grid on which the smallest cells are as wide as all are without lengths, less where memory does not allow it.
  int32_t resolution_for_lengths(int32_t usual) {
    allows(usual, false);
    const double voxel_size = plan_.frame(usual).voxel_size;
    const std::optional<double> cell_world = smallest_cell_world(usual, voxel_size);
    if (!cell_world) return usual;
    int32_t resolution = resolution_for_cell(voxel_size * (usual - 1), *cell_world, plan_.target.vertices);
    while (resolution > usual && context_.memory_limit_bytes > 0 &&
           estimate_plan(plan_, soup_, resolution).bytes > context_.memory_limit_bytes)
      resolution = std::max(usual, resolution - resolution / 8);
    return resolution;
  }

  /// Of a needle, far thinner than a voxel, the grid on which its walls, grown, have room for the vertices, and no
  /// finer one; of all else the resolution that is given. The voxels that hold a needle are about as many as it is
  /// long, those that hold other surfaces as many as their area.
  int32_t resolution_for_needle(int32_t resolution) {
    const double voxel = plan_.frame(resolution).voxel_size;
    const double area_vox = plan_.input.area_world / (voxel * voxel);
    if (!plan_.chooses_grid() || area_vox > 2 * resolution || !allows(resolution, false)) return resolution;
    const auto sites =
        double(run_.timed("voxelize", [&] { return voxelize(snapped(resolution), context_).voxels.voxel_count(); }));
    if (area_vox > sites / 2) return resolution;
    const double wanted = kNeedleVoxelsPerVertex * double(plan_.target.vertices) / sites * resolution;
    return int32_t(std::clamp<double>(wanted, std::min(kMinDefaultResolution, resolution), resolution));
  }

  LatticeSurface snapped(int32_t resolution) {
    LatticeSurface surface = run_.timed("snap", [&] { return snap_surface(soup_, plan_.frame(resolution), context_); });
    surface.topology = plan_.input;
    return surface;
  }

  /// A frame that keeps its curves takes the first grid. None where it is no such frame.
  std::optional<PreparedSurface> cut_at_once(LatticeSurface surface) {
    if (!may_be_cut_at_once(plan_, surface.first_cap != kNone)) return {};
    std::optional<PreparedSurface> p = prepare_patches_alone(std::move(surface), plan_.options, source_, run_);
    if (!p) return {};
    report_surface(*p);
    note_digests(*p, run_);
    return p;
  }

  /// None where a finer grid takes more memory than there is: what is there is better than nothing.
  std::optional<PreparedSurface> with_sheet(LatticeSurface surface, bool is_refining) {
    const std::optional<int32_t> closing_vox = requested_closing(plan_, surface.frame);
    try {
      return prepare_surface(std::move(surface), closing_vox, plan_.options, run_);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::out_of_memory || !is_refining) throw;
      run_.warn(std::string("the grid was not refined further: ") + error.what());
      return {};
    }
  }

  const TriangleSoup& soup_;
  const Plan& plan_;
  const PatchSource& source_;
  Run& run_;
  Context& context_;
};

void refuse_region_lengths(const RemeshOptions& options) {
  if (!options.region_edge_lengths.empty())
    throw Error(ErrorCode::usage, "regions",
                "--region-edge-length is for volumes of labels, and meshes with regions; leave it out");
}

Prepared prepare_walls(const TriangleSoup& walls, const RemeshOptions& options, const FarVertexReport& far, Run& run) {
  PreparedSurface p = prepare_regions(walls, with_even_length(options, walls), run);
  p.report.input.far = far;
  return held(std::move(p), run);
}

}  // namespace

Prepared prepare(LatticeSurface surface, int32_t closing_vox, const RemeshOptions& options, Context& context) {
  refuse_region_lengths(options);
  Run run{context, options.want_digests};
  std::optional<int32_t> closing;
  if (closing_vox >= 0) closing = closing_vox;
  PreparedSurface p = prepare_surface(std::move(surface), closing, checked(options), run);
  const bool keeps_curves = options.features.creases != Features::Creases::off;  // as who kept the lattice had them
  if (!keeps_curves || !finish_on_own_triangles(p, {}, run)) finish(p, {}, run);
  return held(std::move(p), run);
}

Prepared prepare(const TriangleSoup& given_soup, const RemeshOptions& requested, Context& context) {
  Run run{context, requested.want_digests};
  const RemeshOptions given_options = checked(requested);
  const std::optional<TriangleSoup> pulled = pull_back_far_vertices(given_soup, given_options, context);
  const TriangleSoup& soup = pulled ? *pulled : given_soup;
  if (!given_options.regions.empty()) {
    PartRegions found =
        run.timed("regions", [&] { return find_part_regions(soup, part_options(given_options, soup), context); });
    run.warnings = std::move(found.warnings);
    return prepare_walls(found.walls, given_options, soup.far, run);
  }
  if (!soup.regions.empty()) return prepare_walls(soup, given_options, soup.far, run);
  const RemeshOptions options = with_even_length(given_options, soup);
  refuse_region_lengths(options);
  const SoupTopology measured = run.timed("topology", [&] { return measure_topology(soup, context); });
  check_area(measured.topology);
  const Plan given = plan_of(options, measured.topology, bounding_box(soup));
  memory_allows(estimate_plan(given, soup, kCoarsestGrid), false, run);  // repair comes first
  const RepairedInput input = repair_and_unite(soup, measured, given, run);
  const TriangleSoup& meshed = input.soup(soup);
  const Plan plan = plan_of(options, input.topology, input.is_changed() ? bounding_box(meshed) : given.box);
  PreparedSurface p = GridSearch(meshed, plan, {&soup, input.interfaces}, run).best_grid();
  if (options.level_set_band_vox > 0) p.exact = positions_and_triangles(meshed);
  p.report.input = {measured.topology, measured.dirt, soup.far, input.repair, input.united};
  return held(std::move(p), run);
}

Prepared prepare(const TriangleMesh& mesh, const RemeshOptions& options, Context& context) {
  return prepare(surface_of(mesh), options, context);
}

}  // namespace isoshell
