// Walls between voxels of different labels, and how they are faired, on orderly volumes and on ugly ones.
#include <tbb/task_arena.h>

#include "implicit/labels/fair_walls.h"
#include "implicit/labels/wall_corner.h"
#include "implicit/labels/wall_links.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

std::map<int32_t, int64_t> voxels_of(const LabelVolume& volume) {
  std::map<int32_t, int64_t> count;
  for (const int32_t label : volume.labels)
    if (label != volume.background) ++count[label];
  return count;
}

}  // namespace

TEST_CASE("the walls of any labels bound closed regions that do not cross, and part what voxels part") {
  TestContext context;
  for (uint32_t number = 0; number < 200; ++number) {
    const LabelVolume volume = random_labels(number);
    INFO("random volume " << number);
    if (voxels_of(volume).empty()) continue;
    const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
    REQUIRE(soup.regions.labels.size() == soup.triangles.size());
    const std::string fault = fault_of_regions(soup.triangles, soup.regions);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(pairs_of(soup.regions) == pairs_of(volume));
    CHECK(take_census(mesh_of(soup), context).intersecting_pairs == 0);
    for (const auto& [label, world] : volumes_of_regions(soup.vertices, soup.triangles, soup.regions)) {
      INFO("region " << label);
      CHECK(world > 0);
    }
  }
}

TEST_CASE("a single voxel is a region of six faces around its centre") {
  LabelVolume volume = label_volume(3, 3, 3);
  volume.labels[13] = 5;
  volume.origin_world = {10, 20, 30};
  volume.step_world = {WorldPoint{2, 0, 0}, WorldPoint{0, 2, 0}, WorldPoint{0, 0, 2}};
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  CHECK(soup.triangles.size() == 12);
  CHECK(soup.vertices.size() == 8);
  WorldPoint sum{0, 0, 0};
  for (const WorldPoint& p : soup.vertices) sum = {sum.x + p.x, sum.y + p.y, sum.z + p.z};
  CHECK(sum.x / 8 == 12);
  CHECK(sum.y / 8 == 22);
  CHECK(sum.z / 8 == 32);
  for (const auto& pair : soup.regions.labels) CHECK(pair == std::array<int32_t, 2>{5, 0});
}

TEST_CASE("regions keep the volumes of their voxels, as grains and as thin sheets") {
  const auto sheet = [](double thickness, double wave) {
    return label_volume(40, 40, 40, [=](int x, int y, int z) {
      const double height = z - 12 - 0.3 * x - 0.15 * y - wave * std::sin(0.2 * x) * std::cos(0.15 * y);
      return height < 0 ? 1 : height < thickness ? 2 : 3;
    });
  };
  TestContext context;
  for (const LabelVolume& volume : {voronoi_grains(40, 12), sheet(1, 0), sheet(1, 3), sheet(2, 0), sheet(2, 3)}) {
    const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
    CHECK(take_census(mesh_of(soup), context).intersecting_pairs == 0);
    const auto voxels = voxels_of(volume);
    for (const auto& [label, world] : volumes_of_regions(soup.vertices, soup.triangles, soup.regions)) {
      INFO("region " << label << " of " << voxels.at(label) << " voxels");
      CHECK_THAT(world, Catch::Matchers::WithinRel(double(voxels.at(label)), 0.01));
    }
  }
}

TEST_CASE("faired walls stay near the planes between grains") {
  // Two regions that a slanted plane parts: what fairing leaves of its steps is below a tenth of a voxel.
  const auto height = [](double x, double y, double z) {
    return (z - 0.37 * x - 0.21 * y - 6) / std::hypot(1, 0.37, 0.21);
  };
  const LabelVolume volume =
      label_volume(32, 32, 32, [&](int x, int y, int z) { return height(x + 0.5, y + 0.5, z + 0.5) < 0 ? 1 : 2; });
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  double sum = 0, count = 0;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (const uint32_t v : soup.triangles[t]) {
      const WorldPoint p = soup.vertices[v];
      if (soup.regions.labels[t][1] != 2 || std::min(p.x, p.y) < 3 || std::max(p.x, p.y) > 28) continue;
      sum += std::pow(height(p.x + 0.5, p.y + 0.5, p.z + 0.5), 2);
      ++count;
    }
  CHECK(count > 1000);
  CHECK(std::sqrt(sum / count) < 0.1);
}

