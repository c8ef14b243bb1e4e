// Shapes with curves, cut along them, with seeds: for tests of the cut surface and of its seeds.
#pragma once

#include <cmath>
#include <tuple>
#include <utility>

#include "features/cutting/curve_seeds.h"
#include "features/cutting/free_seeds.h"
#include "isoshell/advanced/stages.h"
#include "support/feature_shapes.h"
#include "voxel/exact_int.h"

namespace isoshell::shape_cuts {

inline constexpr double kEdge = 0.6;

inline TriangleSoup soup_of(const FeatureMesh& mesh) {
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  return soup;
}
inline LatticeFrame frame_of(const FeatureMesh& mesh) {
  const auto [lo, hi] = bounding_box(soup_of(mesh));
  return LatticeFrame::around(lo, hi, 50);
}
inline CutSurface cut_of(const FeatureShape& shape, CutOptions options = {kEdge, 0}, int threads = 0) {
  Context context;
  context.threads = threads;
  return cut_surface(shape.mesh, shape.network, frame_of(shape.mesh), options, context);
}
/// With free seeds for so many vertices.
inline SeedSet seeds_of(const CutSurface& cut, int64_t vertices, uint64_t seed) {
  const FreeSeeds free(cut);
  SeedSet fixed = seeds_on_curves(cut, 0);
  const FreeSeeds::Counts counts = free.counts(fixed, vertices);
  return free.add(std::move(fixed), counts, seed);
}
inline double length_q8(PointQ8 a, PointQ8 b) { return std::sqrt(double(distance_sq_q16(a, b))); }

using Place = std::tuple<int32_t, int32_t, int32_t>;
inline Place place_of(PointQ8 p) { return {p.x, p.y, p.z}; }

}  // namespace isoshell::shape_cuts
