// join_and_widen (see widen_angles.h).
#include "features/angles/widen_angles.h"

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kRounds = 8;  ///< over all poor triangles

void improve(PatchMesh& mesh, const Context& context) {
  for (int round = 0; round < kRounds; ++round) {
    check_cancel(context, "features");
    if (!mesh.improve(mesh.poor_triangles())) return;
  }
}

}  // namespace

JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                             Context& context) {
  return run_with_threads(context, [&] {
    PatchMesh mesh(cut, made, options);
    improve(mesh, context);
    mesh.meet_count(context);
    return mesh.joined();
  });
}

}  // namespace isoshell
