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
#include "isoshell/to_host.h"
#include "pipeline/check_options.h"
#include "pipeline/choose_grid.h"
#include "pipeline/crease_search.h"
#include "pipeline/flaps.h"
#include "pipeline/joined_parts.h"
#include "pipeline/patches.h"
#include "pipeline/shown_parts.h"
#include "pipeline/sizing.h"
#include "pipeline/thin_walls.h"
#include "pipeline/timed.h"
#include "repair/hollows.h"
#include "repair/joined_components.h"
#include "repair/open_soup.h"

namespace isoshell {
namespace {

constexpr int32_t kMaxAutoClosingVox = 4;
constexpr int32_t kCoarsestGrid = 8;
constexpr double kSidesOfCrust = 0.75;  ///< of the area of both sides; a solid shows half of it

/// Sites, samples and sheet of a surface, with the closing that is asked for or found.
class Preparation {
 public:
  Preparation(const RemeshOptions& options, RemeshReport& report, Context& context)
      : options_(options), report_(report), context_(context) {}

  Prepared from(LatticeSurface surface, std::optional<int32_t> closing_vox) {
    Prepared p;
    p.surface = std::move(surface);
    p.creases = begin_crease_search(options_, p.surface, report_, context_);
    p.sites = timed(report_, "voxelize", context_, [&] { return voxelize(p.surface, context_); });
    p.samples = timed(report_, "samples", context_, [&] { return sample_sites(p.surface, p.sites, context_); });
    const bool shows_handles = shows_most_handles(options_, p.surface.topology);
    join_components(p);
    mark_hollows(p);
    if (!shows_handles) {
      const int32_t grown = growth_for_edge(edge_vox(p));
      p.closing_vox = 2 * grown;
      grow(p, grown);
      return p;
    }
    if (closing_vox) {
      p.closing_vox = *closing_vox;
      p.sheet = sheet(p, p.closing_vox);
    } else {
      close_leaks(p);
    }
    const bool is_open = !p.surface.topology.closed;
    if (is_open && is_crust(p))
      keep_sides_apart(p);
    else if (is_open || p.surface.first_cap != kNone)  // a flap's cap may lie on it
      thicken_flaps(p);
    return p;
  }

 private:
  /// Surfaces that pass through each other bound one solid, whose genus none of them tells.
  void join_components(Prepared& p) {
    InputTopology& input = p.surface.topology;
    if (input.genus < 0 || input.components < 2) return;
    const int64_t joins =
        timed(report_, "topology", context_, [&] { return count_joins(*OnHost(p.surface), *OnHost(p.samples)); });
    if (joins == 0) return;
    input.components -= joins;
    input.genus = -1;
  }

  /// What inner surfaces bound is open to the outside, as it were.
  void mark_hollows(Prepared& p) {
    const InputTopology& input = p.surface.topology;
    if (!input.closed || !input.oriented || input.components < 2) return;
    const std::vector<Voxel> hollows = timed(report_, "hollows", context_, [&] {
      return find_hollows(*OnHost(p.surface), *OnHost(p.sites), *OnHost(p.samples));
    });
    if (hollows.empty()) return;
    p.sites = to_host(p.sites);
    p.sites.hollows = Buffer<Voxel>(int64_t(hollows.size()));
    std::copy(hollows.begin(), hollows.end(), p.sites.hollows.begin());
  }

  double edge_vox(const Prepared& p) const {
    return usual_edge_length(options_, p.surface.topology.area_world) / p.surface.frame.voxel_size;
  }

  /// Of what the sheet bounds, on average.
  double thickness_vox(const Sheet& sheet) const {
    const double voxel = sheet.frame.voxel_size, area_vox = sheet_area_world(sheet) / (voxel * voxel);
    return double(six_volume_vox(sheet, context_)) / 3 / area_vox;
  }

  /// Whether the outside reaches both sides of the surface. Closing fills parts of a crust, but makes it no solid: that
  /// would hide one of the two sides.
  bool is_crust(const Prepared& p) {
    const double here = thickness_vox(p.sheet);
    if (here < 1) return true;
    if (here >= std::min(edge_vox(p) / 2, 2. * p.closing_vox + 1)) return false;
    const Sheet open = sheet(p, 0);
    if (here < 2 * thickness_vox(open)) return true;
    return sheet_area_world(p.sheet) > kSidesOfCrust * sheet_area_world(open);
  }

