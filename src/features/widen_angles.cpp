// join_and_widen (see widen_angles.h).
#include "features/widen_angles.h"

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kRounds = 4;  ///< over all poor triangles

/// Result: whether anything was changed.
bool improve(PatchMesh& mesh, PatchMesh::Reach reach, const Context& context) {
  for (int round = 0; round < kRounds; ++round) {
    check_cancel(context, "features");
    if (!mesh.improve(mesh.poor_triangles(), reach)) return round > 0;
  }
  return true;
}

}  // namespace

JoinedPatches join_and_widen(const CutSurface& cut, const SeededMesh& made,
                             const std::function<bool(const DualMesh&)>& is_clean, Context& context) {
  return run_with_threads(context, [&] {
    const PatchMesh before(cut, made);
    if (before.poor_triangles().empty()) return before.joined();
    PatchMesh mesh = before;
    const bool has_changed =
        improve(mesh, PatchMesh::Reach::corners, context) | improve(mesh, PatchMesh::Reach::rings, context);
    if (!has_changed || !mesh.meet_count()) return before.joined();
    JoinedPatches wide = mesh.joined();
    return is_clean(wide.mesh) ? std::move(wide) : before.joined();
  });
}

}  // namespace isoshell
