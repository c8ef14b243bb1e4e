// Cut surfaces with fewer triangles, and seeds that come back from them.
#include <set>

#include "features/cutting/coarser_surface.h"
#include "support/catch.h"
#include "support/made_patches.h"
#include "voxel/exact_int.h"

using namespace isoshell;

namespace {

struct Coarse {
  CutSurface cut;
  FreeSeeds::Counts seeds;
  CoarserSurface surface;
};

Coarse coarse_of(const FeatureShape& shape, int levels, Context& context) {
  Coarse out{made_patches(shape, 1, context).cut, {}, {}};
  const FreeSeeds free(out.cut);
  const SeedSet fixed = seeds_on_curves(out.cut, 0);
  out.seeds = free.counts(fixed, 400);
  if (levels > 0) out.seeds = free.coarser(seeds_on_curves(out.cut, levels), out.seeds);
  out.surface = coarser_surface(out.cut, out.seeds, levels, context);
  return out;
}

int64_t euler_of(const SurfaceMesh& surface) {
  std::set<std::pair<uint32_t, uint32_t>> edges;
  for (const TriangleIndices& t : surface.triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, std::pair{t.b, t.c}, std::pair{t.c, t.a}})
      edges.insert({std::min(u, v), std::max(u, v)});
  return surface.vertex_count() - int64_t(edges.size()) + surface.triangles.size();
}

}  // namespace

TEST_CASE("coarser surfaces: vertices are some of the finer one's, patches stay what they are",
          "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : feature_shapes())
    for (const int levels : {0, 1}) {
      INFO(shape.name << ", " << levels << " levels coarser");
      const Coarse made = coarse_of(shape, levels, context);
      const CutSurface &finer = made.cut, &coarser = made.surface.cut;
      CHECK(coarser.surface.vertex_count() < finer.surface.vertex_count());
      CHECK(euler_of(coarser.surface) == euler_of(finer.surface));
      REQUIRE(patch_count(coarser) == patch_count(finer));
      std::vector<int64_t> inside(patch_count(finer), 0);
      for (uint32_t v = 0; v < coarser.place.size(); ++v) {
        const uint32_t there = made.surface.in_finer[v];
        const PointQ8 p = coarser.surface.position[v], q = finer.surface.position[there];
        REQUIRE((p.x == q.x / 2 && p.y == q.y / 2 && p.z == q.z / 2));
        REQUIRE(coarser.surface.patch[v] == finer.surface.patch[there]);
        REQUIRE(coarser.place[v] == finer.place[there]);
        const bool is_on_border = !coarser.surface.is_closed() && coarser.surface.border_before[v] != kNone;
        REQUIRE((coarser.place[v] != kNone) == is_on_border);
        inside[coarser.surface.patch[v]] += coarser.place[v] == kNone ? 1 : 0;
      }
      for (size_t p = 0; p < inside.size(); ++p) CHECK(inside[p] >= 2 * made.seeds[p]);
    }
}

TEST_CASE("coarser surfaces: their curves have the seeds of the level", "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : feature_shapes())
    for (const int levels : {0, 1}) {
      INFO(shape.name << ", " << levels << " levels coarser");
      const Coarse made = coarse_of(shape, levels, context);
      const SeedSet fixed = seeds_on_curves(made.cut, levels), coarser = seeds_on_curves(made.surface.cut, 0);
      std::set<uint32_t> homes(fixed.home.begin(), fixed.home.end()), homes_of_coarser;
      for (const uint32_t home : coarser.home) homes_of_coarser.insert(made.surface.in_finer[home]);
      CHECK(homes == homes_of_coarser);
    }
}

TEST_CASE("coarser surfaces: seeds that relaxed there go on where they are on the finer one", "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : {feature_cube(), feature_cylinder(40)}) {
    INFO(shape.name);
    const Coarse made = coarse_of(shape, 0, context);
    const CutSurface& on = made.surface.cut;
    SeedSet seeds = FreeSeeds(on).add(seeds_on_curves(on, 0), made.seeds, 1);
    SeededMesh mesh{{}, relax_on_sheet(on.surface, std::move(seeds), {10}, context).seeds};
    bring_to_finer(made.surface, mesh);
    const SeedSet finer = FreeSeeds(made.cut).add_finer(seeds_on_curves(made.cut, 0), made.seeds, mesh, 1);
    REQUIRE(finer.size() == mesh.seeds.size());
    for (int64_t s = finer.fixed.count; s < finer.size(); ++s) {
      CHECK(finer.home[s] == mesh.seeds.home[s]);
      CHECK(double(distance_sq_q16(finer.position[s], made.cut.surface.position[finer.home[s]])) <
            made.cut.longest_edge_q8 * made.cut.longest_edge_q8);
    }
  }
}

TEST_CASE("coarser surfaces: the same for any number of threads", "[cut_surface][stage]") {
  std::vector<TriangleIndices> triangles;
  for (const int threads : {1, 2, 5}) {
    Context context;
    context.threads = threads;
    const Coarse made = coarse_of(feature_cylinder(40), 0, context);
    const Buffer<TriangleIndices>& now = made.surface.cut.surface.triangles;
    if (triangles.empty()) triangles.assign(now.begin(), now.end());
    CHECK(std::equal(
        now.begin(), now.end(), triangles.begin(), triangles.end(),
        [](const TriangleIndices& s, const TriangleIndices& t) { return s.a == t.a && s.b == t.b && s.c == t.c; }));
  }
}
