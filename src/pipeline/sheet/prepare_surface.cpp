// See prepare_surface.h.
#include "pipeline/sheet/prepare_surface.h"

#include <algorithm>
#include <cmath>

#include "core/copy_product.h"
#include "core/vector_view.h"
#include "isoshell/advanced/to_host.h"
#include "pipeline/grid/shown_parts.h"
#include "pipeline/grid/sizing.h"
#include "pipeline/grid/thin_walls.h"
#include "pipeline/sheet/crease_search.h"
#include "pipeline/sheet/flaps.h"
#include "pipeline/sheet/warm_start.h"
#include "repair/solids/hollows.h"
#include "repair/solids/joined_components.h"

namespace isoshell {
namespace {

constexpr int32_t kMaxAutoClosingVox = 4;
constexpr double kSidesOfCrust = 0.75;  ///< of the area of both sides; a solid shows half of it

/// Sites, samples and sheet of a surface, with the closing that is asked for or found.
class Preparation {
 public:
  Preparation(const RemeshOptions& options, Run& run) : options_(options), run_(run), context_(run.context) {}

  PreparedSurface from(LatticeSurface surface, std::optional<int32_t> closing_vox) {
    PreparedSurface p = begin_with(std::move(surface), options_);
    if (options_.previous && !wants_lengths(options_)) p.report.coherence.why_cold = choose_beginning(p);
    p.creases = begin_crease_search(p, run_);
    p.sites = run_.timed("voxelize", [&] { return voxelize(p.surface, context_); });
    p.samples = run_.timed("samples", [&] { return sample_sites(p.surface, p.sites, context_); });
    const bool shows_handles = shows_most_handles(p.target_of_input.vertices, p.surface.topology);
    join_components(p);
    mark_hollows(p);
    if (!shows_handles) {
      let_samples_go(p);
      const int32_t grown = growth_for_edge(edge_vox(p));
      p.closing_vox = 2 * grown;
      grow(p, grown);
      return p;
    }
    const bool is_open = !p.surface.topology.closed;
    if (closing_vox) {
      p.closing_vox = *closing_vox;
      p.sheet = is_open || keeps_samples() ? sheet(p, p.closing_vox) : last_sheet(p);
    } else {
      close_leaks(p);
    }
    if (is_needle(p) && p.sheet.vertex_count() >= 2 * p.target_of_input.vertices)  // else the grid is too coarse
      thicken_needle(p);
    else if (is_open && is_crust(p))
      keep_sides_apart(p);
    else if (is_open || p.surface.first_cap != kNone)  // a flap's cap may lie on it
      thicken_flaps(p);
    let_samples_go(p);
    return p;
  }

 private:
  /// They are a quarter of what there is where the sheet takes most.
  bool keeps_samples() const {
    return options_.want_samples || options_.want_digests || options_.want_shell || options_.method == Method::shell;
  }
  void let_samples_go(PreparedSurface& p) const {
    if (!keeps_samples()) p.samples = {};
  }

  /// Surfaces that pass through each other bound one solid, whose genus none of them tells.
  void join_components(PreparedSurface& p) {
    InputTopology& input = p.surface.topology;
    if (input.genus < 0 || input.components < 2) return;
    const int64_t joins = run_.timed("topology", [&] { return count_joins(*OnHost(p.surface), *OnHost(p.samples)); });
    if (joins == 0) return;
    input.components -= joins;
    input.genus = -1;
  }

  /// What inner surfaces bound is open to the outside, as it were.
  void mark_hollows(PreparedSurface& p) {
    const InputTopology& input = p.surface.topology;
    if (!input.closed || !input.oriented || input.components < 2) return;
    const std::vector<Voxel> hollows =
        run_.timed("hollows", [&] { return find_hollows(*OnHost(p.surface), *OnHost(p.sites), *OnHost(p.samples)); });
    if (hollows.empty()) return;
    p.sites = to_host(p.sites);
    p.sites.hollows = buffer_of(hollows);
  }

  double edge_vox(const PreparedSurface& p) const {
    return p.target_of_input.edge_length_world / p.surface.frame.voxel_size;
  }

  /// Of what the sheet bounds, on average.
  double thickness_vox(const Sheet& sheet) const {
    const double voxel = sheet.frame.voxel_size, area_vox = sheet_area_world(sheet) / (voxel * voxel);
    return double(six_volume_vox(sheet, context_)) / 3 / area_vox;
  }

