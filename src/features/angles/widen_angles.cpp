// join_and_widen (see widen_angles.h).
#include "features/angles/widen_angles.h"

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kRounds = 8;  ///< over all poor triangles

}  // namespace

JoinedPatches widened(PatchMesh mesh, const Context& context) {
  return run_with_threads(context, [&] {
    for (int round = 0; round < kRounds; ++round) {
      check_cancel(context, "features");
      if (!mesh.improve(mesh.poor_triangles())) break;
    }
    mesh.meet_count(context);
    return mesh.joined();
  });
}

JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                             const Context& context) {
  return widened(run_with_threads(context, [&] { return PatchMesh(cut, made, options); }), context);
}

}  // namespace isoshell
