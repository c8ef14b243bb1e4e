// Small meshes with curves, cut along them, with seeds and their dual: what comes after relaxation in patches.
#pragma once

#include <utility>

#include "features/cutting/curve_seeds.h"
#include "features/cutting/free_seeds.h"
#include "support/feature_shapes.h"

namespace isoshell {

struct MadePatches {
  CutSurface cut;
  Triangulation mesh;
};

/// With 400 vertices, whose seeds were relaxed in so many passes: after few of them cells have all shapes.
inline MadePatches made_patches(const FeatureShape& shape, int32_t passes, Context& context) {
  constexpr int64_t kVertices = 400;
  TriangleSoup soup;
  soup.vertices = shape.mesh.vertices;
  soup.triangles = shape.mesh.triangles;
  const auto [lo, hi] = bounding_box(soup);
  const CutOptions options{edge_length_for(shape.mesh, shape.network, kVertices), 0};
  CutSurface cut = cut_surface(shape.mesh, shape.network, LatticeFrame::around(lo, hi, 50), options, context);
  const FreeSeeds free(cut);
  SeedSet fixed = seeds_on_curves(cut, 0);
  const FreeSeeds::Counts counts = free.counts(fixed, kVertices);
  SeedSet seeds = relax_on_sheet(cut.surface, free.add(std::move(fixed), counts, 1), {passes}, context).seeds;
  Triangulation made = triangulate_dual(cut.surface, std::move(seeds), {}, context);
  return {std::move(cut), std::move(made)};
}

}  // namespace isoshell
