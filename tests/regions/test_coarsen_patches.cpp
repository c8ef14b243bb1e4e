// Walls of which some are relaxed and others coarsened.
#include <algorithm>
#include <array>
#include <set>

#include "features/walls/coarsen_patches.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "measure/crossings.h"
#include "pipeline/patches/mesh_patches.h"
#include "pipeline/regions/region_walls.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// Walls whose patches are relaxed and put together, those that are wrong among them.
struct RelaxedWalls {
  RelaxedWalls(const LabelVolume& volume, int64_t vertices, Context& context) {
    RemeshOptions options;
    options.vertices = vertices;
    const PreparedSurface p = prepare_regions(surface_of_labels(volume, "labels", 0), options, report, context);
    cut = p.cut;
    PatchOptions in_patches;
    in_patches.seeds.count = cut->seeds;
    join.vertices = cut->seeds;
    SeededMesh made{{}, relax_in_patches(*cut, in_patches, context).seeds};
    is_wrong = mesh_patches(p, *cut, made, in_patches, report, context).is_wrong;
    mesh.emplace(*cut, made, join);
  }

  RemeshReport report;
  std::shared_ptr<const CutSurface> cut;
  std::vector<char> is_wrong;
  JoinOptions join{0};
  std::optional<PatchMesh> mesh;
};

/// Until no more patches come to be coarse.
JoinedPatches coarsened(const RelaxedWalls& relaxed, std::vector<char>& is_coarse, const Context& context) {
  for (size_t round = 0; round <= is_coarse.size(); ++round)
    if (const auto mesh = coarsen_patches(*relaxed.cut, *relaxed.mesh, is_coarse, relaxed.join, context))
      return mesh->joined();
  FAIL("no more patches came to be coarse, and there is no mesh");
  return {};
}

std::vector<char> every(size_t step, size_t count) {
  std::vector<char> out(count, 0);
  for (size_t i = 0; i < count; i += step) out[i] = 1;
  return out;
}

std::string fault_of(const JoinedPatches& joined, const CutSurface& cut) {
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const TriangleIndices& t : joined.mesh.triangles) triangles.push_back({t.a, t.b, t.c});
  FaceRegions regions;
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  for (const uint32_t patch : joined.features.patch) regions.labels.push_back(labels[patch]);
  return fault_of_regions(triangles, regions);
}

size_t crossings_of(const JoinedPatches& joined, const Context& context) {
  return crossing_pairs(joined.mesh.position.view(), joined.mesh.triangles.view(), {}, context.cancel).size();
}

using Place = std::array<int32_t, 3>;

Place place(const JoinedPatches& joined, uint32_t v) {
  const PointQ8 p = joined.mesh.position[v];
  return {p.x, p.y, p.z};
}

/// The triangles of patches that are not coarse: the patch, and where the corners are, from the least one on.
std::multiset<std::pair<uint32_t, std::array<Place, 3>>> relaxed_triangles(const JoinedPatches& joined,
                                                                           const std::vector<char>& is_coarse) {
  std::multiset<std::pair<uint32_t, std::array<Place, 3>>> out;
  for (size_t t = 0; t < joined.features.patch.size(); ++t) {
    if (is_coarse[joined.features.patch[t]]) continue;
    const TriangleIndices& i = joined.mesh.triangles[int64_t(t)];
    std::array<Place, 3> places{place(joined, i.a), place(joined, i.b), place(joined, i.c)};
    std::rotate(places.begin(), std::min_element(places.begin(), places.end()), places.end());
    out.insert({joined.features.patch[t], places});
  }
  return out;
}