TEST_CASE("walls at the sides of a volume are flat, its edges straight and its corners where they are") {
  const TriangleSoup soup = surface_of_labels(voronoi_grains(24, 7), "labels", 0);
  const double low = -0.5, high = 23.5;
  int64_t corners = 0;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (const uint32_t v : soup.triangles[t]) {
      const WorldPoint p = soup.vertices[v];
      const int sides = (p.x == low || p.x == high) + (p.y == low || p.y == high) + (p.z == low || p.z == high);
      if (soup.regions.labels[t][1] == 0) REQUIRE(sides > 0);
      CHECK(std::min({p.x, p.y, p.z}) >= low);
      CHECK(std::max({p.x, p.y, p.z}) <= high);
      corners += sides == 3 ? 1 : 0;
    }
  CHECK(corners >= 8);
}

TEST_CASE("a wall to background inside of a volume is straight up to the volume's sides") {
  const TriangleSoup soup =
      surface_of_labels(label_volume(24, 24, 24, [](int x, int, int) { return x < 12 ? 1 : 0; }), "labels", 0);
  for (const WorldPoint& p : soup.vertices)
    if (p.x > 11) CHECK(std::abs(p.x - 11.5) < 0.05);
}

TEST_CASE("curves between grains stay apart where they run side by side") {
  const CpuContext context;
  const LabelWalls walls = find_label_walls(voronoi_grains(64, 60), context);
  const std::vector<PointQ8> position = fair_walls(walls, 0.5, context);
  const WallLinks links(walls, faces_at_vertices(walls));
  int64_t pairs = 0;
  int32_t least_q8 = kOneVoxelQ8;
  for (const auto& face : walls.faces)
    for (size_t i = 0; i < 2; ++i) {
      if (face[3] == kNone || !links.is_strip_between(face[i], face[i + 2], face)) continue;
      const PointQ8 &p = position[face[i]], &q = position[face[i + 2]];
      least_q8 = std::min(least_q8, std::max({std::abs(p.x - q.x), std::abs(p.y - q.y), std::abs(p.z - q.z)}));
      ++pairs;
    }
  CHECK(pairs > 100);
  CHECK(least_q8 >= kOneVoxelQ8 * 3 / 8);
}

TEST_CASE("a mirrored volume has the same regions, which look outward still") {
  LabelVolume volume = voronoi_grains(12, 5);
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  volume.step_world[1] = {0, -1, 0};
  const TriangleSoup mirrored = surface_of_labels(volume, "labels", 0);
  const auto volumes = volumes_of_regions(soup.vertices, soup.triangles, soup.regions);
  for (const auto& [label, world] : volumes_of_regions(mirrored.vertices, mirrored.triangles, mirrored.regions))
    CHECK_THAT(world, Catch::Matchers::WithinRel(volumes.at(label), 1e-9));
}

TEST_CASE("walls do not depend on the number of threads") {
  const LabelVolume volume = voronoi_grains(24, 20);
  const auto walls_with = [&](int threads) {
    tbb::task_arena arena(threads);
    return arena.execute([&] { return surface_of_labels(volume, "labels", 0); });
  };
  const TriangleSoup one = walls_with(1), two = walls_with(2);
  CHECK(one.triangles == two.triangles);
  CHECK(one.regions.labels == two.regions.labels);
  bool are_equal = one.vertices.size() == two.vertices.size();
  for (size_t v = 0; are_equal && v < one.vertices.size(); ++v)
    are_equal = one.vertices[v].x == two.vertices[v].x && one.vertices[v].y == two.vertices[v].y &&
                one.vertices[v].z == two.vertices[v].z;
  CHECK(are_equal);
}

TEST_CASE("walls that touch in a lattice edge are parted there, and each of both pairs has a vertex of its own") {
  const LabelVolume volume = label_volume(2, 2, 1, [](int i, int j, int) { return i == j ? 1 : 0; });
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  const std::string fault = fault_of_regions(soup.triangles, soup.regions);
  INFO(fault);
  CHECK(fault.empty());
  const WallEdge edge({1, 0, 1, 0});
  CHECK(edge.is_parted);
  CHECK_FALSE(edge.is_odd_alone);  // the smaller label stays connected: the background
}

