// Meshes of regions: closed, conforming, with the count that was asked for.
#include <set>

#include "geometry/world_vector.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/mesh_census.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/remesh.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshResult meshed(const LabelVolume& volume, int64_t vertices, TestContext& context) {
  RemeshOptions options;
  options.vertices = vertices;
  return remesh(surface_of_labels(volume, "labels", 0), options, context);
}

}  // namespace

TEST_CASE("grains become one mesh of closed regions with the vertices that were asked for") {
  TestContext context;
  const LabelVolume volume = voronoi_grains(32, 12);
  const RemeshResult result = meshed(volume, 4000, context);
  const TriangleMesh& mesh = result.mesh;
  CHECK(mesh.vertices.size() == 4000);
  const std::string fault = fault_of_regions(mesh.triangles, mesh.regions);
  INFO(fault);
  CHECK(fault.empty());
  CHECK(pairs_of(mesh.regions) == pairs_of(volume));
  const MeshCensus census = take_census(mesh, context);
  CHECK(census.intersecting_pairs == 0);
  CHECK(census.shapes.q_mean > 0.88);
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)) {
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    CHECK(world > 0.95 * voxels);
    CHECK(world < 1.05 * voxels);
  }
}

TEST_CASE("a volume that regions fill keeps its flat sides, its edges and its corners") {
  TestContext context;
  for (const int64_t vertices : {1500, 250}) {  // for the latter walls are thinned out
    const RemeshResult result = meshed(voronoi_grains(24, 7), vertices, context);
    const TriangleMesh& mesh = result.mesh;
    INFO(vertices << " vertices, " << mesh.vertices.size() << " made");
    double filled = 0;
    for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions))
      if (label != 0) filled += world;
    CHECK(std::abs(filled - 24 * 24 * 24) < 1e-6);
    const double parts = 1 / result.report.grid.frame.voxel_size;  // corners of walls are points of the lattice
    CHECK(std::abs(parts - std::round(parts)) < 1e-9);
  }
}

TEST_CASE("a cube of few vertices, and a result that is meshed again, stay in the box of their volume") {
  TestContext context;
  const TriangleMesh cube = meshed(label_volume(24, 24, 24, [](int, int, int) { return 1; }), 60, context).mesh;
  CHECK(std::abs(volumes_of_regions(cube.vertices, cube.triangles, cube.regions).at(1) - 24 * 24 * 24) < 1e-6);

  TriangleSoup again;
  const TriangleMesh half =
      meshed(label_volume(24, 24, 24, [](int x, int, int) { return x < 12 ? 1 : 0; }), 1500, context).mesh;
  again.vertices = half.vertices;
  again.triangles = half.triangles;
  again.regions = half.regions;
  RemeshOptions options;
  options.vertices = 1000;
  for (const WorldPoint& p : remesh(again, options, context).mesh.vertices) {
    CHECK(std::min({p.x, p.y, p.z}) > -0.501);
    CHECK(std::max(p.y, p.z) < 23.501);
  }
}

TEST_CASE("regions of few slices keep their volumes") {
  TestContext context;
  for (const int slices : {1, 3}) {
    const LabelVolume volume =
        label_volume(36, 36, slices, [](int x, int y, int) { return std::hypot(x - 17.5, y - 17.5) < 15 ? 1 : 0; });
    const TriangleMesh mesh = meshed(volume, 150, context).mesh;
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), 1));
    INFO(slices << " slices");
    CHECK(std::abs(volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions).at(1) / voxels - 1) < 0.005);
  }
}

TEST_CASE("voxels far longer than wide, or turned, are meshed on a lattice that is there") {
  TestContext context;
  LabelVolume volume = voronoi_grains(16, 5);
  for (const double deep : {2., 3., 0.37, 30.}) {
    volume.step_world = {WorldPoint{0, 0.1, 0}, WorldPoint{-0.1, 0, 0}, WorldPoint{0, 0, 0.1 * deep}};
    INFO("steps of .1, .1 and " << 0.1 * deep);
    const RemeshResult result = meshed(volume, 1500, context);
    const double parts = 0.1 / result.report.grid.frame.voxel_size;
    CHECK((std::abs(parts - std::round(parts)) < 1e-9) == (deep != 0.37));
  }
  CHECK_FALSE(meshed(label_volume(8192, 2, 2, [](int, int, int) { return 1; }), 5000, context).mesh.vertices.empty());
}

