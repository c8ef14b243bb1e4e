// The search for creases beside a device's work, and the mesh of a lattice that it looks at.
#include "core/copy_product.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"
#include "isoshell/distance.h"
#include "isoshell/error.h"
#include "pipeline/sheet/crease_search.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

TriangleSoup crossing_boxes() {
  return shapes::together(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({.5, .5, .5}, {2, 1.5, 3}));
}

LatticeFrame frame_of(const TriangleSoup& soup, int32_t resolution) {
  const auto [lo, hi] = bounding_box(soup);
  return LatticeFrame::around(lo, hi, resolution);
}

TriangleSoup soup_of(const LatticeSurface& surface) {
  const TriangleMesh mesh = to_world(surface);
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  return soup;
}

void check_same(const FeatureMesh& a, const FeatureMesh& b) {
  REQUIRE(a.vertices.size() == b.vertices.size());
  for (size_t v = 0; v < a.vertices.size(); ++v) {
    const WorldPoint &p = a.vertices[v], &q = b.vertices[v];
    if (p.x != q.x || p.y != q.y || p.z != q.z) FAIL("vertex " << v << " is elsewhere");
  }
  CHECK(a.triangles == b.triangles);
  CHECK(a.source_face == b.source_face);
}

void check_same(const CurveNetwork& a, const CurveNetwork& b) {
  REQUIRE(a.curves.size() == b.curves.size());
  for (size_t c = 0; c < a.curves.size(); ++c) CHECK(a.curves[c].vertex == b.curves[c].vertex);
  CHECK(a.corners == b.corners);
}

}  // namespace

TEST_CASE("creases: a lattice is welded as its soup is", "[curves][unit]") {
  TestContext context;
  for (const TriangleSoup& soup : {crossing_boxes(), shapes::torus(2, .7, 40, 20), shapes::random_soup(300, 1, .4, 5)})
    for (const double far : {0., 1e16}) {  // where positions that differ on the lattice are one in the world
      LatticeSurface surface = snap_surface(soup, frame_of(soup, 200), context);
      surface.frame.origin = surface.frame.origin + WorldPoint{far, far, far};
      const FeatureMesh mesh = weld_for_features(surface);
      CHECK((mesh.vertices.size() < size_t(surface.points.size())) == (far > 0));
      check_same(mesh, weld_for_features(soup_of(surface)));
    }
}

TEST_CASE("creases: a fin that rounding has flattened is left out, a wall without thickness stays as one",
          "[curves][unit]") {
  TestContext context;
  const LatticeSurface surface =
      snap_surface(shapes::box({0, 0, 0}, {1, 1, 1}), frame_of(crossing_boxes(), 200), context);
  const size_t faces = weld_for_features(surface).triangles.size();
  for (const int32_t height : {4, 64}) {
    LatticeSurface with_fin = host_copy(surface);
    with_fin.points = Buffer<PointQ8>(surface.points.size() + 1);
    std::copy(surface.points.begin(), surface.points.end(), with_fin.points.begin());
    const auto [a, b, c] = surface.triangles[0];
    with_fin.points[surface.points.size()] = surface.points[a];
    with_fin.points[surface.points.size()].x -= height;
    const auto top = uint32_t(surface.points.size());
    with_fin.triangles = Buffer<TriangleIndices>(surface.triangles.size() + 2);
    std::copy(surface.triangles.begin(), surface.triangles.end(), with_fin.triangles.begin());
    with_fin.triangles[surface.triangles.size()] = {a, b, top};
    with_fin.triangles[surface.triangles.size() + 1] = {b, a, top};
    const FeatureMesh welded = weld_for_features(with_fin);
    const size_t more = height < 8 ? 0 : 1;
    CHECK(welded.triangles.size() == faces + more);
    CHECK(welded.vertices.size() == 8 + more);
  }
}

TEST_CASE("creases: points of a lattice that no triangle uses are passed over", "[curves][unit]") {
  TestContext context;
  const TriangleSoup soup = shapes::torus(2, .7, 40, 20);
  LatticeSurface surface = snap_surface(soup, frame_of(soup, 200), context);
  surface.triangles = Buffer<TriangleIndices>(3);
  for (uint32_t t = 0; t < 3; ++t) surface.triangles[t] = {9 * t, 9 * t + 4, 9 * t + 7};
  CHECK(weld_for_features(surface).vertices.size() == 9);
  check_same(weld_for_features(surface), weld_for_features(soup_of(surface)));
}

TEST_CASE("creases: a search on a thread of its own finds what one without finds", "[curves][unit]") {
  TestContext context;
  const TriangleSoup soup = crossing_boxes();
  const LatticeSurface surface = snap_surface(soup, frame_of(soup, 200), context);
  const CurveOptions options{CreaseMode::automatic, 40, .1};
  SearchedSurface found = CreaseSearch(surface, options, context).result();
  const FeatureMesh mesh = feature_mesh_of(surface, context);
  check_same(found.mesh, mesh);
  REQUIRE(found.creases);
  const CurveNetwork network = find_curves(found.mesh, options, *std::move(found.creases));
  CHECK(network.curves.size() == 24);
  check_same(network, find_curves(mesh, options));
}

TEST_CASE("creases: a search leaves it to others to refuse, and stops when it is cancelled", "[curves][unit]") {
  TestContext context;
  const TriangleSoup soup = crossing_boxes();
  const LatticeSurface surface = snap_surface(soup, frame_of(soup, 200), context);
  CHECK_FALSE(CreaseSearch(surface, {CreaseMode::automatic, 40, 0}, context).result().creases);
  { const CreaseSearch unused(surface, {CreaseMode::automatic, 40, .1}, context); }
  context.cancel = true;
  CHECK_THROWS_AS(CreaseSearch(surface, {CreaseMode::automatic, 40, .1}, context).result(), Error);
}

TEST_CASE("creases: the search begins early on a device alone, at the edge length of the run", "[curves][unit]") {
  TestContext context;
  const TriangleSoup soup = shapes::box({0, 0, 0}, {1, 1, 1});
  LatticeSurface surface = snap_surface(soup, frame_of(soup, 200), context.plain());
  surface.topology.area_world = 6;
  PreparedSurface prepared = begin_with(std::move(surface), {});
  RemeshOptions& options = prepared.options;
  Run run{context};
  const bool is_on_device = test_backend() == Backend::cuda;
  const auto search = begin_crease_search(prepared, run);
  CHECK((search != nullptr) == is_on_device);
  CHECK(run.times.empty() == !is_on_device);
  if (search) CHECK(search->result().mesh.vertices.size() == 8);
  options.features.creases = Features::Creases::off;
  CHECK_FALSE(begin_crease_search(prepared, run));
  options.features.creases = Features::Creases::automatic;
  options.adaptivity = .5;
  CHECK_FALSE(begin_crease_search(prepared, run));
}
