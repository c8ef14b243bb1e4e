// Creases of a snapped surface, looked for while a device works on the same surface.
#pragma once

#include <atomic>
#include <chrono>
#include <future>
#include <optional>

#include "features/curves/find_curves.h"
#include "isoshell/advanced/own_thread.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// How curves are looked for with edges of this length, in a run that begins with the frame before or anew (null);
/// without seams and lines.
CurveOptions curve_options(const RemeshOptions& options, const PreviousFrame* previous, double edge_length_world);

/// The snapped surface, welded: what a stage file holds, so that a run that resumes finds the same features.
FeatureMesh feature_mesh_of(const LatticeSurface& surface, const Context& context);

/// What there is to know before seams and lines are.
struct SearchedSurface {
  FeatureMesh mesh;                     ///< without slivers
  bool had_slivers = false;             ///< so that edges of the surface may be gone
  std::optional<FoundCreases> creases;  ///< none where find_creases refuses the mesh, and will say so again
};

/// A search on a thread of its own. Its end waits for it.
class CreaseSearch {
 public:
  /// The surface lies on a device, and its buffers stay until wait_until_copied(). Throws out_of_memory where there is
  /// no thread.
  CreaseSearch(const LatticeSurface& surface, const CurveOptions& options, const Context& context);
  void wait_until_copied() const { copied_.wait(); }
  /// Whether it goes on, on a thread of its own.
  bool goes_on() const {
    return has_result() && result_.wait_for(std::chrono::seconds(0)) == std::future_status::timeout;
  }
  /// Whether result() was not called yet.
  bool has_result() const { return result_.valid(); }
  /// Whether it is known that there are curves. Does not wait.
  bool has_found_curves() const { return has_found_curves_; }
  /// Waits. Throws what the search threw. To be called once.
  SearchedSurface result() { return result_.get(); }
  /// Frees what the search found, on a thread of its own: giving pages back takes as long as some stages do.
  void free_meanwhile(SearchedSurface found);

 private:
  std::future<void> copied_;
  std::atomic<bool> has_found_curves_{false};
  std::future<SearchedSurface> result_;
  OwnThread thread_;  // ends before what it writes to
  std::future<void> freed_;
};

/// Begins the search that cut_into_patches ends, where nothing else would use the host's threads: the surface lies on a
/// device. Null elsewhere, and where the edge length depends on the sheet. Books the time of the beginning alone.
std::shared_ptr<CreaseSearch> begin_crease_search(const PreparedSurface& p, Run& run);

}  // namespace isoshell