  /// Where the outside reaches both sides of an open surface, they would lie on each other and cross. Growth must not
  /// close what no one asked to close.
  void keep_sides_apart(Prepared& p) {
    int32_t grown = growth_for_edge(std::sqrt(2) * edge_vox(p));  // both sides share the vertices
    for (;; grown /= 2) {
      grow(p, grown);
      if (grown == 1 || thickness_vox(p.sheet) < 2 * grown + 3) return;
    }
  }

  /// A solid whose false handles were cut is no longer that of its sites, and stays as it is.
  void thicken_flaps(Prepared& p) {
    if (p.sheet.topology.cut_handles > 0) return;
    const double edge_vox = usual_edge_length(options_, sheet_area_world(p.sheet)) / p.surface.frame.voxel_size;
    const int64_t smallest = smallest_component_q16(options_, p.surface.topology, p.surface.frame);
    timed(report_, "sheet", context_, [&] { return grow_flaps(p, growth_for_edge(edge_vox), smallest, context_); });
  }

  void grow(Prepared& p, int32_t grown_vox) {
    const int64_t smallest = smallest_component_q16(options_, p.surface.topology, p.surface.frame);
    timed(report_, "sheet", context_, [&] { grow_solid(p, grown_vox, smallest, context_); });
  }

  Sheet sheet(const Prepared& p, int32_t closing_vox) {
    const InputTopology& input = p.surface.topology;
    const int64_t smallest = smallest_component_q16(options_, input, p.surface.frame);
    const int64_t genus = !input.closed || !input.oriented ? kNoGenus : input.genus < 0 ? kUnknownGenus : input.genus;
    return timed(report_, "sheet", context_, [&] {
      return build_sheet(p.surface, p.sites, p.samples, {closing_vox, smallest, genus}, context_);
    });
  }

  /// The smallest closing whose solid holds nine tenths of what the largest one holds: below it the outside leaks in
  /// and the solid collapses to a crust.
  void close_leaks(Prepared& p) {
    Sheet widest = sheet(p, kMaxAutoClosingVox);
    const int64_t widest_volume = six_volume_vox(widest, context_);
    for (p.closing_vox = 0; p.closing_vox < kMaxAutoClosingVox; ++p.closing_vox) {
      p.sheet = {};
      p.sheet = sheet(p, p.closing_vox);
      if (10 * six_volume_vox(p.sheet, context_) >= 9 * widest_volume) return;
    }
    p.sheet = std::move(widest);
  }

