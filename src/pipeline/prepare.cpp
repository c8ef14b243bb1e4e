// prepare (see remesh.h): repairs and unites what was given, chooses the grid, voxelises, builds the sheet. The grid is
// made finer while the sheet lacks the input's topology.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "core/copy_product.h"
#include "isoshell/error.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/remesh.h"
#include "isoshell/repair.h"
#include "options/check_options.h"
#include "pipeline/grid/choose_grid.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/timed.h"
#include "pipeline/joined_parts.h"
#include "pipeline/patches/patches.h"
#include "pipeline/patches/sheet_when_needed.h"
#include "pipeline/sheet/prepare_surface.h"
#include "pipeline/sheet/warm_start.h"
#include "repair/holes/open_soup.h"

namespace isoshell {
namespace {

constexpr int32_t kCoarsestGrid = 8;

/// None when the run finds it.
std::optional<int32_t> asked_closing(const RemeshOptions& options, const InputTopology& input,
                                     const LatticeFrame& frame) {
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
  return !options.closing_vox && input.closed ? 0 : options.closing_vox;
}

/// A surface of slivers alone gives a sheet around a line, not a mesh that anyone asked for.
void check_area(const InputTopology& input) {
  if (!(input.area_world > 0))
    throw Error(ErrorCode::nothing_to_mesh, "topology",
                "no face has an area: the surface is a line or a point; give one with faces that span an area");
}

/// Edge of a voxel of the first grid.
double voxel_edge(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options) {
  const auto [lo, hi] = bounding_box(soup);
  return LatticeFrame::around(lo, hi, first_resolution(options, input.area_world, lo, hi)).voxel_size;
}

/// Of faces that were cut: closed, whatever their edges say, and of a genus that nobody knows.
InputTopology topology_of_union(InputTopology input, const UnionReport& unite) {
  input.closed = input.oriented = true;
  input.components = unite.joined_components;
  input.genus = -1;
  return input;
}

/// False when a refinement does not fit the memory limit, which is only worth a warning. Throws when nothing was made
/// yet.
bool memory_allows(const RunEstimate& estimate, bool refining, RemeshReport& report, const Context& context) {
  if (context.memory_limit_bytes <= 0 || estimate.bytes <= context.memory_limit_bytes) {
    report.memory_estimate_bytes = std::max(report.memory_estimate_bytes, estimate.bytes);
    return true;
  }
  const std::string what = "resolution " + std::to_string(estimate.resolution) + " needs about " +
                           std::to_string(estimate.bytes >> 20) + " MiB, more than the limit of " +
                           std::to_string(context.memory_limit_bytes >> 20) + " MiB";
  if (!refining) {
    const char* remedy = estimate.resolution > kCoarsestGrid ? "; lower --resolution or raise --max-memory"
                                                             : ", which its faces take; raise --max-memory";
    throw Error(ErrorCode::out_of_memory, "memory", what + remedy);
  }
  report.warnings.push_back("the grid was not refined further: " + what);
  return false;
}

void note_digests(const Prepared& p, const RemeshOptions& options, RemeshReport& report, Context& context) {
  note_digest(options, report, context, "surface", p.surface);
  if (!has_sheet(p)) return;
  note_digest(options, report, context, "sites", p.sites);
  note_digest(options, report, context, "samples", p.samples);
  note_digest(options, report, context, "sheet", p.sheet);
}

void report_surface(const Prepared& p, const RemeshOptions& options, RemeshReport& report) {
  report.input = p.surface.topology;
  report.frame = p.surface.frame;
  report.band_vox = options.band_vox;
  report_sheet(p, report);
}

void finish(Prepared& p, const PatchSource& source, const RemeshOptions& options, RemeshReport& report,
            Context& context) {
  if (options.want_shell || options.method == Method::shell) {
    p.shell = timed(report, "shell", context, [&] { return build_shell(p.sites, {options.band_vox}, context); });
    report.active_voxels = p.shell.voxels.voxel_count();
    report.leaves = p.shell.voxels.leaf_count();
    note_digest(options, report, context, "shell", p.shell);
  }
  report_surface(p, options, report);
  timed(report, "lengths", context, [&] { set_lengths(options, p, report, context); });
  if (wants_lengths(options)) choose_beginning(options, vertex_target(options, p), p, report);
  cut_into_patches(options, source, p, report, context);
  note_digests(p, options, report, context);
}

/// Width of the smallest cells that the lengths ask for, as far as the grid that even cells would have carries them.
/// They are looked for on that grid, but curvature asks for the smallest ones anyway. None where lengths are even.
std::optional<double> smallest_cell_world(const TriangleSoup& soup, const InputTopology& input,
                                          const RemeshOptions& options, const LatticeFrame& usual, RemeshReport& report,
                                          Context& context) {
  if (options.adaptivity > 0) return kFewestCellVox * usual.voxel_size;
  LatticeSurface surface = timed(report, "snap", context, [&] { return snap_surface(soup, usual, context); });
  surface.topology = input;
  Prepared p = prepare_surface(std::move(surface), asked_closing(options, input, usual), options, report, context);
  RemeshReport unsaid;
  timed(report, "lengths", context, [&] { set_lengths(options, p, unsaid, context); });
  if (p.sheet.lengths.at.empty()) return {};
  return smallest_cell_vox(options, p, context) * usual.voxel_size;
}

/// The grid on which the smallest cells are as wide as all are without lengths, less where memory does not allow it.
int32_t resolution_for_lengths(const TriangleSoup& soup, const WorldBox& box, const InputTopology& input,
                               const RemeshOptions& options, int32_t usual, RemeshReport& report, Context& context) {
  memory_allows(estimate_run(soup, box, input, options, usual), false, report, context);
  const LatticeFrame frame = LatticeFrame::around(box.min, box.max, usual);
  const std::optional<double> cell_world = smallest_cell_world(soup, input, options, frame, report, context);
  if (!cell_world) return usual;
  int32_t resolution =
      resolution_for_cell(frame.voxel_size * (usual - 1), *cell_world, vertex_target(options, input.area_world));
  while (resolution > usual && context.memory_limit_bytes > 0 &&
         estimate_run(soup, box, input, options, resolution).bytes > context.memory_limit_bytes)
    resolution = std::max(usual, resolution - resolution / 8);
  return resolution;
}

/// Sheets of a surface on finer and finer grids.
class GridSearch {
 public:
  /// The soup is that of `source`, repaired.
  GridSearch(const TriangleSoup& soup, const WorldBox& box, const InputTopology& input, const PatchSource& source,
             const RemeshOptions& options, RemeshReport& report, Context& context)
      : soup_(soup), box_(box), input_(input), source_(source), options_(options), report_(report), context_(context) {}