/// The edges of curves beside patches that are not coarse.
std::set<std::pair<uint32_t, std::array<Place, 2>>> curve_edges(const JoinedPatches& joined, const CutSurface& cut,
                                                                const std::vector<char>& is_coarse) {
  std::set<uint32_t> curves;
  for (const CutCurve& curve : cut.curves)
    for (const uint32_t patch : curve.patches)
      if (!is_coarse[patch]) curves.insert(curve.curve);
  std::set<std::pair<uint32_t, std::array<Place, 2>>> out;
  for (const MeshCurveEdge& edge : joined.features.curve_edges) {
    const Place a = place(joined, edge.vertex[0]), b = place(joined, edge.vertex[1]);
    if (curves.count(edge.curve) > 0) out.insert({edge.curve, {std::min(a, b), std::max(a, b)}});
  }
  return out;
}

}  // namespace

TEST_CASE("patches that are coarsened fit the relaxed ones beside them, which stay as they are") {
  TestContext context;
  const RelaxedWalls relaxed(voronoi_grains(32, 12), 1500, context);
  REQUIRE(std::count(relaxed.is_wrong.begin(), relaxed.is_wrong.end(), 1) == 0);
  const JoinedPatches before = relaxed.mesh->joined();
  for (const size_t step : {2, 5, 40}) {
    INFO("every patch of " << step);
    std::vector<char> is_coarse = every(step, patch_count(*relaxed.cut));
    const JoinedPatches joined = coarsened(relaxed, is_coarse, context);
    CHECK(std::count(is_coarse.begin(), is_coarse.end(), 0) > 0);
    CHECK(joined.mesh.position.size() == before.mesh.position.size());
    CHECK(fault_of(joined, *relaxed.cut).empty());
    CHECK(crossings_of(joined, context) == 0);
    CHECK(relaxed_triangles(joined, is_coarse) == relaxed_triangles(before, is_coarse));
    CHECK(curve_edges(joined, *relaxed.cut, is_coarse) == curve_edges(before, *relaxed.cut, is_coarse));
  }
}

TEST_CASE("patches of ugly labels that are coarsened fit those beside them, or these are, too") {
  TestContext context;
  for (uint32_t number = 0; number < 200; number += 8) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    INFO("random volume " << number);
    const RelaxedWalls relaxed(volume, 300, context);
    std::vector<char> is_coarse = every(3, patch_count(*relaxed.cut));
    for (size_t p = 0; p < is_coarse.size(); ++p) is_coarse[p] |= relaxed.is_wrong[p];
    const JoinedPatches joined = coarsened(relaxed, is_coarse, context);
    const std::string fault = fault_of(joined, *relaxed.cut);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(crossings_of(joined, context) == 0);
  }
}

TEST_CASE("patches that are coarsened are the same with any number of threads") {
  CpuContext one, four;
  one.threads = 1;
  four.threads = 4;
  const RelaxedWalls relaxed(voronoi_grains(32, 12), 1500, one);
  std::vector<char> a = every(3, patch_count(*relaxed.cut)), b = a;
  const JoinedPatches of_one = coarsened(relaxed, a, one), of_four = coarsened(relaxed, b, four);
  CHECK(a == b);
  const std::vector<char> none(a.size(), 0);
  CHECK(relaxed_triangles(of_one, none) == relaxed_triangles(of_four, none));
}

TEST_CASE("walls that cannot be relaxed are coarsened alone, and a warning says how many") {
  TestContext context;
  const LabelVolume volume = random_labels(38);
  RemeshOptions options;
  options.vertices = 500;
  const RemeshResult result = remesh(surface_of_labels(volume, "labels", 0), options, context);
  const auto count_warnings = [&](const std::string& part) {
    return std::count_if(result.report.warnings.begin(), result.report.warnings.end(),
                         [&](const std::string& text) { return text.find(part) != std::string::npos; });
  };
  CHECK(count_warnings(" walls the edges between regions were collapsed and flipped") == 1);
  CHECK(count_warnings("collapsed and flipped") == 1);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(result.mesh.vertices.size() == 500);
  CHECK(fault_of_regions(result.mesh.triangles, result.mesh.regions).empty());
  CHECK(take_census(result.mesh, context).intersecting_pairs == 0);
}
