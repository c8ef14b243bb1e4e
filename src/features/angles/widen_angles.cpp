// widen (see widen_angles.h).
#include "features/angles/widen_angles.h"

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kRounds = 8;  ///< over all poor triangles

}  // namespace

void widen(PatchMesh& mesh, const Context& context) {
  run_with_threads(context, [&] {
    for (int round = 0; round < kRounds; ++round) {
      check_cancel(context, "features");
      if (!mesh.improve(mesh.poor_triangles())) break;
    }
    mesh.meet_count(context);
  });
}

}  // namespace isoshell
