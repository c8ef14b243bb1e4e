// See mend_patches.h.
#include "pipeline/patches/mend_patches.h"

#include <algorithm>
#include <cstddef>

#include "core/watched.h"
#include "features/angles/widen_angles.h"
#include "features/mesh/feature_mesh.h"
#include "features/walls/coarsen_patches.h"
#include "pipeline/defects/inverted_regions.h"

namespace isoshell {
namespace {

constexpr size_t kMostCoarse = 2;  ///< one fine triangle in so many is in a coarse patch, at most

/// Those around regions that are inside out.
std::vector<uint32_t> inverted_patches(const CutSurface& cut, const JoinedPatches& joined) {
  const std::vector<uint32_t>& patch = joined.features.patch;
  std::vector<uint32_t> inverted;
  if (!cut.regions) return inverted;
  std::vector<char> is_inverted(size_t(joined.mesh.position.size()), 0);
  for (const uint32_t v : find_inverted_regions(cut, joined.mesh, patch)) is_inverted[v] = 1;
  for (size_t t = 0; t < patch.size(); ++t) {
    const TriangleIndices& i = joined.mesh.triangles[int64_t(t)];
    if (is_inverted[i.a] && is_inverted[i.b] && is_inverted[i.c]) inverted.push_back(patch[t]);
  }
  return inverted;
}

size_t count_triangles(const CutSurface& cut, const std::vector<char>& is_coarse) {
  size_t count = 0;
  for (size_t t = 0; t < cut.fine->triangles.size(); ++t)
    count += is_coarse[cut.surface.patch[cut.corner[3 * t]]] ? 1 : 0;
  return count;
}

}  // namespace

std::optional<JoinedPatches> mend_patches(const CutSurface& cut, const SeededMesh& made, std::vector<char>& is_wrong,
                                          const JoinOptions& options, Context& context) {
  const size_t triangles = cut.fine->triangles.size();
  const PatchMesh relaxed = run_with_threads(context, [&] { return PatchMesh(cut, made, options); });
  for (size_t work = 0;;) {
    check_cancel(context, "features");
    const size_t coarse = count_triangles(cut, is_wrong);
    work += coarse;
    if (kMostCoarse * coarse > triangles || work > triangles) return {};
    std::optional<PatchMesh> mended = coarsen_patches(cut, relaxed, is_wrong, options, context);
    if (!mended) continue;  // more patches are to be coarse
    const std::vector<uint32_t> more = inverted_patches(cut, mended->joined());
    if (more.empty()) return widened(std::move(*mended), context);
    if (std::all_of(more.begin(), more.end(), [&](uint32_t patch) { return is_wrong[patch]; })) return {};
    for (const uint32_t patch : more) is_wrong[patch] = 1;
  }
}

}  // namespace isoshell
