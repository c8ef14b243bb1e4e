// Walls between parts: they go, the surface around them stays, and looks outward.
#include <algorithm>

#include "features/mesh/internal_faces.h"
#include "features/mesh/mesh_edges.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

TriangleSoup boxes_in_a_row(int count) {
  TriangleSoup all = shapes::box({0, 0, 0}, {1, 1, 1});
  for (int i = 1; i < count; ++i) all = shapes::together(all, shapes::box({double(i), 0, 0}, {i + 1., 1, 1}));
  return all;
}

/// Two boxes, of which one keeps an edge of the wall whole that all others have divided: a triangle without area is
/// between.
TriangleSoup boxes_with_junction() {
  const TriangleSoup all = boxes_in_a_row(2);
  TriangleSoup divided;
  divided.vertices = all.vertices;
  const auto middle = uint32_t(all.vertices.size());
  divided.vertices.push_back({1, .5, 0});
  const auto is_on_edge = [&](uint32_t v) { return all.vertices[v].x == 1 && all.vertices[v].z == 0; };
  for (const auto& t : all.triangles) {
    size_t i = 0;
    while (i < 3 && !(is_on_edge(t[i]) && is_on_edge(t[(i + 1) % 3]))) ++i;
    const uint32_t from = t[i % 3], to = t[(i + 1) % 3], other = t[(i + 2) % 3];
    if (i == 3 || all.vertices[other].x < 1) divided.triangles.push_back(t);
    if (i == 3) continue;
    if (all.vertices[other].x < 1) {
      divided.triangles.push_back({to, from, middle});
    } else {
      divided.triangles.push_back({from, middle, other});
      divided.triangles.push_back({middle, to, other});
    }
  }
  return divided;
}

double volume_of(const FeatureMesh& mesh) {
  double volume = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    volume += dot(mesh.vertices[a], cross(mesh.vertices[b], mesh.vertices[c])) / 6;
  return volume;
}

void check_closed(const FeatureMesh& mesh) {
  for (const FeatureEdge& e : find_mesh_edges(mesh).edges) REQUIRE(e.use == EdgeUse::inner);
}

}  // namespace

TEST_CASE("inner walls: boxes that share faces become one solid, with a ring around each wall", "[walls][unit]") {
  for (const int count : {2, 3, 5}) {
    const auto found = drop_internal_faces(weld_for_features(boxes_in_a_row(count)));
    REQUIRE(found);
    CHECK(found->dropped == 2 * (count - 1));
    CHECK(found->interfaces.size() == size_t(4 * (count - 1)));
    for (const auto& edge : found->interfaces) CHECK(edge[0].x == edge[1].x);
    check_closed(found->mesh);
    CHECK(volume_of(found->mesh) == Approx(count));
  }
}

TEST_CASE("inner walls: it does not matter which way the faces look", "[walls][unit]") {
  TriangleSoup soup = boxes_in_a_row(2);
  for (const size_t turned : {0, 5, 11, 12, 17, 23}) {
    INFO("turned face " << turned);
    TriangleSoup other = soup;
    std::swap(other.triangles[turned][1], other.triangles[turned][2]);
    const auto found = drop_internal_faces(weld_for_features(other));
    if (!found) continue;  // a face that is turned alone makes edges whose two faces disagree
    check_closed(found->mesh);
    CHECK(volume_of(found->mesh) == Approx(2));
  }
  const auto turned = drop_internal_faces(weld_for_features(shapes::inside_out(soup)));
  CHECK((!turned || volume_of(turned->mesh) > 0));
}

TEST_CASE("inner walls: a triangle without area goes on as the one behind it", "[walls][unit]") {
  const auto found = drop_internal_faces(weld_for_features(boxes_with_junction()));
  REQUIRE(found);
  CHECK(found->dropped == 3);
  check_closed(found->mesh);
  CHECK(volume_of(found->mesh) == Approx(2));
}

TEST_CASE("inner walls: a hollow between parts stays one", "[walls][unit]") {
  // A shell of 26 boxes around the middle one of 27, which is air.
  TriangleSoup all;
  for (int i = 0; i < 27; ++i) {
    if (i == 13) continue;
    const WorldPoint lo{double(i % 3), double(i / 3 % 3), double(i / 9)};
    all = shapes::together(all, shapes::box(lo, lo + WorldPoint{1, 1, 1}));
  }
  const auto found = drop_internal_faces(weld_for_features(all));
  REQUIRE(found);
  check_closed(found->mesh);
  CHECK(volume_of(found->mesh) == Approx(26));
  CHECK(found->mesh.triangles.size() == 6 * 9 * 2 + 12);
}

TEST_CASE("inner walls: without walls, with borders or fins nothing is dropped", "[walls][unit]") {
  CHECK_FALSE(drop_internal_faces(weld_for_features(shapes::box({0, 0, 0}, {1, 1, 1}))));
  CHECK_FALSE(drop_internal_faces(
      weld_for_features(shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 1, 0}, {2, 2, 1})))));
  TriangleSoup open = boxes_in_a_row(2);
  open.triangles.pop_back();
  CHECK_FALSE(drop_internal_faces(weld_for_features(open)));
  CHECK_FALSE(drop_internal_faces({}));
}