  /// The coarsest grid whose sheet has the input's topology, or the one that comes nearest.
  Prepared best_grid() {
    const bool free_grid = !options_.resolution && !options_.voxel_size_world;
    const int32_t usual = first_resolution(options_, input_.area_world, box_.min, box_.max);
    const int32_t first = free_grid && wants_lengths(options_)
                              ? resolution_for_lengths(soup_, box_, input_, options_, usual, report_, context_)
                              : usual;
    // Where the vertices cannot show the input's topology, a finer grid only brings more parts for them to miss.
    const bool reachable = can_compare(input_) && shows_all_parts(options_, input_);
    const int32_t cap = free_grid && reachable ? std::max(first, std::min(4 * usual, kMaxResolution)) : first;
    const bool had_curves = options_.previous && options_.previous->had_curves;
    if (had_curves && allows(first, false))
      if (std::optional<Prepared> cut = cut_at_once(snapped(first))) return std::move(*cut);
    Prepared best;
    int64_t best_gap = INT64_MAX;
    int fruitless = 0;
    for (int32_t resolution = first; resolution <= cap && best_gap > 0 && fruitless < 2;
         resolution += std::max(1, resolution / 2)) {
      const bool is_refining = best_gap < INT64_MAX;
      if (!allows(resolution, is_refining)) break;
      std::optional<Prepared> p = with_sheet(snapped(resolution), is_refining);
      if (!p) break;
      const int64_t gap = topology_gap(*p);
      if (gap > 0 && !is_refining && !had_curves)
        if (std::optional<Prepared> cut = cut_at_once(host_copy(p->surface))) return std::move(*cut);
      fruitless = gap < best_gap ? 0 : fruitless + 1;
      if (gap < best_gap) {
        best_gap = gap;
        best = std::move(*p);
      }
    }
    finish(best, source_, options_, report_, context_);
    if (!is_on_own_triangles(best)) warn_of_topology(best, input_, options_, report_);
    return best;
  }

 private:
  bool allows(int32_t resolution, bool is_refining) {
    return memory_allows(estimate_run(soup_, box_, input_, options_, resolution), is_refining, report_, context_);
  }

  LatticeSurface snapped(int32_t resolution) {
    const LatticeFrame frame = LatticeFrame::around(box_.min, box_.max, resolution);
    LatticeSurface surface = timed(report_, "snap", context_, [&] { return snap_surface(soup_, frame, context_); });
    surface.topology = input_;
    return surface;
  }

  /// A frame that keeps its curves takes the first grid. None where it is no such frame.
  std::optional<Prepared> cut_at_once(LatticeSurface surface) {
    if (!may_be_cut_at_once(options_, input_, surface.first_cap != kNone)) return {};
    std::optional<Prepared> p = prepare_patches_alone(std::move(surface), options_, source_, report_, context_);
    if (!p) return {};
    report_surface(*p, options_, report_);
    note_digests(*p, options_, report_, context_);
    return p;
  }

