// A mesh that is changed edge by edge: what is made, and what is refused and leaves it as it was.
#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "features/mesh/editable_mesh.h"
#include "features/walls/sheet_order.h"
#include "support/catch.h"

using namespace isoshell;

namespace {

using Kind = RegionVertex::Kind;
using Size = EditableMesh::Size;
using Corners = std::array<uint32_t, 3>;

constexpr double kSide = 256;
constexpr uint32_t kGrid = 4;  ///< vertices along a side

bool always() { return true; }

RegionVertex vertex_at(double x, double y, double z, Kind kind = Kind::free) {
  RegionVertex v;
  v.position = {x, y, z};
  v.kind = kind;
  return v;
}
uint32_t grid_at(uint32_t x, uint32_t y) { return y * kGrid + x; }

struct Parts {
  std::vector<RegionVertex> vertices;
  std::vector<RegionTriangle> triangles;

  void add(const Corners& corner) { triangles.push_back({corner, {kNone, kNone, kNone}, 0}); }
  /// A triangle of its own.
  void add_apart(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
    const auto first = uint32_t(vertices.size());
    for (const WorldPoint& p : {a, b, c}) vertices.push_back(vertex_at(p.x, p.y, p.z));
    add({first, first + 1, first + 2});
  }
  void put_on_curve(uint32_t u, uint32_t v, uint32_t curve) {
    for (RegionTriangle& t : triangles)
      for (size_t i = 0; i < 3; ++i)
        if (t.has(u) && t.has(v) && t.corner[(i + 2) % 3] != u && t.corner[(i + 2) % 3] != v) t.curve[i] = curve;
  }
  EditableMesh mesh(Size size = Size::many) const {
    EditableMesh out(vertices, triangles, size);
    if (size == Size::many) out.keep_apart(kSide);
    return out;
  }
};

/// Squares with a diagonal from their lower left corners each; vertices on the border are corners.
Parts grid() {
  Parts out;
  for (uint32_t y = 0; y < kGrid; ++y)
    for (uint32_t x = 0; x < kGrid; ++x) {
      const bool is_border = x % (kGrid - 1) == 0 || y % (kGrid - 1) == 0;
      out.vertices.push_back(vertex_at(kSide * x, kSide * y, 0, is_border ? Kind::corner : Kind::free));
    }
  for (uint32_t y = 0; y + 1 < kGrid; ++y)
    for (uint32_t x = 0; x + 1 < kGrid; ++x) {
      out.add({grid_at(x, y), grid_at(x + 1, y), grid_at(x + 1, y + 1)});
      out.add({grid_at(x, y), grid_at(x + 1, y + 1), grid_at(x, y + 1)});
    }
  return out;
}
/// The edge from corner `edge` of a triangle to the next runs from u to v.
std::pair<uint32_t, size_t> side(const EditableMesh& mesh, uint32_t u, uint32_t v) {
  for (uint32_t t = 0; t < mesh.triangles().size(); ++t)
    for (size_t i = 0; i < 3; ++i)
      if (mesh.triangles()[t].corner[i] == u && mesh.triangles()[t].corner[(i + 1) % 3] == v) return {t, i};
  FAIL("no such edge");
  return {};
}
bool flip(EditableMesh& mesh, uint32_t u, uint32_t v) {
  MeshChange change;
  const auto [triangle, edge] = side(mesh, u, v);
  return mesh.flip(triangle, edge, change, always);
}
bool collapse(EditableMesh& mesh, uint32_t gone, uint32_t into) {
  MeshChange change;
  return mesh.collapse(gone, into, change, always);
}
bool split(EditableMesh& mesh, uint32_t u, uint32_t v, const RegionVertex& middle) {
  MeshChange change;
  return mesh.split(u, v, middle, change, always);
}
bool move(EditableMesh& mesh, uint32_t v, const RegionVertex& to) {
  MeshChange change;
  return mesh.move(v, to, change, always);
}

/// All that can be seen of a mesh.
auto state_of(const EditableMesh& mesh) {
  std::vector<std::tuple<Corners, Corners, uint32_t>> triangles;
  for (const RegionTriangle& t : mesh.triangles()) triangles.push_back({t.corner, t.curve, t.patch});
  std::vector<std::array<double, 3>> places;
  std::vector<std::vector<uint32_t>> around(mesh.vertices().size());
  for (uint32_t v = 0; v < mesh.vertices().size(); ++v) {
    places.push_back({mesh.at(v).x, mesh.at(v).y, mesh.at(v).z});
    mesh.for_each_around(v, [&](uint32_t t) { around[v].push_back(t); });
  }
  return std::make_tuple(triangles, places, around, mesh.vertex_count());
}
size_t triangles_left(const EditableMesh& mesh) {
  const auto is_there = [](const RegionTriangle& t) { return !t.is_gone(); };
  return size_t(std::count_if(mesh.triangles().begin(), mesh.triangles().end(), is_there));
}
double area_of(const EditableMesh& mesh) {
  double sum = 0;
  for (const RegionTriangle& t : mesh.triangles())
    if (!t.is_gone()) sum += mesh.normal(t).z / 2;
  return sum;
}

const uint32_t kA = grid_at(1, 1), kB = grid_at(2, 1), kC = grid_at(1, 2), kD = grid_at(2, 2);
constexpr double kAreaOfGrid = 9 * kSide * kSide;

}  // namespace