TEST_CASE("regions keep their volumes, though long edges cut off what is curved") {
  TestContext context;
  const LabelVolume volume = label_volume(32, 32, 32, [](int x, int y, int z) {
    const double from_middle = std::hypot(x - 15.5, y - 15.5, z - 15.5);
    return from_middle < 8 ? 2 : from_middle < 13 ? 1 : 0;
  });
  const TriangleMesh mesh = meshed(volume, 150, context).mesh;
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)) {
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    if (label != 0) CHECK(std::abs(world / voxels - 1) < 0.002);
  }
}

TEST_CASE("regions have the same mesh with any number of threads") {
  const LabelVolume volume = voronoi_grains(20, 8);
  TestContext one, two;
  one.threads = 1;
  two.threads = 2;
  const TriangleMesh a = meshed(volume, 1500, one).mesh, b = meshed(volume, 1500, two).mesh;
  CHECK(a.triangles == b.triangles);
  CHECK(a.regions.labels == b.regions.labels);
  CHECK(std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                   [](const WorldPoint& p, const WorldPoint& q) { return p.x == q.x && p.y == q.y && p.z == q.z; }));
}

TEST_CASE("a run on regions that does not fit its limit is refused before its walls are cut") {
  const TriangleSoup walls = surface_of_labels(voronoi_grains(32, 12), "labels", 0);
  RemeshOptions options;
  options.vertices = 1000;
  TestContext context;
  const InputTopology topology = measure_topology(walls, context).topology;
  const RunEstimate few = estimate_run(walls, topology, options);
  options.vertices = 400000;
  const RunEstimate many = estimate_run(walls, topology, options);
  CHECK(few.sheet_vertices < 2 * int64_t(walls.vertices.size()));
  CHECK(many.sheet_vertices > 4 * few.sheet_vertices);
  CHECK(many.bytes > 4 * few.bytes);
  context.memory_limit_bytes = many.bytes - 1;
  const std::string why = message_of(ErrorCode::out_of_memory, [&] { prepare(walls, options, context); });
  CHECK(contains(why, "cut for 400,000 vertices, need about"));
  CHECK(contains(why, "raise --max-memory"));
  options.vertices = 1000;
  CHECK(prepare(walls, options, context).report().grid.memory_estimate_bytes == few.bytes);
}

TEST_CASE("ugly labels give valid regions, and the walls as they came in where nothing else is valid") {
  TestContext context;
  for (uint32_t number = 0; number < 200; number += 5) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    INFO("random volume " << number);
    const TriangleMesh mesh = meshed(volume, 400, context).mesh;
    const std::string fault = fault_of_regions(mesh.triangles, mesh.regions);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(pairs_of(mesh.regions) == pairs_of(volume));
    CHECK(take_census(mesh, context).intersecting_pairs == 0);
  }
}

namespace {

/// Mean length of the edges of walls that are chosen by their labels, each edge once.
template <class Takes>
double mean_edge(const TriangleMesh& mesh, Takes takes) {
  std::set<std::array<uint32_t, 2>> edges;
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    if (!takes(mesh.regions.labels[t])) continue;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = mesh.triangles[t][i], b = mesh.triangles[t][(i + 1) % 3];
      edges.insert({std::min(a, b), std::max(a, b)});
    }
  }
  double sum = 0;
  for (const auto& [a, b] : edges) sum += length(mesh.vertices[a] - mesh.vertices[b]);
  return sum / double(edges.size());
}

bool is_of(const std::array<int32_t, 2>& pair, int32_t label) { return pair[0] == label || pair[1] == label; }

}  // namespace

