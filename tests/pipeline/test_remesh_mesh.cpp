// remesh and prepare of a mesh, and what of their products is not for callers.
#include <limits>
#include <memory>
#include <type_traits>
#include <utility>

#include "geometry/world_vector.h"
#include "isoshell/isoshell.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshOptions options_for(int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  return options;
}

/// Two cubes side by side, as regions 1 and 2.
TriangleSoup two_regions() {
  TriangleSoup cubes = shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1}));
  TestContext context;
  return find_part_regions(cubes, {"components"}, context).walls;
}

template <class T, class = void>
struct ShowsParts : std::false_type {};
template <class T>
struct ShowsParts<T, std::void_t<decltype(std::declval<const T&>().parts())>> : std::true_type {};
template <class T, class = void>
struct ShowsState : std::false_type {};
template <class T>
struct ShowsState<T, std::void_t<decltype(std::declval<T&>().backend_state)>> : std::true_type {};

static_assert(!ShowsParts<Prepared>::value && !ShowsState<Context>::value, "for the library alone");
static_assert(!std::is_constructible_v<Prepared, std::shared_ptr<PreparedSurface>>, "prepare() alone makes one");

}  // namespace

TEST_CASE("remesh: a mesh gives what a surface of the same triangles gives", "[remesh]") {
  TestContext context;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 24);
  const RemeshOptions options = options_for(300);
  const TriangleMesh of_surface = remesh(ball, options, context).mesh;
  const TriangleMesh of_mesh = remesh(mesh_of(ball), options, context).mesh;
  CHECK(of_mesh.vertices == of_surface.vertices);
  CHECK(of_mesh.triangles == of_surface.triangles);
}

TEST_CASE("remesh: the result of one call is what the next one starts from", "[remesh]") {
  TestContext context;
  const RemeshResult fine = remesh(shapes::sphere({0, 0, 0}, 1, 24), options_for(600), context);
  const RemeshResult coarse = remesh(fine.mesh, options_for(200), context);
  CHECK(coarse.mesh.vertices.size() == 200);
  CHECK(check_mesh(coarse.mesh).is_closed_manifold());
  CHECK(prepare(fine.mesh, options_for(200), context).report().input.topology.components == 1);
}

TEST_CASE("remesh: regions of a mesh are regions of the result", "[remesh]") {
  TestContext context;
  const TriangleSoup walls = two_regions();
  TriangleMesh mesh = mesh_of(walls);
  mesh.regions = walls.regions;
  const TriangleMesh made = remesh(mesh, options_for(300), context).mesh;
  CHECK(made.regions.labels.size() == made.triangles.size());
  CHECK(made.triangles == remesh(walls, options_for(300), context).mesh.triangles);
}

TEST_CASE("remesh: a mesh that is none is refused by the triangle", "[remesh]") {
  TestContext context;
  const auto refusal = [&](const TriangleMesh& mesh) {
    return message_of(ErrorCode::unreadable_input, [&] { remesh(mesh, {}, context); });
  };
  TriangleMesh mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  mesh.triangles[3][1] = 8;
  CHECK(contains(refusal(mesh), "the mesh: triangle 3 has vertex 8 of a surface of 8 vertices"));
  mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  mesh.vertices[mesh.triangles[0][0]].y = std::numeric_limits<double>::infinity();
  CHECK(contains(refusal(mesh), "the mesh: triangle 0 has vertex"));
  mesh = mesh_of(shapes::box({0, 0, 0}, {1, 1, 1}));
  mesh.regions.labels.push_back({0, 1});
  CHECK(contains(refusal(mesh), "the mesh: there are regions of 1 faces for 12 triangles"));
}