TEST_CASE("editable mesh: a flip puts the other diagonal into two triangles, in a mesh of few and of many",
          "[editable_mesh]") {
  for (const Size size : {Size::few, Size::many}) {
    EditableMesh mesh = grid().mesh(size);
    REQUIRE(flip(mesh, kA, kD));
    CHECK(mesh.is_edge(kB, kC));
    CHECK(!mesh.is_edge(kA, kD));
    CHECK(area_of(mesh) == kAreaOfGrid);
    REQUIRE(flip(mesh, kB, kC));
    CHECK(mesh.is_edge(kA, kD));
  }
}

TEST_CASE("editable mesh: a flip is refused on a curve, at a border, between patches, and where its edge is there",
          "[editable_mesh]") {
  Parts with_curve = grid(), of_patches = grid(), pyramid, reflex;
  with_curve.put_on_curve(kA, kD, 0);
  for (RegionTriangle& t : of_patches.triangles) t.patch = t.has(kC) ? 1 : 0;
  pyramid.vertices = {vertex_at(0, 0, 0), vertex_at(512, 0, 0), vertex_at(0, 512, 0), vertex_at(128, 128, 256)};
  for (const Corners& c : {Corners{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) pyramid.add(c);
  reflex.vertices = {vertex_at(0, 0, 0), vertex_at(0, 512, 0), vertex_at(-512, -512, 0), vertex_at(512, -128, 0)};
  for (const Corners& c : {Corners{0, 1, 2}, {1, 0, 3}}) reflex.add(c);
  for (const auto& [parts, u, v] :
       {std::make_tuple(with_curve, kA, kD), std::make_tuple(of_patches, kA, kD),
        std::make_tuple(grid(), grid_at(0, 0), grid_at(1, 0)), std::make_tuple(pyramid, uint32_t(1), uint32_t(3)),
        std::make_tuple(reflex, uint32_t(0), uint32_t(1))}) {
    EditableMesh mesh = parts.mesh();
    const auto before = state_of(mesh);
    CHECK(!flip(mesh, u, v));
    CHECK(state_of(mesh) == before);
  }
}

TEST_CASE("editable mesh: a flip over a ridge is refused where another triangle is below it", "[editable_mesh]") {
  Parts roof;
  roof.vertices = {vertex_at(0, 0, 256), vertex_at(512, 0, 256), vertex_at(256, 512, 0), vertex_at(256, -512, 0)};
  roof.add({0, 1, 2});
  roof.add({1, 0, 3});
  EditableMesh alone = roof.mesh();
  CHECK(flip(alone, 0, 1));
  roof.add_apart({240, -16, -32}, {272, -16, -32}, {256, 16, 96});
  EditableMesh mesh = roof.mesh();
  const auto before = state_of(mesh);
  CHECK(!flip(mesh, 0, 1));
  CHECK(state_of(mesh) == before);
}

TEST_CASE("editable mesh: a fan in a plane is handed from one corner to the next by flips, and none looks at the rest",
          "[editable_mesh]") {
  constexpr uint32_t kFan = 20000, kFirst = kFan + 1, kNext = kFan + 2;
  Parts parts;
  for (uint32_t i = 0; i <= kFan; ++i) parts.vertices.push_back(vertex_at(4. * i, 65536, 0));
  for (const double x : {0., 1024.}) parts.vertices.push_back(vertex_at(x, 0, 0));
  for (uint32_t i = 0; i < kFan; ++i) parts.add({kFirst, i + 1, i});
  parts.add({kFirst, kNext, kFan});
  EditableMesh mesh(parts.vertices, parts.triangles, Size::many);
  mesh.keep_apart(65536);
  MeshChange change;
  for (uint32_t i = kFan; i > 0; --i) {
    const uint32_t t = mesh.find_around(i, [&](const RegionTriangle& s) { return s.edge_between(i, kFirst) < 3; });
    REQUIRE(mesh.flip(t, mesh.triangles()[t].edge_between(i, kFirst), change, always));
  }
  CHECK((mesh.around(kFirst).size() == 1 && mesh.around(kNext).size() == kFan + 1));
}

TEST_CASE("editable mesh: a collapse takes out a vertex and the triangles at its edge", "[editable_mesh]") {
  for (const Size size : {Size::few, Size::many}) {
    EditableMesh mesh = grid().mesh(size);
    REQUIRE(collapse(mesh, kA, kD));
    CHECK(triangles_left(mesh) == 16);
    CHECK(area_of(mesh) == kAreaOfGrid);
    if (size == Size::many) CHECK(mesh.vertex_count() == 15);
    if (size == Size::many) CHECK(mesh.around(kA).empty());
  }
}

TEST_CASE("editable mesh: a collapse is refused for corners, what is not inside, and where there is no edge",
          "[editable_mesh]") {
  Parts cut_out = grid();
  cut_out.vertices[kD].is_inner = false;
  for (const auto& [parts, gone, into] : {std::make_tuple(grid(), grid_at(0, 0), kA), std::make_tuple(grid(), kB, kC),
                                          std::make_tuple(cut_out, kA, kD), std::make_tuple(cut_out, kD, kA)}) {
    EditableMesh mesh = parts.mesh();
    const auto before = state_of(mesh);
    CHECK(!collapse(mesh, gone, into));
    CHECK(state_of(mesh) == before);
  }
}

TEST_CASE("editable mesh: a collapse that would pinch a tube, or leave a triangle twice, is refused",
          "[editable_mesh]") {
  Parts tube, tetrahedron;
  for (int ring = 0; ring < 3; ++ring)
    for (const auto& [x, y] : {std::array<double, 2>{0, 0}, {512, 0}, {0, 512}})
      tube.vertices.push_back(vertex_at(x, y, 512 * ring));
  for (uint32_t ring = 0; ring < 2; ++ring)
    for (uint32_t i = 0; i < 3; ++i) {
      const uint32_t u = 3 * ring + i, v = 3 * ring + (i + 1) % 3;
      tube.add({u, v, v + 3});
      tube.add({u, v + 3, u + 3});
    }
  tetrahedron.vertices = {vertex_at(0, 0, 0), vertex_at(512, 0, 0), vertex_at(0, 512, 0), vertex_at(0, 0, 512)};
  for (const Corners& c : {Corners{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}) tetrahedron.add(c);
  for (const auto& [parts, gone, into] : {std::make_tuple(tube, 3, 4), std::make_tuple(tetrahedron, 0, 1)}) {
    EditableMesh mesh = parts.mesh();
    const auto before = state_of(mesh);
    CHECK(!collapse(mesh, uint32_t(gone), uint32_t(into)));
    CHECK(state_of(mesh) == before);
  }
}

TEST_CASE("editable mesh: vertices on curves go along these, which then run on the edges that are left",
          "[editable_mesh]") {
  Parts parts = grid();
  parts.vertices[kA].kind = Kind::on_curve;
  parts.put_on_curve(kA, kB, 0);
  parts.put_on_curve(kA, kD, 0);
  EditableMesh mesh = parts.mesh();
  CHECK(!collapse(mesh, kA, kC));
  REQUIRE(collapse(mesh, kA, kB));
  CHECK(mesh.curve_between(kB, kD) == 0u);
  CHECK(mesh.curve_between(kB, kC) == kNone);
  parts.put_on_curve(kB, kD, 1);
  EditableMesh with_both = parts.mesh();
  CHECK(!collapse(with_both, kA, kB));  // two edges on curves would become one
}

TEST_CASE("editable mesh: a collapse along an edge of three sheets keeps all of them", "[editable_mesh]") {
  Parts book;
  for (uint32_t i = 0; i < 4; ++i)
    book.vertices.push_back(vertex_at(kSide * i, 0, 0, i % 3 == 0 ? Kind::corner : Kind::on_curve));
  for (const auto& [y, z] : {std::array<double, 2>{256, 0}, {-128, 256}, {-128, -256}}) {
    const auto page = uint32_t(book.vertices.size());
    for (uint32_t i = 0; i < 4; ++i) book.vertices.push_back(vertex_at(kSide * i, y, z, Kind::corner));
    for (uint32_t i = 0; i < 3; ++i) {
      book.add({i, i + 1, page + i});
      book.add({i + 1, page + i + 1, page + i});
    }
  }
  for (uint32_t i = 0; i < 3; ++i) book.put_on_curve(i, i + 1, 0);
  EditableMesh mesh = book.mesh();
  REQUIRE(collapse(mesh, 1, 2));
  CHECK(triangles_left(mesh) == 15);
  CHECK(mesh.curve_between(0, 2) == 0u);
  int sheets = 0;
  mesh.for_each_around(0, [&](uint32_t t) { sheets += mesh.triangles()[t].has(2) ? 1 : 0; });
  CHECK(sheets == 3);
}

TEST_CASE("editable mesh: a collapse, a split or a move that lets triangles meet is refused", "[editable_mesh]") {
  Parts tent = grid();
  tent.vertices[kA].position.z = 256;
  EditableMesh free_tent = tent.mesh();
  CHECK(collapse(free_tent, kA, kD));
  tent.add_apart({240, 256, -32}, {272, 256, -32}, {256, 256, 32});
  EditableMesh mesh = tent.mesh();
  const auto before = state_of(mesh);
  CHECK(!collapse(mesh, kA, kD));
  CHECK(!move(mesh, kA, vertex_at(256, 256, 0)));
  CHECK(state_of(mesh) == before);
  CHECK(move(mesh, kA, vertex_at(256, 256, 200)));

  Parts below = grid();
  EditableMesh free_grid = below.mesh();
  CHECK(split(free_grid, kA, kD, vertex_at(384, 384, 128)));
  below.add_apart({384, 384, 64}, {384, 400, 64}, {384, 640, 80});
  EditableMesh flat = below.mesh();
  const auto before_split = state_of(flat);
  CHECK(!split(flat, kA, kD, vertex_at(384, 384, 128)));
  CHECK(state_of(flat) == before_split);
}

TEST_CASE("editable mesh: a move takes a vertex and its triangles along, but no corner", "[editable_mesh]") {
  EditableMesh mesh = grid().mesh();
  CHECK(move(mesh, kA, vertex_at(240, 272, 0)));
  CHECK(mesh.at(kA) == WorldPoint{240, 272, 0});
  CHECK(area_of(mesh) == kAreaOfGrid);
  CHECK(!move(mesh, grid_at(0, 1), vertex_at(0, 300, 0)));
}

TEST_CASE("editable mesh: a split puts a vertex into an edge, on its curve", "[editable_mesh]") {
  for (const Size size : {Size::few, Size::many}) {
    Parts parts = grid();
    parts.put_on_curve(kA, kD, 2);
    EditableMesh mesh = parts.mesh(size);
    REQUIRE(split(mesh, kA, kD, vertex_at(384, 384, 0, Kind::on_curve)));
    const auto middle = uint32_t(mesh.vertices().size() - 1);
    CHECK(triangles_left(mesh) == 20);
    CHECK(area_of(mesh) == kAreaOfGrid);
    CHECK(!mesh.is_edge(kA, kD));
    CHECK(mesh.curve_between(kA, middle) == 2u);
    CHECK(mesh.curve_between(middle, kD) == 2u);
    CHECK(mesh.curve_between(middle, kB) == kNone);
  }
}

TEST_CASE("editable mesh: a split is refused between what is not inside, and off edges", "[editable_mesh]") {
  Parts cut_out = grid();
  cut_out.vertices[kA].is_inner = cut_out.vertices[kD].is_inner = false;
  for (const auto& [parts, u, v] : {std::make_tuple(cut_out, kA, kD), std::make_tuple(grid(), kB, kC)}) {
    EditableMesh mesh = parts.mesh();
    const auto before = state_of(mesh);
    CHECK(!split(mesh, u, v, vertex_at(384, 384, 0)));
    CHECK(state_of(mesh) == before);
  }
}

TEST_CASE("editable mesh: a change that its caller refuses leaves the mesh as it was", "[editable_mesh]") {
  EditableMesh mesh = grid().mesh();
  const auto before = state_of(mesh);
  MeshChange change;
  double made = 0;
  const auto never = [&] {
    made = 0;
    for (const RegionTriangle& t : change.made) made += mesh.normal(t).z / 2;
    return false;
  };
  const auto [triangle, edge] = side(mesh, kA, kD);
  CHECK(!mesh.flip(triangle, edge, change, never));
  CHECK(made == kSide * kSide);
  CHECK(!mesh.collapse(kA, kD, change, never));
  CHECK(made == 3 * kSide * kSide);  // the hexagon around a vertex
  CHECK(!mesh.split(kA, kD, vertex_at(384, 384, 0), change, never));
  CHECK(made == kSide * kSide);
  CHECK(!mesh.move(kA, vertex_at(200, 240, 0), change, never));
  CHECK(made == 3 * kSide * kSide);
  CHECK(state_of(mesh) == before);
}

TEST_CASE("editable mesh: what a triangle meets outside of shared corners is found", "[editable_mesh]") {
  Parts parts = grid();
  const auto across = uint32_t(parts.triangles.size());
  parts.add_apart({384, 384, -64}, {384, 400, 64}, {400, 384, 64});
  EditableMesh mesh = parts.mesh();
  mesh.keep_apart(kSide);
  std::vector<uint32_t> met;
  mesh.for_each_met(across, [&](uint32_t other) { met.push_back(other); });
  REQUIRE(!met.empty());
  for (const uint32_t t : met) {
    bool meets_back = false;
    mesh.for_each_met(t, [&](uint32_t other) { meets_back = meets_back || other == across; });
    CHECK(t != across);
    CHECK(meets_back);
  }
}

TEST_CASE("the tip of a low piece of a region does not go through what the piece lies on", "[features]") {
  // Region 1 is a pyramid on region 2, whose wall goes on around it.
  Parts parts;
  for (const WorldPoint& p : {WorldPoint{0, 0, 0}, {900, 0, 0}, {300, 900, 0}, {400, 300, 50}})
    parts.vertices.push_back(vertex_at(p.x, p.y, p.z, p.z > 0 ? Kind::free : Kind::corner));
  for (const WorldPoint& p : {WorldPoint{300, -900, 0}, {1500, 900, 0}, {-900, 900, 0}})
    parts.vertices.push_back(vertex_at(p.x, p.y, p.z, Kind::corner));
  const PatchLabels labels{{1, 0}, {2, 1}, {2, 0}};
  const auto add = [&](const Corners& corner, uint32_t patch) {
    parts.add(corner);
    parts.triangles.back().patch = patch;
  };
  for (const Corners& top : {Corners{0, 1, 3}, {1, 2, 3}, {2, 0, 3}}) add(top, 0);
  add({0, 1, 2}, 1);
  for (const Corners& around : {Corners{1, 0, 4}, {2, 1, 5}, {0, 2, 6}}) add(around, 2);
  for (const auto& [u, v] : {std::pair{0u, 1u}, {1u, 2u}, {2u, 0u}}) parts.put_on_curve(u, v, 0);
  EditableMesh mesh = parts.mesh();
  const auto move_to = [&](double x, double y, double z) {
    MeshChange change;
    return mesh.move(3, vertex_at(x, y, z), change, [&] { return are_sheets_in_order(mesh, change, labels); });
  };
  CHECK(move_to(500, 200, 20));
  CHECK_FALSE(move_to(400, 300, -50));
  CHECK(mesh.at(3) == WorldPoint{500, 200, 20});
  MeshChange change;
  bool is_in_order = false;
  CHECK_FALSE(mesh.move(3, vertex_at(400, 300, 0), change,
                        [&] { return is_in_order = are_sheets_in_order(mesh, change, labels); }));
  CHECK(is_in_order);  // of sheets that lie on each other either follows, but they meet
  CHECK(mesh.move(3, vertex_at(400, 300, -50), change, always));  // which nothing else keeps from happening
}
