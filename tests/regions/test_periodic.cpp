// Periodic volumes: opposite sides have the same triangles, translated.
#include <set>

#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "isoshell/remesh.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/refusals.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

using Place = std::array<double, 3>;

/// Grains of a volume that goes on with its other side along all axes; those up to `voids` are no regions.
LabelVolume periodic_grains(int32_t n, int grains, int voids, std::array<bool, 3> is_periodic) {
  std::mt19937 random(uint32_t(n + grains));
  std::vector<std::array<double, 3>> point(size_t(grains), {0, 0, 0});
  for (auto& p : point)
    for (double& c : p) c = double(random()) / 4294967296.0 * n;
  LabelVolume volume = label_volume(n, n, n, [&](int x, int y, int z) {
    const double at[3] = {x + 0.5, y + 0.5, z + 0.5};
    int32_t nearest = 0;
    double best = 1e30;
    for (int g = 0; g < grains; ++g) {
      double sum = 0;
      for (size_t c = 0; c < 3; ++c) {
        const double way = std::abs(at[c] - point[size_t(g)][c]), around = std::min(way, n - way);
        sum += around * around;
      }
      if (sum < best) best = sum, nearest = g + 1;
    }
    return nearest <= voids ? 0 : nearest;
  });
  volume.is_periodic = is_periodic;
  return volume;
}

RemeshResult meshed(const LabelVolume& volume, int64_t vertices, TestContext& context) {
  RemeshOptions options;
  options.vertices = vertices;
  return remesh(surface_of_labels(volume, "labels", 0), options, context);
}

/// The triangles of walls to the background in a plane across an axis, by their corners in it.
std::set<std::set<Place>> triangles_in_plane(const TriangleMesh& mesh, int axis, double plane) {
  std::set<std::set<Place>> found;
  for (const auto& t : mesh.triangles) {
    std::set<Place> corners;
    for (const uint32_t v : t) {
      Place p{mesh.vertices[v].x, mesh.vertices[v].y, mesh.vertices[v].z};
      if (p[size_t(axis)] != plane) break;
      p[size_t(axis)] = 0;
      corners.insert(p);
    }
    if (corners.size() == 3) found.insert(corners);
  }
  return found;
}

void check_periodic(const LabelVolume& volume, int64_t vertices, Features::Creases creases = {}) {
  TestContext context;
  RemeshOptions options;
  options.vertices = vertices;
  options.features.creases = creases;
  const TriangleMesh mesh = remesh(surface_of_labels(volume, "labels", 0), options, context).mesh;
  INFO(vertices << " vertices, " << mesh.vertices.size() << " made");
  CHECK(int64_t(mesh.vertices.size()) == vertices);
  CHECK(fault_of_regions(mesh.triangles, mesh.regions).empty());
  CHECK(take_census(mesh, context).intersecting_pairs == 0);
  for (int axis = 0; axis < 3; ++axis) {
    if (!volume.is_periodic[size_t(axis)]) continue;
    const auto along = [&](const WorldPoint& p) { return axis == 0 ? p.x : axis == 1 ? p.y : p.z; };
    const auto [first, last] =
        std::minmax_element(mesh.vertices.begin(), mesh.vertices.end(),
                            [&](const WorldPoint& p, const WorldPoint& q) { return along(p) < along(q); });
    CHECK(std::abs(along(*last) - along(*first) - volume.size_vox[0]) < 1e-9);
    const auto low = triangles_in_plane(mesh, axis, along(*first)), high = triangles_in_plane(mesh, axis, along(*last));
    CHECK(!low.empty());
    CHECK(low == high);
  }
  for (const auto& [label, world] : volumes_of_regions(mesh.vertices, mesh.triangles, mesh.regions)) {
    if (label == 0) continue;
    const auto voxels = double(std::count(volume.labels.begin(), volume.labels.end(), label));
    INFO("region " << label << " of " << voxels << " voxels");
    CHECK(std::abs(world - voxels) < .03 * voxels + 20);
  }
}

}  // namespace

TEST_CASE("opposite sides of a periodic volume have the same triangles, and regions their volumes") {
  SECTION("along all axes") { check_periodic(periodic_grains(32, 14, 0, {true, true, true}), 4000); }
  SECTION("along two, with few vertices") { check_periodic(periodic_grains(24, 9, 0, {true, false, true}), 800); }
  SECTION("with voids") { check_periodic(periodic_grains(24, 12, 4, {true, true, true}), 2500); }
  SECTION("with axes that are mirrored and exchanged, and no creases") {
    LabelVolume volume = periodic_grains(20, 8, 2, {true, true, false});
    volume.step_world = {WorldPoint{0, -1, 0}, WorldPoint{1, 0, 0}, WorldPoint{0, 0, 1}};
    check_periodic(volume, 1500, Features::Creases::off);
  }
  SECTION("of one region") {
    LabelVolume one = label_volume(12, 12, 12, [](int, int, int) { return 3; });
    one.is_periodic = {true, true, false};
    check_periodic(one, 700);
  }
}

TEST_CASE("an island that a side cuts apart is one") {
  LabelVolume volume = label_volume(12, 6, 6, [](int x, int y, int z) {
    return (x < 1 || x > 10) && std::min(y, z) > 1 && std::max(y, z) < 4 ? 2 : x == 6 && y == 3 && z > 1 ? 2 : 1;
  });
  volume.smallest_island_vox = 8;
  const auto has_ends = [&] {
    const TriangleSoup walls = surface_of_labels(volume, "labels", 0);
    int ends = 0;
    for (const bool is_first : {true, false})
      ends += std::any_of(walls.vertices.begin(), walls.vertices.end(), [&](const WorldPoint& p) {
        const bool is_inside = p.y > .6 && p.y < 4.4 && p.z > .6 && p.z < 4.4;
        return is_inside && (is_first ? p.x > .2 && p.x < .8 : p.x > 10.2 && p.x < 10.8);
      });
    return ends;
  };
  CHECK(has_ends() == 1);  // the other one has as many voxels
  volume.is_periodic = {true, false, false};
  CHECK(has_ends() == 2);
}

TEST_CASE("a periodic volume has the same mesh with any number of threads") {
  TestContext one, other;
  one.threads = 1, other.threads = 3;
  const LabelVolume volume = periodic_grains(24, 12, 4, {true, true, false});
  const TriangleMesh a = meshed(volume, 1500, one).mesh, b = meshed(volume, 1500, other).mesh;
  CHECK(a.triangles == b.triangles);
  CHECK(std::equal(a.vertices.begin(), a.vertices.end(), b.vertices.begin(), b.vertices.end(),
                   [](const WorldPoint& p, const WorldPoint& q) { return p.x == q.x && p.y == q.y && p.z == q.z; }));
}

TEST_CASE("a periodic volume of turned voxels, or without smoothing, is refused with what helps") {
  LabelVolume volume = periodic_grains(8, 3, 0, {true, false, false});
  const auto refusal = [&] { return message_of(ErrorCode::usage, [&] { surface_of_labels(volume, "labels", 0); }); };
  volume.smoothing_vox = 0;
  CHECK(refusal().find("give a smoothing above 0") != std::string::npos);
  volume.smoothing_vox = .5;
  volume.step_world[0] = {1, .5, 0};
  CHECK(refusal().find("resample it") != std::string::npos);
}
