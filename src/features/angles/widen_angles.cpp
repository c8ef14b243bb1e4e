// join_and_widen (see widen_angles.h).
#include "features/angles/widen_angles.h"

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kAttempts = 4;  ///< each without changes where triangles intersected after those before
constexpr int kRounds = 8;    ///< over all poor triangles

void improve(PatchMesh& mesh, const Context& context) {
  for (int round = 0; round < kRounds; ++round) {
    check_cancel(context, "features");
    if (!mesh.improve(mesh.poor_triangles())) return;
  }
}

}  // namespace

JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options,
                             const Crossings& crossings, Context& context) {
  return run_with_threads(context, [&] {
    const PatchMesh before(cut, made, options);
    if (before.poor_triangles().empty() && before.surplus() == 0) return before.joined();
    std::vector<PointQ8> wrong;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      PatchMesh mesh = before;
      if (!wrong.empty()) mesh.keep_near(wrong);
      improve(mesh, context);
      mesh.meet_count(context);
      JoinedPatches wide = mesh.joined();
      const std::vector<PointQ8> points = crossings(wide.mesh);
      if (points.empty()) return wide;
      wrong.insert(wrong.end(), points.begin(), points.end());
    }
    return before.joined();
  });
}

}  // namespace isoshell
