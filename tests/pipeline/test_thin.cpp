// Thin plates, double walls and fins, down to a voxel: one seed a side, and no triangle from one side to the other.
#include <cmath>

#include "isoshell/isoshell.h"
#include "isoshell/mesh_topology.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "support/thin_shapes.h"

using namespace isoshell;

namespace {

constexpr int32_t kResolution = 64;

/// The run's mesh, which must be valid and of this topology.
TriangleMesh remeshed(const TriangleSoup& soup, int64_t vertices, int64_t components) {
  RemeshOptions options;
  options.resolution = kResolution;
  options.vertices = vertices;
  TestContext context;
  RemeshResult result = remesh(soup, options, context);
  const MeshTopology t = check_mesh(result.mesh);
  CHECK(t.is_closed_manifold());
  CHECK(t.components == components);
  CHECK(t.genus == 0);
  CHECK(int64_t(result.mesh.vertices.size()) == vertices);
  CHECK(result.report.optimize.self_intersections == 0);
  return std::move(result.mesh);
}

/// Triangles all of whose corners count, but that are not all on one side.
template <class Counts, class Side>
int64_t triangles_across(const TriangleMesh& mesh, Counts counts, Side side) {
  int64_t across = 0;
  for (const auto& t : mesh.triangles) {
    const WorldPoint p[3] = {mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]};
    if (!counts(p[0]) || !counts(p[1]) || !counts(p[2])) continue;
    across += side(p[0]) != side(p[1]) || side(p[1]) != side(p[2]);
  }
  return across;
}

}  // namespace

TEST_CASE("thin: plates of one to three voxels keep both sides", "[thin]") {
  for (const double voxels : {1., 1.5, 2., 3.})
    for (const bool tilt : {false, true}) {
      INFO(voxels << " voxels" << (tilt ? ", tilted" : ""));
      const double thickness = voxels / kResolution * (tilt ? 1.4 : 1), cell = std::sqrt(2. / 700);
      const TriangleSoup plate = shapes::plate(thickness);
      const TriangleMesh mesh = remeshed(tilt ? shapes::tilted(plate) : plate, 700, 1);
      const auto on_plate = [&](WorldPoint p) { return tilt ? shapes::tilted_back(p) : p; };
      // Smoothing rounds the rim, here and there by a whole cell.
      const auto off_rim = [&](WorldPoint p) {
        const WorldPoint q = on_plate(p);
        return std::min({q.x, q.y, 1 - q.x, 1 - q.y}) > 1.5 * cell;
      };
      CHECK(triangles_across(mesh, off_rim, [&](WorldPoint p) { return on_plate(p).z > thickness / 2; }) == 0);
    }
}

TEST_CASE("thin: walls of one to four voxels around a hollow keep both sides", "[thin]") {
  for (const double voxels : {1., 2., 3., 4.}) {
    INFO(voxels << " voxels");
    const double thickness = voxels * 2 / kResolution;
    const TriangleMesh mesh = remeshed(shapes::wall_around_hollow(1, thickness), 1500, 2);
    const auto any = [](WorldPoint) { return true; };
    const auto outside = [&](WorldPoint p) { return std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) > 1 - thickness / 2; };
    CHECK(triangles_across(mesh, any, outside) == 0);
  }
}

TEST_CASE("thin: fins of one to three voxels on a ball keep both sides", "[thin]") {
  for (const double voxels : {1., 1.5, 2., 3.}) {
    INFO(voxels << " voxels");
    const double thickness = voxels * 4 / kResolution;
    const TriangleMesh mesh = remeshed(shapes::tilted(shapes::ball_with_fin(thickness)), 1200, 1);
    const double cell = std::sqrt(20. / 1200);
    const auto on_fin = [&](WorldPoint p) {
      const WorldPoint q = shapes::tilted_back(p);
      const double r = std::sqrt(q.x * q.x + q.y * q.y);
      return r > 1.1 && r < 1.5 - 1.5 * cell;
    };
    CHECK(triangles_across(mesh, on_fin, [](WorldPoint p) { return shapes::tilted_back(p).z > 0; }) == 0);
  }
}
