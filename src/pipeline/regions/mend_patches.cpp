// See mend_patches.h.
#include "pipeline/regions/mend_patches.h"

#include <algorithm>
#include <cstddef>

#include "features/angles/widen_angles.h"
#include "features/mesh/feature_mesh.h"
#include "features/walls/coarsen_patches.h"
#include "pipeline/defects/inverted_regions.h"

namespace isoshell {
namespace {

constexpr int kMostRounds = 16;
constexpr size_t kMostCoarse = 2;  ///< one fine triangle in so many is in a coarse patch, at most

/// Those around regions that are inside out.
std::vector<uint32_t> inverted_patches(const CutSurface& cut, const JoinedPatches& joined) {
  const std::vector<uint32_t>& patch = joined.features.patch;
  std::vector<uint32_t> inverted;
  std::vector<char> is_inverted(size_t(joined.mesh.position.size()), 0);
  for (const uint32_t v : find_inverted_regions(cut, joined.mesh, patch)) is_inverted[v] = 1;
  for (size_t t = 0; t < patch.size(); ++t) {
    const TriangleIndices& i = joined.mesh.triangles[int64_t(t)];
    if (is_inverted[i.a] && is_inverted[i.b] && is_inverted[i.c]) inverted.push_back(patch[t]);
  }
  return inverted;
}

bool are_most(const CutSurface& cut, const std::vector<char>& is_coarse) {
  const size_t triangles = cut.fine->triangles.size();
  size_t coarse = 0;
  for (size_t t = 0; t < triangles; ++t) coarse += is_coarse[cut.surface.patch[cut.corner[3 * t]]] ? 1 : 0;
  return kMostCoarse * coarse > triangles;
}

}  // namespace

std::optional<JoinedPatches> mend_patches(const CutSurface& cut, const SeededMesh& made, std::vector<char>& is_wrong,
                                          const JoinOptions& options, Context& context) {
  const PatchMesh relaxed(cut, made, options);
  for (int round = 0; round < kMostRounds && !are_most(cut, is_wrong); ++round) {
    std::optional<PatchMesh> mended = coarsen_patches(cut, relaxed, is_wrong, options, context);
    if (!mended) continue;  // more patches are to be coarse
    const std::vector<uint32_t> more = inverted_patches(cut, mended->joined());
    if (more.empty()) return widened(std::move(*mended), context);
    if (std::all_of(more.begin(), more.end(), [&](uint32_t patch) { return is_wrong[patch]; })) return {};
    for (const uint32_t patch : more) is_wrong[patch] = 1;
  }
  return {};
}

}  // namespace isoshell
