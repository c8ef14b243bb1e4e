// See wide_angles.h.
#include "pipeline/patches/wide_angles.h"

#include <algorithm>

#include "features/angles/widen_angles.h"
#include "measure/crossing_corners.h"
#include "pipeline/patches/new_crossings.h"

namespace isoshell {

namespace {

/// Pairs of triangles with the same corners.
TrianglePairs faces_there_twice(const DualMesh& mesh) {
  std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> faces;
  for (uint32_t t = 0; t < uint32_t(mesh.triangles.size()); ++t) {
    const TriangleIndices& i = mesh.triangles[t];
    std::array<uint32_t, 3> corners{i.a, i.b, i.c};
    std::sort(corners.begin(), corners.end());
    faces.push_back({corners, t});
  }
  std::sort(faces.begin(), faces.end());
  TrianglePairs twins;
  for (size_t i = 1; i < faces.size(); ++i)
    if (faces[i].first == faces[i - 1].first) twins.push_back({faces[i - 1].second, faces[i].second});
  return twins;
}

}  // namespace

JoinedPatches with_wide_angles(const PreparedSurface& p, const CutSurface& cut, const SeededMesh& made,
                               const PatchOptions& options, const RemeshReport& report, Context& context) {
  const bool may_cross = report.optimize.self_intersections > 0;  // where the input does
  NewCrossings crossings(p, cut, context);
  const auto wrong_corners = [&](const DualMesh& mesh) {
    TrianglePairs pairs = crossings.all(mesh, {});
    if (may_cross) pairs = crossings.wrong_of(mesh, pairs);
    if (cut.parts_regions) {
      const TrianglePairs twins = faces_there_twice(mesh);
      pairs.insert(pairs.end(), twins.begin(), twins.end());
    }
    return corners_of(mesh, pairs);
  };
  return join_and_widen(cut, made, {options.seeds.count, options.previous != nullptr}, wrong_corners, context);
}

}  // namespace isoshell
