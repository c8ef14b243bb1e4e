// Vertices of flat places put where the surface is far from the mesh.
#include <algorithm>
#include <cmath>

#include "cpu/executor_tbb.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "stages/optimize/optimize_relocate.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

constexpr int32_t kAround = 24;
const TriangleSoup& tube() {
  static const TriangleSoup soup = shapes::torus(20, 8, 54, kAround);
  return soup;
}

/// A torus, itself as a mesh of its sheet.
struct Tube {
  TestContext context;
  PlainExecutor exec{context, "test"};
  Sheet sheet = sheet_of_soup(tube(), 256, 1, 1);
  DualMesh mesh{Buffer<PointQ8>(int64_t(tube().vertices.size())),
                Buffer<TriangleIndices>(int64_t(tube().triangles.size()))};
  Buffer<uint32_t> home{mesh.position.size()};
  Buffer<optimize::FitSample> sample{1};
  Buffer<int64_t> rest_sq{1};
  std::unique_ptr<optimize::Connections> connections;
  optimize::EdgeSize size;

  Tube() {
    for (int64_t v = 0; v < mesh.position.size(); ++v) {
      mesh.position[v] = sheet.frame.snap(tube().vertices[size_t(v)]);
      int64_t best = INT64_MAX;
      for (int64_t s = 0; s < sheet.vertex_count(); ++s) {
        const int64_t d = distance_sq_q16(sheet.position[s], mesh.position[v]);
        if (d < best) best = d, home[v] = uint32_t(s);
      }
    }
    std::transform(tube().triangles.begin(), tube().triangles.end(), mesh.triangles.begin(), [](const auto& t) {
      return TriangleIndices{t[0], t[1], t[2]};
    });
    connections = std::make_unique<optimize::Connections>(exec, mesh);
    size.edge_q8 = length(mesh.triangles[0].a, mesh.triangles[0].b);
  }
  double length(uint32_t u, uint32_t v) const {
    return std::sqrt(double(distance_sq_q16(mesh.position[u], mesh.position[v])));
  }
  optimize::MeshView view() { return connections->view(mesh); }
  WalkOntoSheet walk() const {
    return {sheet.position.view(),     sheet.normal.view(),           sheet.triangles.view(),
            sheet.vertex_first.view(), sheet.vertex_triangles.view(), {}};
  }
  /// Puts the one sample so many edges above the middle of a triangle, and looks for far places.
  struct Found {
    Buffer<uint32_t> distance;
    Buffer<uint64_t> offset, claim, far, spare;
    PointQ8 sample;
    optimize::FarPlace places;
    optimize::SpareEdge edges;
  };
  Found find(uint32_t t, double edges_above) {
    const TriangleIndices i = mesh.triangles[t];
    const PointQ8 a = mesh.position[i.a], b = mesh.position[i.b], c = mesh.position[i.c];
    const PointQ8 middle{(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
    return find(t,
                optimize::moved_by(middle, edges_above * size.edge_q8 * optimize::unit(optimize::normal_of(a, b, c))));
  }
  /// The same with the sample at some place.
  Found find(uint32_t t, PointQ8 place, double least_edges = optimize::kFarPlace) {
    const TriangleIndices i = mesh.triangles[t];
    sample[0] = {place, {0, 0, 0}, false, t};
    const optimize::Vector rest =
        optimize::foot_on_triangle(place, mesh.position[i.a], mesh.position[i.b], mesh.position[i.c]).rest;
    rest_sq[0] = int64_t(optimize::dot(rest, rest));
    Found f;
    f.sample = sample[0].position;
    f.distance = Buffer<uint32_t>(mesh.triangles.size());
    f.offset = Buffer<uint64_t>(mesh.triangles.size());
    f.claim = Buffer<uint64_t>(mesh.position.size());
    exec.fill(f.distance.view(), 0u);
    exec.fill(f.offset.view(), uint64_t(0));
    exec.fill(f.claim.view(), uint64_t(0));
    const optimize::FarSamples far{f.distance.view(), f.offset.view()};
    exec.for_each("distances", 1, optimize::FindDistances{sample.view(), rest_sq.view(), far});
    exec.for_each("farthest", 1,
                  optimize::FindFarthest{view(), mesh.position.view(), sample.view(), rest_sq.view(),
                                         least_edges * size.edge_q8, far});
    f.places = {view(), mesh.position.view(), home.view(), size, far, least_edges};
    f.far = optimize::choose_apart(exec, f.places, mesh.triangles.size(), f.claim.view());
    exec.fill(f.claim.view(), uint64_t(0));
    exec.for_each("block", f.far.size(), optimize::BlockPlaces{f.places, f.far.view(), f.claim.view()});
    f.edges = {{view(), mesh.position.view(), home.view(), {}, {}}, f.distance.view(), size};
    f.spare = optimize::choose_apart(exec, f.edges, connections->twin.size(), f.claim.view());
    return f;
  }
};

}  // namespace

TEST_CASE("relocate: a vertex of a flat place goes where a sample is far, and the mesh stays closed", "[optimize]") {
  Tube tube;
  constexpr uint32_t kFar = 300;
  const TriangleIndices old = tube.mesh.triangles[kFar];
  Tube::Found f = tube.find(kFar, 0.5);
  REQUIRE(f.far.size() == 1);
  CHECK(optimize::number_of(f.far[0]) == kFar);
  REQUIRE(!f.spare.empty());
  const uint32_t edge = optimize::number_of(f.spare[0]);
  const uint32_t kept = tube.view().from(edge), moved = tube.view().to(edge);
  const PointQ8 middle = collapse::CollapseCost::middle_of(tube.mesh.position[kept], tube.mesh.position[moved]);
  const optimize::Star star = f.places.best_star(kFar);
  CHECK(star.quality >= optimize::kStarQuality);

  Buffer<PointQ8> on_sheet(tube.mesh.position.size()), begin(tube.mesh.position.size());
  Buffer<uint32_t> heir(tube.mesh.triangles.size());
  tube.exec.fill(heir.view(), kNone);
  tube.exec.for_each(
      "relocate", 1,
      optimize::RelocateVertex{f.places, tube.walk(), f.far.view(), f.spare.view(), tube.mesh.position.view(),
                               on_sheet.view(), begin.view(), tube.home.view(), heir.view()});
  CHECK(tube.mesh.position[moved] == star.place);
  CHECK(tube.mesh.position[kept] == middle);
  for (const uint32_t v : {old.a, old.b, old.c}) CHECK(tube.view().are_neighbours(moved, v));
  const int64_t near = distance_sq_q16(tube.sheet.position[tube.home[moved]], star.place);
  for (const PointQ8& p : tube.sheet.position) CHECK(distance_sq_q16(p, star.place) >= near);

  SECTION("of the same topology, with every vertex") {
    TriangleMesh mesh;
    for (const PointQ8& p : tube.mesh.position) mesh.vertices.push_back(tube.sheet.frame.to_world(p));
    for (const TriangleIndices& t : tube.mesh.triangles) mesh.triangles.push_back({t.a, t.b, t.c});
    const MeshTopology topology = check_mesh(mesh);
    CHECK(topology.closed);
    CHECK(topology.manifold);
    CHECK(topology.genus == 1);
    std::vector<uint8_t> used(mesh.vertices.size());
    for (const auto& t : mesh.triangles)
      for (const uint32_t v : t) used[v] = 1;
    CHECK(std::count(used.begin(), used.end(), 0) == 0);
  }
  SECTION("connected as a mesh made anew") {
    const optimize::Connections anew(tube.exec, tube.mesh);
    for (int64_t h = 0; h < anew.twin.size(); ++h) CHECK(tube.connections->twin[h] == anew.twin[h]);
    for (int64_t v = 0; v < anew.valence.size(); ++v) {
      CHECK(tube.connections->valence[v] == anew.valence[v]);
      CHECK(tube.view().from(tube.connections->outgoing[v]) == uint32_t(v));
    }
  }
  SECTION("with the samples of the triangles that were taken on their neighbours") {
    Buffer<optimize::FitSample> samples(2);
    samples[0] = {middle, {0, 0, 0}, false, edge / 3};
    samples[1] = {middle, {0, 0, 0}, false, kNone};
    tube.exec.for_each("inherit", 2, optimize::InheritSamples{heir.view(), samples.view()});
    const TriangleIndices t = tube.mesh.triangles[samples[0].triangle];
    CHECK((t.a == kept || t.b == kept || t.c == kept));
    CHECK(samples[1].triangle == kNone);
  }
}

TEST_CASE("relocate: places that are near, or that no good star reaches, get no vertex", "[optimize]") {
  Tube tube;
  CHECK(tube.find(300, 0.9 * optimize::kFarPlace).far.empty());
  CHECK(tube.find(300, 1.1 * optimize::kFarPlace).far.size() == 1);
  CHECK(tube.find(300, 4).far.empty());
  const PointQ8 place = tube.find(300, 1.1 * optimize::kFarPlace).sample;
  CHECK(tube.find(300, place, 1.2 * optimize::kFarPlace).far.empty());
}

TEST_CASE("relocate: a star beyond an edge leans over to the other side of a fold", "[optimize]") {
  Tube tube;
  constexpr uint32_t kFar = 300;
  const optimize::MeshView mesh = tube.view();
  const TriangleIndices t = mesh.triangles[kFar];
  const View<PointQ8> p = tube.mesh.position.view();
  const PointQ8 a = p[t.a], b = p[t.b];
  const optimize::Vector up = optimize::unit(optimize::normal_of(a, b, p[t.c])), along = optimize::from_to(a, b);
  const double edge_q8 = tube.length(t.a, t.b);
  const optimize::Vector over = edge_q8 * optimize::unit(optimize::cross(along, up));
  // The top of a column: an equilateral triangle, the neighbours straight down from its edges.
  const PointQ8 middle = optimize::moved_by(a, 0.5 * along);
  p[t.c] = optimize::moved_by(middle, -0.87 * over);
  for (uint32_t h = 3 * kFar; h < 3 * kFar + 3; ++h)
    p[mesh.opposite(mesh.twin[h])] = optimize::moved_by(
        p[mesh.from(h)], 0.5 * optimize::from_to(p[mesh.from(h)], p[mesh.to(h)]) - 0.87 * edge_q8 * up);
  const PointQ8 place = optimize::moved_by(middle, 0.1 * over + 0.75 * edge_q8 * up);
  const Tube::Found f = tube.find(kFar, place);
  REQUIRE(f.far.size() == 1);
  const optimize::Star star = f.places.best_star(kFar);
  CHECK(star.flipped == 0);
  CHECK(star.place == place);
  CHECK(optimize::dot(up, optimize::normal_of(a, b, place)) < 0);
}

TEST_CASE("relocate: no edge is taken near a far place, or where the surface is curved", "[optimize]") {
  Tube tube;
  Tube::Found f = tube.find(300, 0.5);
  std::vector<uint32_t> around;
  f.places.for_each_vertex(300, [&](uint32_t v) { around.push_back(v); });
  for (const uint64_t key : f.spare)
    f.edges.for_each_vertex(optimize::number_of(key),
                            [&](uint32_t v) { CHECK(std::count(around.begin(), around.end(), v) == 0); });
  // A tip.
  const uint32_t h = optimize::number_of(f.spare[0]), v = tube.view().from(h);
  tube.mesh.position[v] = optimize::moved_by(
      tube.mesh.position[v],
      0.5 * tube.size.edge_q8 *
          optimize::unit(optimize::normal_of(tube.mesh.position[v], tube.mesh.position[tube.view().to(h)],
                                             tube.mesh.position[tube.view().opposite(h)])));
  CHECK(f.edges(h) == 0);
}

TEST_CASE("relocate: the place of a sample survives being packed", "[optimize]") {
  const PointQ8 corner{1000, -2000, 3000};
  Tube tube;
  const TriangleIndices t = tube.mesh.triangles[0];
  tube.mesh.position[t.a] = corner;
  Buffer<uint32_t> distance(tube.mesh.triangles.size());
  Buffer<uint64_t> offset(tube.mesh.triangles.size());
  const optimize::FarSamples far{distance.view(), offset.view()};
  for (const PointQ8 q : {PointQ8{1, 2, 3}, PointQ8{-1000000, 1000000, 0}, PointQ8{1 << 20, 0, 0}}) {
    tube.sample[0] = {{corner.x + q.x, corner.y + q.y, corner.z + q.z}, {0, 0, 0}, false, 0};
    tube.rest_sq[0] = 10000;
    distance[0] = 100;
    offset[0] = 0;
    tube.exec.for_each("farthest", 1,
                       optimize::FindFarthest{tube.view(), tube.mesh.position.view(), tube.sample.view(),
                                              tube.rest_sq.view(), 50, far});
    if (q.x == 1 << 20)
      CHECK(offset[0] == 0);  // too far for it
    else
      CHECK(optimize::FindFarthest::place(corner, offset[0]) == tube.sample[0].position);
  }
}
