// See finer_grid.h.
#include "pipeline/finer_grid.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <sstream>

#include "core/copy_product.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/to_host.h"
#include "pipeline/choose_grid.h"
#include "pipeline/prepare_surface.h"
#include "pipeline/shown_parts.h"
#include "pipeline/sizing.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

constexpr int kMostFruitless = 2;  ///< finer grids in a row
constexpr int32_t kMostFiner = 4;  ///< than the first choice
constexpr int32_t kCoarsestGrid = 8;

bool can_compare(const InputTopology& input) { return input.closed && input.oriented && input.genus >= 0; }

int32_t next_finer(int32_t resolution) { return resolution + std::max(1, resolution / 2); }

}  // namespace

int64_t topology_gap(const Prepared& p) {
  const InputTopology& input = p.surface.topology;
  if (!can_compare(input)) return 0;
  return std::abs(p.sheet.topology.components - input.components) + std::abs(p.sheet.topology.genus - input.genus);
}

bool may_refine(const RemeshOptions& options, const InputTopology& input) {
  // Where the vertices cannot show the input's topology, a finer grid only brings more parts for them to miss.
  return !options.resolution && !options.voxel_size_world && can_compare(input) && shows_all_parts(options, input);
}

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

Prepared prepare_on_grid(const TriangleSoup& soup, const InputTopology& input, int32_t resolution,
                         const RemeshOptions& options, RemeshReport& report, Context& context) {
  const auto [lo, hi] = bounding_box(soup);
  const LatticeFrame frame = LatticeFrame::around(lo, hi, resolution);
  LatticeSurface surface = timed(report, "snap", context, [&] { return snap_surface(soup, frame, context); });
  surface.topology = input;
  return prepare_surface(std::move(surface), asked_closing(options, input, frame), options, report, context);
}

bool memory_allows(const TriangleSoup& soup, const InputTopology& input, const RemeshOptions& options,
                   int32_t resolution, bool refining, RemeshReport& report, const Context& context) {
  const RunEstimate estimate = estimate_run(soup, input, options, resolution);
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

std::optional<Prepared> finer_grid(const TriangleSoup& soup, const Prepared& coarse,
                                   const std::function<bool(Prepared&)>& is_enough, const RemeshOptions& options,
                                   RemeshReport& report, Context& context) {
  std::optional<Prepared> best;
  const InputTopology& input = coarse.surface.topology;
  int64_t best_gap = topology_gap(coarse);
  if (!may_refine(options, input)) return best;
  const auto [lo, hi] = bounding_box(soup);
  const int32_t cap = std::min(kMostFiner * first_resolution(options, input.area_world, lo, hi), kMaxResolution);
  int fruitless = 0;
  for (int32_t resolution = next_finer(coarse.surface.frame.resolution);
       resolution <= cap && best_gap > 0 && fruitless < kMostFruitless; resolution = next_finer(resolution)) {
    if (!memory_allows(soup, input, options, resolution, true, report, context)) break;
    Prepared p;
    try {
      p = prepare_on_grid(soup, input, resolution, options, report, context);
    } catch (const Error& error) {  // what is there is better than nothing
      if (error.code() != ErrorCode::out_of_memory) throw;
      report.warnings.push_back(std::string("the grid was not refined further: ") + error.what());
      break;
    }
    if (is_enough(p)) return p;
    const int64_t gap = topology_gap(p);
    fruitless = gap < best_gap ? 0 : fruitless + 1;
    if (gap >= best_gap) continue;
    best_gap = gap;
    best = std::move(p);
  }
  return best;
}

std::optional<Prepared> finer_grid_after_all(const Prepared& coarse, const RemeshOptions& options, RemeshReport& report,
                                             Context& context) {
  if (topology_gap(coarse) == 0 || !may_refine(options, coarse.surface.topology)) return {};
  const OnHost<LatticeSurface> surface(coarse.surface);
  TriangleMesh triangles = to_world(*surface);
  TriangleSoup soup;
  soup.vertices = std::move(triangles.vertices);
  soup.triangles = std::move(triangles.triangles);
  std::optional<Prepared> finer = finer_grid(
      soup, coarse, [](const Prepared&) { return false; }, options, report, context);
  if (!finer) return finer;
  finer->surface = to_host(finer->surface);
  for (uint32_t& face : finer->surface.source_face) face = surface->source_face[face];
  finer->surface.first_cap = coarse.surface.first_cap;
  finer->samples = {};
  RemeshReport unsaid;
  set_lengths(options, *finer, unsaid, context);
  report_sheet(*finer, report);
  return finer;
}

void report_sheet(const Prepared& p, RemeshReport& report) {
  report.frame = p.surface.frame;
  report.closing_vox = p.closing_vox;
  report.grown_vox = p.grown.distance_vox;
  report.sites = p.sites.voxels.voxel_count();
  report.sheet_vertices = p.sheet.vertex_count();
  report.sheet = p.sheet.topology;
  report.topology_compared = can_compare(p.surface.topology);
  report.topology_agrees = report.topology_compared && topology_gap(p) == 0;
}

}  // namespace isoshell
