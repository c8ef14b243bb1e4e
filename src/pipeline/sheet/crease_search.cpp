// See crease_search.h.
#include "pipeline/sheet/crease_search.h"

#include <memory>
#include <utility>

#include "core/watched.h"
#include "features/mesh/remove_slivers.h"
#include "features/mesh/weld_for_features.h"
#include "pipeline/grid/sizing.h"

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

/// What is read of a surface, in the buffers of another one.
class SurfaceOnDevice {
 public:
  explicit SurfaceOnDevice(const LatticeSurface& surface)
      : frame_(surface.frame),
        memory_(&surface.points.memory()),
        points_(surface.points.view()),
        triangles_(surface.triangles.view()) {}

  /// On the host. Says in any case when the buffers are not read any more.
  LatticeSurface copy(std::promise<void> copied) const {
    const auto say_copied = [](std::promise<void>* done) { done->set_value(); };
    const std::unique_ptr<std::promise<void>, decltype(say_copied)> at_the_end(&copied, say_copied);
    LatticeSurface here;
    here.frame = frame_;
    here.points = copy_of(points_);
    here.triangles = copy_of(triangles_);
    return here;
  }

 private:
  template <class T>
  Buffer<T> copy_of(View<const T> from) const {
    Buffer<T> here(from.size);
    memory_->copy_to_host(here.data(), from.data, here.size_bytes());
    return here;
  }

  LatticeFrame frame_;
  Memory* memory_;
  View<const PointQ8> points_;
  View<const TriangleIndices> triangles_;
};

}  // namespace

CurveOptions curve_options(const RemeshOptions& options, const PreviousFrame* previous, double edge_length_world) {
  const Features::Creases creases = options.features.creases;
  const CreaseMode mode = creases == Features::Creases::off         ? CreaseMode::off
                          : creases == Features::Creases::automatic ? CreaseMode::automatic
                                                                    : CreaseMode::threshold;
  CurveOptions curves{mode, options.features.degrees, edge_length_world};
  if (previous && previous->has_other_faces) curves.before = previous;
  return curves;
}

FeatureMesh feature_mesh_of(const LatticeSurface& surface, const Context& context) {
  FeatureMesh mesh = run_with_threads(context, [&] { return weld_for_features(surface); });
  mesh.rounding_world = surface.frame.voxel_size / (2 * kOneVoxelQ8);
  return mesh;
}

CreaseSearch::CreaseSearch(const LatticeSurface& surface, const CurveOptions& options, const Context& context) {
  std::promise<void> copied;
  copied_ = copied.get_future();
  const SurfaceOnDevice on_device(surface);
  auto search = [this, copied = std::move(copied), on_device, options, &context]() mutable {
    const LatticeSurface here = on_device.copy(std::move(copied));
    SearchedSurface found{feature_mesh_of(here, context), false, {}};
    found.had_slivers = run_with_threads(
        context, [&] { return remove_slivers(found.mesh, here.frame, {}, options.edge_length_world, context); });
    check_cancel(context, "features");
    found.creases = run_with_threads(context, [&] { return creases_unless_refused(found.mesh, options); });
    has_found_curves_ = found.creases && !found.creases->curve_edges.empty();
    return found;
  };
  const auto task = std::make_shared<std::packaged_task<SearchedSurface()>>(std::move(search));
  result_ = task->get_future();
  thread_ = OwnThread([task] { (*task)(); });
}

void CreaseSearch::free_meanwhile(SearchedSurface found) {
  freed_ = std::async(std::launch::async | std::launch::deferred,
                      [found = std::move(found)]() mutable { const auto ends_here = std::move(found); });
}

std::shared_ptr<CreaseSearch> begin_crease_search(const PreparedSurface& p, Run& run) {
  const RemeshOptions& options = p.options;
  const bool is_wanted = options.method == Method::sheet && options.features.creases != Features::Creases::off;
  const bool is_known = !options.features.lines && !wants_lengths(options);
  if (p.surface.points.space() == MemorySpace::host || !is_wanted || !is_known) return nullptr;
  const double edge_world = p.target_of_input.edge_length_world;
  return run.timed("features", [&] {
    return std::make_shared<CreaseSearch>(p.surface, curve_options(options, p.previous.get(), edge_world), run.context);
  });
}

}  // namespace isoshell
