// Walls with fewer vertices, whatever they are like.
#include <algorithm>
#include <cmath>

#include "features/walls/coarsen.h"
#include "features/walls/coarsen_walls.h"
#include "features/walls/near_walls.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "measure/crossings.h"
#include "pipeline/regions/region_walls.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

struct Coarse {
  JoinedPatches joined;
  FaceRegions regions;
  int64_t before = 0;  ///< vertices
};

PreparedSurface prepared(const LabelVolume& volume, int64_t vertices, Context& context) {
  RemeshOptions options;
  options.vertices = vertices;
  Run run{context};
  return prepare_regions(surface_of_labels(volume, "labels", 0), options, run);
}

WallMesh walls_of(const PreparedSurface& p) {
  const FeatureMesh& walls = p.walls->mesh;
  return {*p.cut, {walls.triangles, walls.source_face, walls.vertices.size()}};
}

Coarse coarsened(const LabelVolume& volume, int64_t vertices, Context& context) {
  const PreparedSurface p = prepared(volume, vertices, context);
  WallMesh mesh = walls_of(p);
  coarsen_walls(mesh, vertices, context);
  const auto lookup = mesh.shared_lookup();
  Coarse out{PatchMesh(lookup, std::move(mesh), {vertices}).joined(), {}, 0};
  out.before = int64_t(p.walls->mesh.vertices.size());
  out.regions.background = volume.background;
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(*p.cut);
  for (const uint32_t patch : out.joined.features.patch) out.regions.labels.push_back(labels[patch]);
  return out;
}

std::string fault_of(const Coarse& coarse) {
  std::vector<std::array<uint32_t, 3>> triangles;
  for (const TriangleIndices& t : coarse.joined.mesh.triangles) triangles.push_back({t.a, t.b, t.c});
  return fault_of_regions(triangles, coarse.regions);
}

size_t crossings_of(const Coarse& coarse, const Context& context) {
  const DualMesh& mesh = coarse.joined.mesh;
  return crossing_pairs(mesh.position.view(), mesh.triangles.view(), {}, context.cancel).size();
}

}  // namespace

TEST_CASE("coarsened walls have the vertices that were asked for, and good triangles") {
  TestContext context;
  const LabelVolume volume = voronoi_grains(32, 12);
  const Coarse coarse = coarsened(volume, 1500, context);
  CHECK(coarse.before > 6000);
  CHECK(coarse.joined.mesh.position.size() == 1500);
  CHECK(fault_of(coarse).empty());
  CHECK(pairs_of(coarse.regions) == pairs_of(volume));
  CHECK(crossings_of(coarse, context) == 0);
  double sum = 0;
  const DualMesh& mesh = coarse.joined.mesh;
  const auto at = [&](uint32_t v) {
    const PointQ8 p = mesh.position[v];
    return WorldPoint{double(p.x), double(p.y), double(p.z)};
  };
  for (const TriangleIndices& t : mesh.triangles) sum += smallest_sine(at(t.a), at(t.b), at(t.c));
  CHECK(sum / double(mesh.triangles.size()) > 0.68);  // 43 degrees
}

TEST_CASE("coarsened walls are the same with any number of threads, and so are those of many blocks") {
  const LabelVolume volume = voronoi_grains(48, 20);
  CpuContext one, four;
  one.threads = 1;
  four.threads = 4;
  const Coarse a = coarsened(volume, 1200, one), b = coarsened(volume, 1200, four);
  const auto is_same = [](const PointQ8& p, const PointQ8& q) { return p.x == q.x && p.y == q.y && p.z == q.z; };
  const Buffer<PointQ8>&p = a.joined.mesh.position, &q = b.joined.mesh.position;
  REQUIRE(p.size() == 1200);
  CHECK(std::equal(p.begin(), p.end(), q.begin(), q.end(), is_same));
  CHECK(a.regions.labels == b.regions.labels);
  CHECK(a.before > 12 * p.size());
}

TEST_CASE("walls that bend nearer to one another than half an edge are coarsened without being relaxed before") {
  TestContext context;
  const auto share = [&](const LabelVolume& volume, int64_t vertices) {
    return share_of_near_walls(*prepared(volume, vertices, context).cut, vertices);
  };
  const auto waves = [](int32_t n) {
    return label_volume(n, n, 24, [](int i, int j, int k) {
      return 5 + int(std::floor((k + 4 * std::sin(i / 3.) * std::cos(j / 3.)) / 2));
    });
  };
  const LabelVolume layers = label_volume(40, 40, 40, [](int, int, int k) { return 1 + k / 3; });
  CHECK(share(waves(32), 1000) > 0.3);
  CHECK(share(waves(32), 40000) < 0.1);
  CHECK(share(layers, 1000) < 0.05);  // flat triangles never meet, however near
  CHECK(share(voronoi_grains(40, 20), 500) < 0.05);

  RemeshOptions options;
  options.vertices = 10000;
  const RemeshResult result = remesh(surface_of_labels(waves(88), "labels", 0), options, context);
  CHECK(result.mesh.vertices.size() == 10000);
  CHECK(result.report.relax.passes == 0);
  CHECK(std::any_of(result.report.warnings.begin(), result.report.warnings.end(), [](const std::string& text) {
    return text.find("nearer to one another than half an edge") != std::string::npos;
  }));
}

TEST_CASE(
    "a folded layer that edges are longer than thick becomes regions with the vertices asked for and no crossings") {
  TestContext context;
  const LabelVolume volume = folded_layer(64, 12);
  RemeshOptions options;
  options.vertices = 10000;
  const RemeshResult result = remesh(surface_of_labels(volume, "labels", 0), options, context);
  CHECK(result.mesh.vertices.size() == 10000);
  CHECK(fault_of_regions(result.mesh.triangles, result.mesh.regions).empty());
  CHECK(take_census(result.mesh, context).intersecting_pairs == 0);
  for (const auto& [label, world] :
       volumes_of_regions(result.mesh.vertices, result.mesh.triangles, result.mesh.regions)) {
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    if (label != 0) CHECK(std::abs(world / voxels - 1) < 0.01);
  }
}

TEST_CASE("coarsened walls of ugly labels stay closed, keep all pairs of regions and never meet") {
  TestContext context;
  for (uint32_t number = 0; number < 200; number += 3) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    INFO("random volume " << number);
    const Coarse coarse = coarsened(volume, 50, context);
    const std::string fault = fault_of(coarse);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(pairs_of(coarse.regions) == pairs_of(volume));
    CHECK(crossings_of(coarse, context) == 0);
    CHECK(coarse.joined.mesh.position.size() <= std::max<int64_t>(50, coarse.before));
  }
}

TEST_CASE("where walls keep more vertices than were asked for, none of their edges can be collapsed") {
  constexpr int64_t kFew = 50;
  TestContext context;
  int more = 0;
  for (uint32_t number = 0; number < 200; number += 3) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    const PreparedSurface p = prepared(volume, kFew, context);
    WallMesh mesh = walls_of(p);
    coarsen(mesh, kFew, context);
    if (mesh.vertex_count() <= kFew) continue;
    ++more;
    INFO("random volume " << number << " of " << mesh.vertex_count() << " vertices");
    std::vector<uint32_t> targets;
    MeshChange change;
    int collapsed = 0;
    for (uint32_t v = 0; v < mesh.vertices().size(); ++v) {
      mesh.list_targets(v, targets);
      for (const uint32_t into : targets) collapsed += mesh.collapse(v, into, change, WallMesh::Shapes::any) ? 1 : 0;
    }
    CHECK(collapsed == 0);
  }
  CHECK(more > 10);
}