  /// None where a finer grid takes more memory than there is: what is there is better than nothing.
  std::optional<Prepared> with_sheet(LatticeSurface surface, bool is_refining) {
    const std::optional<int32_t> closing_vox = asked_closing(options_, input_, surface.frame);
    try {
      return prepare_surface(std::move(surface), closing_vox, options_, report_, context_);
    } catch (const Error& error) {
      if (error.code() != ErrorCode::out_of_memory || !is_refining) throw;
      report_.warnings.push_back(std::string("the grid was not refined further: ") + error.what());
      return {};
    }
  }

  const TriangleSoup& soup_;
  const WorldBox& box_;
  const InputTopology& input_;
  const PatchSource& source_;
  const RemeshOptions& options_;
  RemeshReport& report_;
  Context& context_;
};

/// Borders that are kept are those wider than the gaps that were asked to be closed; where nothing was, those of no
/// holes.
TriangleSoup repaired(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                      RepairReport& report) {
  const bool is_chosen = !options.closing_vox && !options.closing_world;
  if (options.boundary == Boundary::close || is_chosen) return repair_soup(soup, {is_chosen}, report);
  const double widest_gap_world =
      options.closing_world ? *options.closing_world : 2. * *options.closing_vox * voxel_edge(soup, input, options);
  return repair::repair_open_soup(soup, widest_gap_world, report);
}

}  // namespace

Prepared prepare(LatticeSurface surface, int32_t closing_vox, const RemeshOptions& asked, RemeshReport& report,
                 Context& context) {
  const RemeshOptions options = checked(asked);
  std::optional<int32_t> closing;
  if (closing_vox >= 0) closing = closing_vox;
  Prepared p = prepare_surface(std::move(surface), closing, options, report, context);
  finish(p, {}, options, report, context);
  return p;
}

Prepared prepare(const TriangleSoup& soup, const RemeshOptions& asked, RemeshReport& report, Context& context) {
  const RemeshOptions options = with_even_length(checked(asked), soup);
  const SoupTopology measured = timed(report, "topology", context, [&] { return measure_topology(soup, context); });
  const InputTopology& given = measured.topology;
  report.dirt = measured.dirt;
  check_area(given);
  const WorldBox box = bounding_box(soup);
  memory_allows(estimate_run(soup, box, given, options, kCoarsestGrid), false, report, context);  // repair comes first
  TriangleSoup changed;
  const TriangleSoup* current = &soup;
  InputTopology input = given;
  const auto measure = [&] { return measure_topology(*current, context).topology; };
  PatchSource source{&soup, {}};
  int64_t cut_faces = 0;
  const auto take = [&](JoinedParts&& joined) {
    changed = std::move(joined.soup);
    source.interfaces = std::move(joined.interfaces);
    cut_faces = joined.cut_faces;
    current = &changed;
    input = joined.topology;
  };
  if (std::optional<JoinedParts> joined = join_parts(soup, measured, false, report, context)) {
    take(std::move(*joined));
  } else if (!given.closed || !given.oriented) {
    changed = timed(report, "mend", context, [&] { return repaired(soup, given, options, report.mend); });
    current = &changed;
    const SoupTopology left = timed(report, "topology", context, [&] { return measure_topology(changed, context); });
    input = left.topology;
    if (auto mended = join_parts(changed, left, options.boundary == Boundary::keep, report, context))
      take(std::move(*mended));
  }
  if (input.closed && input.oriented && input.components > 1) {
    const UnionOptions union_options{options.outer_only, voxel_edge(*current, input, options) / 2};
    TriangleSoup united =
        timed(report, "unite", context, [&] { return boolean_union(*current, union_options, report.unite, context); });
    if (report.unite.changed_anything()) {
      changed = std::move(united);
      current = &changed;
      input = timed(report, "topology", context, measure);
      if (report.unite.cut_faces > 0) input = topology_of_union(input, report.unite);
      if (report.unite.cut_faces > 0 && cut_faces == 0 && report.join.given_up.empty())
        report.join.given_up = source.interfaces.empty() ? "fewer than two of them look outward" : "others share walls";
    }
  }
  report.unite.cut_faces += cut_faces;
  if (cut_faces > 0 && report.unite.joined_components == 0) report.unite.joined_components = input.components;
  const WorldBox current_box = current == &soup ? box : bounding_box(changed);
  Prepared prepared = GridSearch(*current, current_box, input, source, options, report, context).best_grid();
  report.input = given;
  return prepared;
}

}  // namespace isoshell