  const RemeshOptions& options_;
  RemeshReport& report_;
  Context& context_;
};

bool can_compare(const InputTopology& input) { return input.closed && input.oriented && input.genus >= 0; }

/// How far the sheet's topology is from the input's; 0 when they agree, or when the input's is not known.
int64_t topology_gap(const Prepared& p) {
  const InputTopology& input = p.surface.topology;
  if (!can_compare(input)) return 0;
  return std::abs(p.sheet.topology.components - input.components) + std::abs(p.sheet.topology.genus - input.genus);
}

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

void finish(Prepared& p, const PatchSource& source, const RemeshOptions& options, RemeshReport& report,
            Context& context) {
  if (options.want_shell || options.method == Method::shell) {
    p.shell = timed(report, "shell", context, [&] { return build_shell(p.sites, {options.band_vox}, context); });
    report.active_voxels = p.shell.voxels.voxel_count();
    report.leaves = p.shell.voxels.leaf_count();
    note_digest(options, report, context, "shell", p.shell);
  }
  report.input = p.surface.topology;
  report.frame = p.surface.frame;
  report.band_vox = options.band_vox;
  report.closing_vox = p.closing_vox;
  report.grown_vox = p.grown.distance_vox;
  report.sites = p.sites.voxels.voxel_count();
  report.sheet_vertices = p.sheet.vertex_count();
  report.sheet = p.sheet.topology;
  report.topology_compared = can_compare(report.input);
  report.topology_agrees = report.topology_compared && topology_gap(p) == 0;
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
  memory_allows(estimate_run(soup, input, options, usual), false, report, context);
  const auto [lo, hi] = bounding_box(soup);
  const LatticeFrame frame = LatticeFrame::around(lo, hi, usual);
  LatticeSurface surface = timed(report, "snap", context, [&] { return snap_surface(soup, frame, context); });
  surface.topology = input;
  Prepared p = Preparation(options, report, context).from(std::move(surface), asked_closing(options, input, frame));
  RemeshReport unsaid;
  timed(report, "lengths", context, [&] { set_lengths(options, p, unsaid, context); });
  if (p.sheet.lengths.at.empty()) return usual;
  const double cell_world = smallest_cell_vox(options, p, context) * frame.voxel_size;
  int32_t resolution =
      resolution_for_cell(frame.voxel_size * (usual - 1), cell_world, vertex_target(options, input.area_world));
  while (resolution > usual && context.memory_limit_bytes > 0 &&
         estimate_run(soup, input, options, resolution).bytes > context.memory_limit_bytes)
    resolution = std::max(usual, resolution - resolution / 8);
  return resolution;
}

/// The coarsest grid whose sheet has the input's topology, or the one that comes nearest. The soup is that of `source`,
/// repaired.
Prepared prepare_on_best_grid(const TriangleSoup& soup, const InputTopology& input, const PatchSource& source,
                              const RemeshOptions& options, RemeshReport& report, Context& context) {
  const auto [lo, hi] = bounding_box(soup);
  const bool free_grid = !options.resolution && !options.voxel_size_world;
  const int32_t usual = first_resolution(options, input.area_world, lo, hi);
  const int32_t first = free_grid && wants_lengths(options)
                            ? resolution_for_lengths(soup, input, options, usual, report, context)
                            : usual;
  // Where the vertices cannot show the input's topology, a finer grid only brings more parts for them to miss.
  const bool reachable = can_compare(input) && shows_all_parts(options, input);
  const int32_t cap = free_grid && reachable ? std::max(first, std::min(4 * usual, kMaxResolution)) : first;

  Prepared best;
  int64_t best_gap = INT64_MAX;
  int fruitless = 0;
  for (int32_t resolution = first; resolution <= cap && best_gap > 0 && fruitless < 2;
       resolution += std::max(1, resolution / 2)) {
    if (!memory_allows(estimate_run(soup, input, options, resolution), best_gap < INT64_MAX, report, context)) break;
    const LatticeFrame frame = LatticeFrame::around(lo, hi, resolution);
    LatticeSurface surface = timed(report, "snap", context, [&] { return snap_surface(soup, frame, context); });
    surface.topology = input;
    Prepared p;
    try {
      p = Preparation(options, report, context).from(std::move(surface), asked_closing(options, input, frame));
    } catch (const Error& error) {  // what is there is better than nothing
      if (error.code() != ErrorCode::out_of_memory || best_gap == INT64_MAX) throw;
      report.warnings.push_back(std::string("the grid was not refined further: ") + error.what());
      break;
    }
    const int64_t gap = topology_gap(p);
    fruitless = gap < best_gap ? 0 : fruitless + 1;
    if (gap < best_gap) {
      best_gap = gap;
      best = std::move(p);
    }
  }
  finish(best, source, options, report, context);
  if (report.features.border_loops == 0) warn_of_topology(best, input, options, report);
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
  Prepared p = Preparation(options, report, context).from(std::move(surface), closing);
  finish(p, {}, options, report, context);
  return p;
}

Prepared prepare(const TriangleSoup& soup, const RemeshOptions& asked, RemeshReport& report, Context& context) {
  const RemeshOptions options = with_even_length(checked(asked), soup);
  const SoupTopology measured = timed(report, "topology", context, [&] { return measure_topology(soup, context); });
  const InputTopology& given = measured.topology;
  report.dirt = measured.dirt;
  check_area(given);
  memory_allows(estimate_run(soup, given, options, kCoarsestGrid), false, report, context);  // repair comes first
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
