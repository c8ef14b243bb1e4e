// See mend_patches.h.
#include "pipeline/patches/mend_patches.h"

#include <algorithm>
#include <cstddef>

#include "core/watched.h"
#include "features/angles/widen_angles.h"
#include "features/mesh/feature_mesh.h"
#include "features/walls/coarsen_patches.h"
#include "features/walls/coarsen_walls.h"
#include "isoshell/readable.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/grid/memory_estimate.h"
#include "pipeline/grid/timed.h"
#include "pipeline/patches/new_crossings.h"

namespace isoshell {
namespace {

constexpr size_t kMostCoarse = 2;              ///< one fine triangle in so many is in a coarse patch, at most
constexpr size_t kTrianglesPerCrossing = 256;  ///< fine ones; where more of them meet, parts lie on each other

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

/// Whether the fine triangles of a surface meet nearly nowhere, on the lattice.
bool is_nearly_embedded(const CutSurface& cut, const NewCrossings& crossings) {
  DualMesh fine;
  fine.position = Buffer<PointQ8>(int64_t(cut.fine->position.size()));
  fine.triangles = Buffer<TriangleIndices>(int64_t(cut.fine->triangles.size()));
  std::transform(cut.fine->position.begin(), cut.fine->position.end(), fine.position.begin(), rounded);
  std::transform(cut.fine->triangles.begin(), cut.fine->triangles.end(), fine.triangles.begin(), [](const auto& t) {
    return TriangleIndices{t[0], t[1], t[2]};
  });
  return kTrianglesPerCrossing * crossings.all(fine, {}).size() <= cut.fine->triangles.size();
}

bool memory_allows(const CutSurface& cut, const Context& context) {
  const double bytes = kBytesPerFinePoint * double(cut.fine->position.size());
  return context.memory_limit_bytes <= 0 || bytes <= double(context.memory_limit_bytes);
}

void warn_of_coarse(const WrongPatches& wrong, RemeshReport& report) {
  report.warnings.push_back(
      "in " + std::to_string(std::count(wrong.is_wrong.begin(), wrong.is_wrong.end(), 1)) + " of " +
      counted(int64_t(wrong.is_wrong.size()), "patch", "patches") +
      " edges were collapsed and flipped, not relaxed, and triangles are less even: " + wrong.what);
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

std::optional<JoinedPatches> simplify_instead(const PreparedSurface& p, const CutSurface& cut, const SeededMesh& made,
                                              WrongPatches wrong, const PatchOptions& in_patches, RemeshReport& report,
                                              Context& context) {
  return timed(report, "coarsen", context, [&]() -> std::optional<JoinedPatches> {
    if (!memory_allows(cut, context)) return {};
    NewCrossings crossings(p, cut, context);
    const JoinOptions options = join_options(in_patches);
    const auto is_mesh = [&](const std::optional<JoinedPatches>& joined) {
      if (!joined || !CountReport{options.vertices, joined->mesh.position.size(), {}}.is_near()) return false;
      const TrianglePairs pairs = crossings.all(joined->mesh, {});
      report.optimize.self_intersections = int64_t(pairs.size());
      return crossings.wrong_of(joined->mesh, pairs).empty();
    };
    std::optional<JoinedPatches> joined;
    if (std::find(wrong.is_wrong.begin(), wrong.is_wrong.end(), 1) != wrong.is_wrong.end())
      joined = mend_patches(cut, made, wrong.is_wrong, options, context);
    if (!is_mesh(joined)) {
      if (!is_nearly_embedded(cut, crossings)) return {};
      joined = widened(coarsen_walls(cut, all_triangles_of(cut), options, context), context);
      std::fill(wrong.is_wrong.begin(), wrong.is_wrong.end(), char(1));
      if (!is_mesh(joined)) return {};
    }
    warn_of_coarse(wrong, report);
    return joined;
  });
}

}  // namespace isoshell