  /// Until edges turn around it. The sheet's area, and so its edges, grow as it does.
  void thicken_needle(PreparedSurface& p) {
    int32_t grown_vox = 0;
    for (int32_t wider_vox = 1; wider_vox > grown_vox;) {
      grown_vox = wider_vox;
      grow(p, grown_vox);
      wider_vox = growth_for_edge(edge_length_on_sheet_world(p) / p.surface.frame.voxel_size);
    }
  }

  /// Whether the outside reaches both sides of the surface. Closing fills parts of a crust, but makes it no solid: that
  /// would hide one of the two sides.
  bool is_crust(const PreparedSurface& p) {
    const double here = thickness_vox(p.sheet);
    if (here < 1) return true;
    if (here >= std::min(edge_vox(p) / 2, 2. * p.closing_vox + 1)) return false;
    const Sheet open = sheet(p, 0);
    if (here < 2 * thickness_vox(open)) return true;
    return sheet_area_world(p.sheet) > kSidesOfCrust * sheet_area_world(open);
  }

  /// Where the outside reaches both sides of an open surface, they would lie on each other and cross. Growth must not
  /// close what no one asked to close.
  void keep_sides_apart(PreparedSurface& p) {
    int32_t grown = growth_for_edge(std::sqrt(2) * edge_vox(p));  // both sides share the vertices
    for (;; grown /= 2) {
      grow(p, grown);
      if (grown == 1 || thickness_vox(p.sheet) < 2 * grown + 3) return;
    }
  }

  /// A solid whose false handles were cut is no longer that of its sites, and stays as it is.
  void thicken_flaps(PreparedSurface& p) {
    if (p.sheet.topology.cut_handles > 0) return;
    const int32_t grown_vox = growth_for_edge(edge_length_on_sheet_world(p) / p.surface.frame.voxel_size);
    run_.timed("sheet", [&] { return grow_flaps(p, grown_vox, smallest_component_q16(p), context_); });
  }

  void grow(PreparedSurface& p, int32_t grown_vox) {
    run_.timed("sheet", [&] { grow_solid(p, grown_vox, smallest_component_q16(p), context_); });
  }

  SheetOptions sheet_options(const PreparedSurface& p, int32_t closing_vox) const {
    const InputTopology& input = p.surface.topology;
    const int64_t genus = !input.closed || !input.oriented ? kNoGenus : input.genus < 0 ? kUnknownGenus : input.genus;
    return {closing_vox, smallest_component_q16(p), genus};
  }
  Sheet sheet(const PreparedSurface& p, int32_t closing_vox) {
    return run_.timed(
        "sheet", [&] { return build_sheet(p.surface, p.sites, p.samples, sheet_options(p, closing_vox), context_); });
  }
  /// Frees the samples on the way.
  Sheet last_sheet(PreparedSurface& p) {
    return run_.timed("sheet", [&] {
      return build_sheet(p.surface, p.sites, std::move(p.samples), sheet_options(p, p.closing_vox), context_);
    });
  }

  /// The smallest closing whose solid holds nine tenths of what the largest one holds: below it the outside leaks in
  /// and the solid collapses to a crust.
  void close_leaks(PreparedSurface& p) {
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
  Run& run_;
  Context& context_;
};

}  // namespace

PreparedSurface prepare_surface(LatticeSurface surface, std::optional<int32_t> closing_vox,
                                const RemeshOptions& options, Run& run) {
  PreparedSurface p = Preparation(options, run).from(std::move(surface), closing_vox);
  if (p.creases) p.creases->wait_until_copied();
  return p;
}

bool can_compare(const InputTopology& input) { return input.closed && input.oriented && input.genus >= 0; }

int64_t topology_gap(const PreparedSurface& p) {
  const InputTopology& input = p.surface.topology;
  if (!can_compare(input)) return 0;
  return std::abs(p.sheet.topology.components - input.components) + std::abs(p.sheet.topology.genus - input.genus);
}

void report_sheet(PreparedSurface& p) {
  RemeshReport& report = p.report;
  report.grid.closing_vox = p.closing_vox;
  report.grid.grown_vox = p.grown.distance_vox;
  report.grid.sites = p.sites.voxels.voxel_count();
  report.sheet.vertices = p.sheet.vertex_count();
  report.sheet.topology = p.sheet.topology;
  report.sheet.is_compared = can_compare(p.surface.topology);
  report.sheet.agrees = report.sheet.is_compared && topology_gap(p) == 0;
}

}  // namespace isoshell