TEST_CASE("islands of few voxels get the label around them, and no region is lost") {
  LabelVolume volume = label_volume(16, 16, 16, [](int i, int j, int k) {
    if (i == 3 && j == 3 && k == 3) return 2;              // a speck of a region that is elsewhere, too
    if (i == 12 && j == 12 && k == 12) return 3;           // all that there is of its region
    if (i == 5 && j == 9 && (k == 4 || k == 5)) return 0;  // a hole
    return i < 8 ? 1 : 2;
  });
  volume.smallest_island_vox = 8;
  std::vector<std::string> told;
  const TriangleSoup soup =
      surface_of_labels(volume, "labels", 0, [&](MessageKind, const std::string& text) { told.push_back(text); });
  REQUIRE(told.size() == 1);
  CHECK(told[0] == "2 islands of fewer than 8 voxels, 3 in all, got the label around them");
  const std::set<std::array<int32_t, 2>> pairs{{0, 1}, {0, 2}, {1, 2}, {2, 3}};
  CHECK(pairs_of(soup.regions) == pairs);
  const auto volumes = volumes_of_regions(soup.vertices, soup.triangles, soup.regions);
  CHECK(volumes.size() == 3);
}

TEST_CASE("regions that touched in an island alone are named") {
  LabelVolume volume = label_volume(12, 6, 6, [](int i, int j, int k) {
    if (i == 6 && j == 3 && k == 3) return 1;
    return i < 5 ? 1 : i < 7 ? 2 : 3;
  });
  volume.names = {{3, "skin"}};
  volume.smallest_island_vox = 8;
  std::vector<std::string> told;
  const TriangleSoup soup =
      surface_of_labels(volume, "labels", 0, [&](MessageKind, const std::string& text) { told.push_back(text); });
  REQUIRE(told.size() == 2);
  CHECK(told[1] == "regions that touched in such islands alone touch no more: 1 and 3 (skin)");
  CHECK(soup.absorbed_walls == std::vector<std::array<int32_t, 2>>{{1, 3}});
}

TEST_CASE("labels tell how far they are, and stop where the context is cancelled") {
  const LabelVolume volume = voronoi_grains(24, 6);
  CpuContext context;
  std::vector<double> told;
  context.progress = [&](const char* stage, double done) {
    CHECK(std::string(stage) == "read");
    told.push_back(done);
  };
  surface_of_labels(volume, "labels", context);
  CHECK(told.size() > 20);
  CHECK(std::is_sorted(told.begin(), told.end()));
  CHECK((told.front() == 0 && told.back() == 1));
  for (const double when : {0., told[1], told[2], .5, .75}) {
    INFO("cancelled when " << when << " is done");
    context.cancel = false;
    int more = 0;
    context.progress = [&](const char*, double done) {
      more += context.cancel ? 1 : 0;
      if (done >= when) context.cancel = true;
    };
    CHECK(error_of([&] { surface_of_labels(volume, "labels", context); }).code() == ErrorCode::interrupted);
    CHECK(more == 0);
  }
}

TEST_CASE("a volume of labels that is none is refused with what is wrong") {
  LabelVolume volume = label_volume(2, 2, 2);
  CHECK(contains(message_of(ErrorCode::nothing_to_mesh, [&] { surface_of_labels(volume, "seg.vdb", 0); }),
                 "seg.vdb: all its voxels are background, 0"));
  volume.labels.pop_back();
  CHECK(contains(message_of(ErrorCode::usage, [&] { surface_of_labels(volume, "seg.vdb", 0); }),
                 "7 labels for 8 voxels"));
  volume = voronoi_grains(8, 3);
  volume.step_world[2] = {1, 0, 0};
  CHECK(contains(message_of(ErrorCode::usage, [&] { surface_of_labels(volume, "seg.vdb", 0); }), "span no volume"));
  volume = voronoi_grains(24, 30);
  CHECK(contains(message_of(ErrorCode::out_of_memory, [&] { surface_of_labels(volume, "seg.vdb", 100000); }),
                 "more than the limit"));
}
