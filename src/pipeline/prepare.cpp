// prepare (see remesh.h): repairs and unites what was given, chooses the grid, voxelises, builds the sheet. The grid is
// made finer while the sheet lacks the input's topology.
#include <algorithm>

#include "isoshell/error.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/remesh.h"
#include "isoshell/repair.h"
#include "pipeline/check_options.h"
#include "pipeline/choose_grid.h"
#include "pipeline/finer_grid.h"
#include "pipeline/joined_parts.h"
#include "pipeline/patches.h"
#include "pipeline/prepare_surface.h"
#include "pipeline/shown_parts.h"
#include "pipeline/sizing.h"
#include "pipeline/timed.h"
#include "repair/open_soup.h"

namespace isoshell {
namespace {

constexpr int32_t kCoarsestGrid = 8;

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

void finish(Prepared& p, const PatchSource& source, const RemeshOptions& options, RemeshReport& report,
            Context& context) {
  if (options.want_shell || options.method == Method::shell) {
    p.shell = timed(report, "shell", context, [&] { return build_shell(p.sites, {options.band_vox}, context); });
    report.active_voxels = p.shell.voxels.voxel_count();
    report.leaves = p.shell.voxels.leaf_count();
    note_digest(options, report, context, "shell", p.shell);
  }
  report.input = p.surface.topology;
  report.band_vox = options.band_vox;
  report_sheet(p, report);
  timed(report, "lengths", context, [&] { set_lengths(options, p, report, context); });
  cut_into_patches(options, source, p, report, context);
  note_digest(options, report, context, "surface", p.surface);
  note_digest(options, report, context, "sites", p.sites);
  note_digest(options, report, context, "samples", p.samples);
  note_digest(options, report, context, "sheet", p.sheet);
}

/// The grid on which the smallest cells are as wide as all are without lengths, less where memory does not allow it.
/// Lengths are first found on the grid that even cells would have.
int32_t resolution_for_lengths(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                               int32_t usual, RemeshReport& report, Context& context) {
  memory_allows(soup, input, options, usual, false, report, context);
  Prepared p = prepare_on_grid(soup, input, usual, options, report, context);
  RemeshReport unsaid;
  timed(report, "lengths", context, [&] { set_lengths(options, p, unsaid, context); });
  if (p.sheet.lengths.at.empty()) return usual;
  const double cell_world = smallest_cell_vox(options, p, context) * p.surface.frame.voxel_size;
  int32_t resolution = resolution_for_cell(p.surface.frame.voxel_size * (usual - 1), cell_world,
                                           vertex_target(options, input.area_world));
  while (resolution > usual && context.memory_limit_bytes > 0 &&
         estimate_run(soup, input, options, resolution).bytes > context.memory_limit_bytes)
    resolution = std::max(usual, resolution - resolution / 8);
  return resolution;
}

/// Finishes a sheet that does not show the input's topology where the run can take the input's own triangles, which
/// have it: no finer grid is needed then. Not where the shell is to show it, too, or another frame is followed, which
/// takes the sheet. Result: whether it can.
bool finish_on_own_triangles(Prepared& p, PatchSource source, const RemeshOptions& options, RemeshReport& report,
                             Context& context) {
  if (options.want_shell || options.method == Method::shell || options.previous) return false;
  source.only_own_triangles = true;
  RemeshReport tried = report;
  finish(p, source, options, tried, context);
  if (is_on_own_triangles(p)) {
    report = std::move(tried);
    return true;
  }
  p.cut = nullptr;
  report.times = std::move(tried.times);
  return false;
}

/// The coarsest grid whose sheet has the input's topology, or the one that comes nearest, or the first one on which
/// the run can take the input's own triangles: these need no sheet, but points that stay apart on the lattice. The soup
/// is that of `source`, repaired.
Prepared prepare_on_best_grid(const TriangleSoup& soup, const InputTopology& input, const PatchSource& source,
                              const RemeshOptions& options, RemeshReport& report, Context& context) {
  const auto [lo, hi] = bounding_box(soup);
  const bool free_grid = !options.resolution && !options.voxel_size_world;
  const int32_t usual = first_resolution(options, input.area_world, lo, hi);
  const int32_t first = free_grid && wants_lengths(options)
                            ? resolution_for_lengths(soup, input, options, usual, report, context)
                            : usual;
  memory_allows(soup, input, options, first, false, report, context);
  Prepared best = prepare_on_grid(soup, input, first, options, report, context);
  if (topology_gap(best) > 0 && may_refine(options, input)) {
    const auto is_finished = [&](Prepared& p) {
      return topology_gap(p) > 0 && finish_on_own_triangles(p, source, options, report, context);
    };
    if (is_finished(best)) return best;
    if (std::optional<Prepared> finer = finer_grid(soup, best, is_finished, options, report, context))
      best = std::move(*finer);
    if (is_on_own_triangles(best)) return best;
  }
  finish(best, source, options, report, context);
  if (!is_on_own_triangles(best)) warn_of_topology(best, input, options, report);
  return best;
}

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
  memory_allows(soup, given, options, kCoarsestGrid, false, report, context);  // repair comes first
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
  Prepared prepared = prepare_on_best_grid(*current, input, source, options, report, context);
  report.input = given;
  return prepared;
}

}  // namespace isoshell
