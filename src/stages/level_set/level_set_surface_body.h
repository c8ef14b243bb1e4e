// level_set_surface (see level_set.h), written once over an executor.
#pragma once

#include <array>

#include "isoshell/advanced/level_set.h"

namespace isoshell {
namespace level_set_steps {

/// From a position of the lattice, and from one of the world.
struct ToVoxels {
  WorldPoint origin;
  double voxel_size;

  ISOSHELL_HD WorldPoint operator()(PointQ8 q) const {
    constexpr double kStep = 1.0 / kOneVoxelQ8;
    return {q.x * kStep, q.y * kStep, q.z * kStep};
  }
  ISOSHELL_HD WorldPoint operator()(const WorldPoint& p) const {
    return {(p.x - origin.x) / voxel_size, (p.y - origin.y) / voxel_size, (p.z - origin.z) / voxel_size};
  }
};

/// What was snapped; empty where that is not known.
struct ExactTriangles {
  View<const WorldPoint> vertices;
  View<const std::array<uint32_t, 3>> triangles;
};

struct PutSnapped {
  ToVoxels to_voxels;
  View<const PointQ8> points;
  View<const TriangleIndices> triangles;
  View<WorldPoint> corner;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    corner[3 * i] = to_voxels(points[t.a]);
    corner[3 * i + 1] = to_voxels(points[t.b]);
    corner[3 * i + 2] = to_voxels(points[t.c]);
  }
};

struct PutExact {
  ToVoxels to_voxels;
  ExactTriangles exact;
  View<const uint32_t> source_face;
  View<WorldPoint> corner;
  ISOSHELL_HD void operator()(int64_t i) const {
    for (int k = 0; k < 3; ++k) corner[3 * i + k] = to_voxels(exact.vertices[exact.triangles[source_face[i]][k]]);
  }
};

}  // namespace level_set_steps

template <class Exec>
LevelSetSurface level_set_surface_body(Exec& exec, const LatticeSurface& surface,
                                       const level_set_steps::ExactTriangles& exact, const Sheet& sheet,
                                       SheetPart part) {
  using namespace level_set_steps;
  const ToVoxels to_voxels{sheet.frame.origin, sheet.frame.voxel_size};
  const int64_t of_input = part == SheetPart::alone ? 0 : surface.triangles.size(),
                of_sheet = part == SheetPart::none ? 0 : sheet.triangles.size();
  LevelSetSurface made{exec.template make<WorldPoint>(3 * (of_input + of_sheet)), of_input};
  const View<WorldPoint> corner_of_input = made.corner.view().part(0, 3 * of_input),
                         corner_of_sheet = made.corner.view().part(3 * of_input, 3 * of_sheet);
  if (exact.triangles.empty())
    exec.for_each("snapped triangles", of_input,
                  PutSnapped{to_voxels, surface.points.view(), surface.triangles.view(), corner_of_input});
  else
    exec.for_each("exact triangles", of_input, PutExact{to_voxels, exact, surface.source_face.view(), corner_of_input});
  exec.for_each("triangles of the sheet", of_sheet,
                PutSnapped{to_voxels, sheet.position.view(), sheet.triangles.view(), corner_of_sheet});
  return made;
}

}  // namespace isoshell
