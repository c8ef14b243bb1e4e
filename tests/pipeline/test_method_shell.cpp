// Method shell from soup to mesh: the paper's loop, then the sheet's dual.
#include <algorithm>
#include <cmath>

#include "isoshell/advanced/digest.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

double length(WorldPoint a, WorldPoint b) {
  return std::sqrt((a.x - b.x) * (a.x - b.x) + (a.y - b.y) * (a.y - b.y) + (a.z - b.z) * (a.z - b.z));
}

/// Mean of 6 / sqrt(3) * inradius / longest edge, the paper's Q.
double mean_quality(const TriangleMesh& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const double a = length(mesh.vertices[t[0]], mesh.vertices[t[1]]),
                 b = length(mesh.vertices[t[1]], mesh.vertices[t[2]]);
    const double c = length(mesh.vertices[t[2]], mesh.vertices[t[0]]), s = (a + b + c) / 2;
    sum += 6 / std::sqrt(3.0) * std::sqrt(std::max(0.0, (s - a) * (s - b) * (s - c) / s)) / std::max({a, b, c});
  }
  return sum / double(mesh.triangles.size());
}

}  // namespace

TEST_CASE("method shell: a torus gets the asked vertices, its genus, and good triangles on its surface",
          "[relax_shell][stage]") {
  RemeshOptions options;
  options.method = Method::shell;
  options.vertices = 600;
  options.resolution = 128;
  options.max_passes = 60;
  uint64_t one = 0;
  for (const int threads : {1, 2}) {
    TestContext context;
    context.threads = threads;
    const RemeshResult result = remesh(shapes::torus(3, 1.2, 96, 48), options, context);
    const TriangleMesh& mesh = result.mesh;
    CHECK(mesh.vertices.size() == 600);
    CHECK(mesh.triangles.size() == 2 * mesh.vertices.size());  // closed with Euler number 0
    CHECK(result.report.dual.failed_cells == 0);
    CHECK(mean_quality(mesh) > .88);
    for (const WorldPoint& p : mesh.vertices) CHECK(std::abs(std::hypot(std::hypot(p.x, p.y) - 3, p.z) - 1.2) < .05);
    if (threads == 1) one = digest(mesh);
    CHECK(digest(mesh) == one);
  }
}