TEST_CASE("the walls of a region have the edge length that is asked for, and others what they had") {
  TestContext context;
  LabelVolume volume = voronoi_grains(40, 9);
  volume.names = {{7, "femur"}, {3, "tibia"}};
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  RemeshOptions options;
  options.edge_length_world = 1.6;
  const TriangleMesh even = remesh(soup, options, context).mesh;
  options.vertices.reset();
  options.region_edge_lengths = {{"7", .8}};
  const RemeshResult result = remesh(soup, options, context);
  const TriangleMesh& mesh = result.mesh;
  const auto of_seven = [](const auto& pair) { return is_of(pair, 7); };
  CHECK(std::abs(mean_edge(mesh, of_seven) / .8 - 1) < .1);
  std::set<int32_t> beside;
  for (const auto& pair : pairs_of(soup.regions))
    if (is_of(pair, 7)) beside.insert(pair.begin(), pair.end());
  beside.erase(0);  // the background is beside all
  const auto far = [&](const auto& pair) { return beside.count(pair[0]) == 0 && beside.count(pair[1]) == 0; };
  CHECK(std::abs(mean_edge(mesh, far) / mean_edge(even, far) - 1) < .1);
  CHECK(fault_of_regions(mesh.triangles, mesh.regions).empty());
  CHECK(take_census(mesh, context).intersecting_pairs == 0);
  CHECK(result.report.sizing.varies);
}

TEST_CASE("a wall between two regions has the shorter of their edge lengths, and a count is met") {
  TestContext context;
  LabelVolume volume = voronoi_grains(32, 5);
  volume.names = {{2, "femur"}};
  const TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  RemeshOptions options;
  options.vertices.reset();
  options.region_edge_lengths = {{"1", 2}, {"femur", 1}};
  const TriangleMesh mesh = remesh(soup, options, context).mesh;
  const auto between = [](const auto& pair) { return pair == std::array<int32_t, 2>{1, 2}; };
  if (pairs_of(soup.regions).count({1, 2}) > 0) CHECK(std::abs(mean_edge(mesh, between) - 1) < .1);
  CHECK(std::abs(mean_edge(mesh, [](const auto& pair) { return is_of(pair, 2); }) - 1) < .1);
  options.vertices = 3000;
  const TriangleMesh counted = remesh(soup, options, context).mesh;
  CHECK(counted.vertices.size() == 3000);
  CHECK(fault_of_regions(counted.triangles, counted.regions).empty());
}

TEST_CASE("edge lengths of regions that are not there, and of no region, are refused with those that are") {
  TestContext context;
  LabelVolume volume = voronoi_grains(8, 3);
  volume.names = {{2, "femur"}};
  TriangleSoup soup = surface_of_labels(volume, "labels", 0);
  RemeshOptions options;
  const auto refusal = [&](std::vector<RegionEdgeLength> lengths) {
    options.region_edge_lengths = std::move(lengths);
    return message_of(ErrorCode::usage, [&] { remesh(soup, options, context); });
  };
  CHECK(contains(refusal({{"9", 1}}), "names region '9', which is not there; regions are 1, 2 (femur), 3"));
  CHECK(contains(refusal({{"0", 1}}), "names region '0', which is not there"));
  CHECK(contains(refusal({{"2", 1}, {"femur", 2}}), "gives region 2 a length twice"));
  CHECK(contains(refusal({{"2", 0}}), "region 2 is 0; it must be more than 0"));
  soup.regions = {};
  CHECK(contains(refusal({{"2", 1}}), "is for volumes of labels, and meshes with regions"));
}

TEST_CASE("the shell method refuses regions") {
  TestContext context;
  RemeshOptions options;
  options.method = Method::shell;
  const TriangleSoup soup = surface_of_labels(voronoi_grains(8, 3), "labels", 0);
  CHECK(contains(message_of(ErrorCode::usage, [&] { remesh(soup, options, context); }), "--method shell"));
}

