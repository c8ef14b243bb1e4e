// See crease_search.h.
#include "pipeline/crease_search.h"

#include <utility>

#include "core/watched.h"
#include "features/weld_for_features.h"
#include "isoshell/to_host.h"
#include "pipeline/choose_grid.h"
#include "pipeline/sizing.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

std::optional<FoundCreases> creases_unless_refused(const FeatureMesh& mesh, const CurveOptions& options) {
  try {
    return find_creases(mesh, options);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    return {};
  }
}

}  // namespace

CurveOptions curve_options(const RemeshOptions& options, double edge_length_world) {
  const Features::Creases creases = options.features.creases;
  const CreaseMode mode = creases == Features::Creases::off         ? CreaseMode::off
                          : creases == Features::Creases::automatic ? CreaseMode::automatic
                                                                    : CreaseMode::threshold;
  return {mode, options.features.degrees, edge_length_world};
}

FeatureMesh feature_mesh_of(const LatticeSurface& surface, const Context& context) {
  FeatureMesh mesh = run_with_threads(context, [&] { return weld_for_features(surface); });
  mesh.rounding_world = surface.frame.voxel_size / (2 * kOneVoxelQ8);
  return mesh;
}

CreaseSearch::CreaseSearch(LatticeSurface surface, const CurveOptions& options, const Context& context) {
  // Where there is no thread for it, result() does the work.
  constexpr auto own_thread_if_any = std::launch::async | std::launch::deferred;
  result_ = std::async(own_thread_if_any, [this, surface = std::move(surface), options, &context] {
    SearchedSurface found{feature_mesh_of(surface, context), {}};
    check_cancel(context, "features");
    found.creases = run_with_threads(context, [&] { return creases_unless_refused(found.mesh, options); });
    has_found_curves_ = found.creases && !found.creases->curve_edges.empty();
    return found;
  });
}

std::shared_ptr<CreaseSearch> begin_crease_search(const RemeshOptions& options, const LatticeSurface& surface,
                                                  RemeshReport& report, Context& context) {
  const bool is_wanted = options.method == Method::sheet && options.features.creases != Features::Creases::off;
  const bool is_known = !options.features.lines && !wants_lengths(options);
  if (surface.points.space() == MemorySpace::host || !is_wanted || !is_known) return nullptr;
  const double edge_world = usual_edge_length(options, surface.topology.area_world);
  return timed(report, "features", context, [&] {
    return std::make_shared<CreaseSearch>(to_host(surface), curve_options(options, edge_world), context);
  });
}

}  // namespace isoshell
