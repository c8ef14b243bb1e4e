// Walls of which some are relaxed and others coarsened.
#include <algorithm>
#include <array>
#include <set>

#include "features/walls/coarsen_patches.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "measure/crossings.h"
#include "pipeline/patches/patch_rounds.h"
#include "pipeline/regions/region_walls.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

constexpr int64_t kVertices = 1500;

/// The walls of grains, relaxed, and put together.
struct RelaxedGrains {
  explicit RelaxedGrains(Context& context) {
    RemeshOptions options;
    options.vertices = kVertices;
    const PreparedSurface p =
        prepare_regions(surface_of_labels(voronoi_grains(32, 12), "labels", 0), options, report, context);
    cut = p.cut;
    PatchOptions in_patches;
    in_patches.seeds.count = cut->seeds;
    SeededMesh made{{}, relax_in_patches(*cut, in_patches, context).seeds};
    REQUIRE(mesh_once(p, *cut, made, in_patches, report, context).what.empty());
    mesh.emplace(*cut, made, JoinOptions{kVertices});
  }

  RemeshReport report;
  std::shared_ptr<const CutSurface> cut;
  std::optional<PatchMesh> mesh;
};

/// Until no more patches come to be coarse.
JoinedPatches coarsened(const RelaxedGrains& relaxed, std::vector<char>& is_coarse, Context& context) {
  for (;;)
    if (const auto mesh = coarsen_patches(*relaxed.cut, *relaxed.mesh, is_coarse, {kVertices}, context))
      return mesh->joined();
}

std::string fault_of(const JoinedPatches& joined, const CutSurface& cut) {
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const TriangleIndices& t : joined.mesh.triangles) triangles.push_back({t.a, t.b, t.c});
  FaceRegions regions;
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  for (const uint32_t patch : joined.features.patch) regions.labels.push_back(labels[patch]);
  return fault_of_regions(triangles, regions);
}

using Place = std::array<int32_t, 3>;
using Places = std::array<Place, 3>;

Place place(const JoinedPatches& joined, uint32_t v) {
  const PointQ8 p = joined.mesh.position[v];
  return {p.x, p.y, p.z};
}

/// The triangles of patches that are not coarse, by where their corners are.
std::multiset<Places> relaxed_triangles(const JoinedPatches& joined, const std::vector<char>& is_coarse) {
  std::multiset<Places> out;
  for (size_t t = 0; t < joined.features.patch.size(); ++t) {
    if (is_coarse[joined.features.patch[t]]) continue;
    const TriangleIndices& i = joined.mesh.triangles[int64_t(t)];
    Places places{place(joined, i.a), place(joined, i.b), place(joined, i.c)};
    std::sort(places.begin(), places.end());
    out.insert(places);
  }
  return out;
}

}  // namespace

TEST_CASE("patches that are coarsened fit the relaxed ones beside them, which stay as they are") {
  TestContext context;
  const RelaxedGrains relaxed(context);
  for (const uint32_t step : {2u, 5u, 40u}) {
    INFO("every patch of " << step);
    std::vector<char> is_coarse(patch_count(*relaxed.cut), 0);
    for (size_t p = 0; p < is_coarse.size(); p += step) is_coarse[p] = 1;
    const JoinedPatches joined = coarsened(relaxed, is_coarse, context);
    CHECK(std::count(is_coarse.begin(), is_coarse.end(), 0) > 0);
    CHECK(joined.mesh.position.size() <= kVertices);
    CHECK(joined.mesh.position.size() > 0.95 * kVertices);
    CHECK(fault_of(joined, *relaxed.cut).empty());
    CHECK(crossing_pairs(joined.mesh.position.view(), joined.mesh.triangles.view(), {}, context.cancel).size() == 0);
    CHECK(relaxed_triangles(joined, is_coarse) == relaxed_triangles(relaxed.mesh->joined(), is_coarse));
  }
}

TEST_CASE("patches that are coarsened are the same with any number of threads") {
  CpuContext one, four;
  one.threads = 1;
  four.threads = 4;
  const RelaxedGrains relaxed(one);
  std::vector<char> a(patch_count(*relaxed.cut), 0);
  for (size_t p = 0; p < a.size(); p += 3) a[p] = 1;
  std::vector<char> b = a;
  const JoinedPatches of_one = coarsened(relaxed, a, one), of_four = coarsened(relaxed, b, four);
  CHECK(a == b);
  const std::vector<char> none(a.size(), 0);
  CHECK(relaxed_triangles(of_one, none) == relaxed_triangles(of_four, none));
}

TEST_CASE("walls that cannot be relaxed are coarsened alone, and a warning says how many") {
  TestContext context;
  const LabelVolume volume = random_labels(10);
  RemeshOptions options;
  options.vertices = 500;
  const RemeshResult result = remesh(surface_of_labels(volume, "labels", 0), options, context);
  CHECK(std::any_of(result.report.warnings.begin(), result.report.warnings.end(), [](const std::string& text) {
    return text.find("in ") == 0 && text.find(" walls the edges between regions were collapsed") != std::string::npos;
  }));
  CHECK(fault_of_regions(result.mesh.triangles, result.mesh.regions).empty());
  CHECK(take_census(result.mesh, context).intersecting_pairs == 0);
}