TEST_CASE("walls of balls that touch one another in part are opened to angles that can be filled") {
  TestContext context;
  const LabelVolume volume = label_volume(40, 24, 24, [](int x, int y, int z) {
    const auto is_in = [&](double at, double radius) {
      const double dx = x - at, dy = y - 12, dz = z - 12;
      return dx * dx + dy * dy + dz * dz < radius * radius;
    };
    return is_in(11, 9) ? 1 : is_in(27, 9.5) ? 2 : is_in(19, 5) ? 3 : 0;
  });
  for (const int64_t vertices : {600, 2000, 6000}) {
    INFO(vertices << " vertices");
    const TriangleMesh mesh = meshed(volume, vertices, context).mesh;
    CHECK(find_least_dihedral(mesh).degrees >= 10);
    CHECK(take_census(mesh, context).intersecting_pairs == 0);
  }
}

TEST_CASE("regions smaller than an edge keep their volume as far as their few triangles can have it") {
  TestContext context;
  const LabelVolume volume = label_volume(48, 48, 48, [](int x, int y, int z) {
    const int lesion = 1 + (x / 12) % 4 + 4 * ((y / 12) % 4);
    const double dx = x % 12 - 5.5, dy = y % 12 - 5.5, dz = z - 24;
    return dx * dx + dy * dy + dz * dz < 5 ? 1 + lesion : 1;
  });
  const TriangleMesh mesh = meshed(volume, 1600, context).mesh;
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)) {
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    CHECK(std::abs(world / voxels - 1) < 0.02);
  }
}

TEST_CASE("labels that are not smoothed keep the faces of their voxels flat, with creases where they turn") {
  TestContext context;
  LabelVolume volume = label_volume(20, 16, 12, [](int x, int y, int z) {  // steps, and two cubes that touch in an edge
    if (x < 6 && y < 6 && z < 6) return 3;
    if (x >= 6 && x < 10 && y >= 6 && y < 10 && z < 6) return 3;
    return x < 8 + z / 4 * 3 && y > 11 ? 1 : x > 14 ? 2 : 0;
  });
  volume.smoothing_vox = 0;
  const TriangleMesh mesh = meshed(volume, 3000, context).mesh;
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions))
    CHECK(std::abs(world - double(std::count(volume.labels.begin(), volume.labels.end(), label))) < 1e-6);
  for (const auto& t : mesh.triangles) {
    const WorldPoint n = normalised(doubled_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]));
    CHECK(std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z)}) > 1 - 1e-9);
  }
  CHECK(take_census(mesh, context).intersecting_pairs == 0);
}

TEST_CASE("the more labels are smoothed the less their walls bend, and regions keep their volumes") {
  TestContext context;
  LabelVolume volume = label_volume(  // of which the one wall is as a chessboard
      24, 32, 32, [](int x, int y, int z) { return x < 11 + (y / 4 + z / 4) % 2 * 2 ? 1 : 2; });
  const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), 1));
  double roughness = 1.1;
  for (const double smoothing : {0.2, 0.5, 1.0}) {
    INFO("smoothing " << smoothing);
    volume.smoothing_vox = smoothing;
    const TriangleSoup walls = surface_of_labels(volume, "labels", 0);
    double sum_sq = 0, count = 0;  // of ways from the middle of the rough wall
    for (const WorldPoint& p : walls.vertices) {
      if (p.x < 2 || p.x > 21 || std::min(p.y, p.z) < 2 || std::max(p.y, p.z) > 29) continue;
      sum_sq += (p.x - 11.5) * (p.x - 11.5);
      ++count;
    }
    CHECK(std::sqrt(sum_sq / count) < 0.8 * roughness);
    roughness = std::sqrt(sum_sq / count);
    CHECK(std::abs(volumes_of_regions(walls.vertices, walls.triangles, walls.regions).at(1) / voxels - 1) < 0.001);
  }
  volume.smoothing_vox = 1.5;
  CHECK(contains(message_of(ErrorCode::usage, [&] { surface_of_labels(volume, "labels", 0); }), "smoothing is 1.5"));
}
