// What stands at the vertices of the input stands at those of the result: values, choice, report and files.
#include <algorithm>
#include <cmath>
#include <functional>
#include <nlohmann/json.hpp>

#include "isoshell/advanced/transfer_attributes.h"
#include "isoshell/error.h"
#include "isoshell/run/run.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

using Names = std::vector<std::string>;

Attribute by_position(const TriangleSoup& soup, const std::string& name, NumberType type,
                      const std::function<double(WorldPoint)>& value) {
  Attribute a{name, type, 1, {}};
  for (const WorldPoint& p : soup.vertices) a.values.push_back(value(p));
  return a;
}

/// Red, green and blue rise from 0 to 1 along x, y and z of this cube.
Attribute linear_color(const TriangleSoup& soup, double lo, double hi) {
  Attribute a{"color", NumberType::f32, 3, {}};
  for (const WorldPoint& p : soup.vertices)
    for (const double at : {p.x, p.y, p.z}) a.values.push_back((at - lo) / (hi - lo));
  return a;
}

/// Square of n by n quads in the plane z = 0, from 0 to 1.
TriangleSoup sheet(uint32_t n) {
  TriangleSoup s;
  for (uint32_t j = 0; j <= n; ++j)
    for (uint32_t i = 0; i <= n; ++i) s.vertices.push_back({double(i) / n, double(j) / n, 0});
  for (uint32_t j = 0; j < n; ++j)
    for (uint32_t i = 0; i < n; ++i) {
      const uint32_t a = j * (n + 1) + i, b = a + 1, c = a + n + 2, d = a + n + 1;
      s.triangles.push_back({a, b, c});
      s.triangles.push_back({a, c, d});
    }
  return s;
}

/// A box whose top, bottom and sides share no vertex, with `side` 1, -1 and 0.
TriangleSoup plate(double thickness) {
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, thickness});
  TriangleSoup s;
  Attribute side{"side", NumberType::i8, 1, {}};
  for (const auto& t : box.triangles) {
    const auto is_at = [&](double z) {
      return std::all_of(t.begin(), t.end(), [&](uint32_t v) { return box.vertices[v].z == z; });
    };
    for (const uint32_t v : t) {
      s.vertices.push_back(box.vertices[v]);
      side.values.push_back(is_at(thickness) ? 1 : is_at(0) ? -1 : 0);
    }
    const auto n = uint32_t(s.vertices.size());
    s.triangles.push_back({n - 3, n - 2, n - 1});
  }
  s.attributes = {side};
  return s;
}

RunRequest request_of(int64_t vertices) {
  RemeshOptions options;
  options.vertices = vertices;
  RunRequest request;
  request.options = requested_options(options);
  return request;
}

RunResult run_of(TriangleSoup soup, const RunRequest& request, int threads = 0) {
  Context context;
  context.backend = Backend::cpu;
  context.threads = threads;
  return run(input_of(std::move(soup), "part"), request, context);
}

const std::vector<double>& values(const RunResult& result, const std::string& name) {
  return named(result.mesh.attributes, name).values;
}

/// The largest difference from the colour that `foot`, the nearest point of the surface, has.
double largest_error(const RunResult& result, double lo, double hi, const std::function<WorldPoint(WorldPoint)>& foot) {
  const std::vector<double>& color = values(result, "color");
  double largest = 0;
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v) {
    const WorldPoint p = foot(result.mesh.vertices[v]);
    const double wanted[] = {(p.x - lo) / (hi - lo), (p.y - lo) / (hi - lo), (p.z - lo) / (hi - lo)};
    for (size_t c = 0; c < 3; ++c) largest = std::max(largest, std::abs(color[3 * v + c] - wanted[c]));
  }
  return largest;
}

WorldPoint on_unit_box(WorldPoint p) {
  const WorldPoint in{std::clamp(p.x, 0., 1.), std::clamp(p.y, 0., 1.), std::clamp(p.z, 0., 1.)};
  if (in.x != p.x || in.y != p.y || in.z != p.z) return in;
  const double to_side[] = {p.x, 1 - p.x, p.y, 1 - p.y, p.z, 1 - p.z};
  switch (std::min_element(to_side, to_side + 6) - to_side) {
    case 0:
      return {0, p.y, p.z};
    case 1:
      return {1, p.y, p.z};
    case 2:
      return {p.x, 0, p.z};
    case 3:
      return {p.x, 1, p.z};
    case 4:
      return {p.x, p.y, 0};
    default:
      return {p.x, p.y, 1};
  }
}

}  // namespace

TEST_CASE("attributes: a colour that is linear in position is that of every vertex of a sphere", "[attributes]") {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 96);
  ball.attributes = {linear_color(ball, -1, 1)};
  const RunResult result = run_of(ball, request_of(3000));
  CHECK(largest_error(result, -1, 1, [](WorldPoint p) { return p; }) < 1 / 255.);
  CHECK(result.mesh.attributes[0].type == NumberType::f32);
  CHECK(result.mesh.attributes[0].components == 3);
}

TEST_CASE("attributes: on a box and an open sheet the colour is that of the nearest point", "[attributes]") {
  TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  box.attributes = {linear_color(box, 0, 1)};
  CHECK(largest_error(run_of(box, request_of(2000)), 0, 1, on_unit_box) < 1 / 255.);
  TriangleSoup open = sheet(20);
  open.attributes = {linear_color(open, 0, 1)};
  const auto on_sheet = [](WorldPoint p) { return WorldPoint{std::clamp(p.x, 0., 1.), std::clamp(p.y, 0., 1.), 0}; };
  CHECK(largest_error(run_of(open, request_of(2000)), 0, 1, on_sheet) < 1 / 255.);
}

TEST_CASE("attributes: whole numbers are rounded to the nearest", "[attributes]") {
  TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto height = [](WorldPoint p) { return 1000 * p.z - 500; };
  box.attributes = {by_position(box, "height", NumberType::i16, height),
                    by_position(box, "same", NumberType::f64, [](WorldPoint) { return 0.1; })};
  const RunResult result = run_of(box, request_of(2000));
  double largest = 0;
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v)
    largest = std::max(largest, std::abs(values(result, "height")[v] - height(on_unit_box(result.mesh.vertices[v]))));
  CHECK(largest <= 0.5 + 1e-9);
  for (const double value : values(result, "height")) CHECK(value == std::floor(value));
  for (const double value : values(result, "same")) CHECK(value == 0.1);
}

TEST_CASE("attributes: the two sides of a thin plate keep their own", "[attributes]") {
  for (const double thickness : {.03, .01, .002}) {
    INFO(thickness);
    const RunResult result = run_of(plate(thickness), request_of(3000));
    std::vector<double> up(result.mesh.vertices.size(), 0);  // of the sums of triangles' normals
    for (const auto& t : result.mesh.triangles) {
      const WorldPoint &a = result.mesh.vertices[t[0]], &b = result.mesh.vertices[t[1]],
                       &c = result.mesh.vertices[t[2]];
      const double z = (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x);
      for (const uint32_t v : t) up[v] += z;
    }
    int64_t wrong = 0, right = 0;
    for (size_t v = 0; v < up.size(); ++v) {
      const double side = values(result, "side")[v];
      wrong += up[v] * side < 0;
      right += up[v] * side > 0;
    }
    CHECK(wrong == 0);
    CHECK(right > int64_t(up.size()) * 8 / 10);
  }
}

TEST_CASE("attributes: a capped hole takes the nearest value, and stays flagged", "[attributes]") {
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 96);
  const auto is_above = [&](const std::array<uint32_t, 3>& t) { return ball.vertices[t[0]].z > .85; };
  ball.triangles.erase(std::remove_if(ball.triangles.begin(), ball.triangles.end(), is_above), ball.triangles.end());
  ball.attributes = {linear_color(ball, -1, 1)};
  const RunResult result = run_of(ball, request_of(3000));
  REQUIRE(result.mesh.gap.size() == result.mesh.vertices.size());
  CHECK(std::count(result.mesh.gap.begin(), result.mesh.gap.end(), 1) > 0);
  for (size_t v = 0; v < result.mesh.vertices.size(); ++v)
    if (result.mesh.gap[v]) CHECK(values(result, "color")[3 * v + 2] == Approx(.925).margin(.05));  // that of the rim
}

TEST_CASE("attributes: repair, union and any number of threads give the same values", "[attributes]") {
  TriangleSoup two =
      shapes::together(shapes::inside_out(shapes::sphere({0, 0, 0}, 1, 48)), shapes::sphere({.8, .1, 0}, 1, 48));
  two.triangles.push_back(two.triangles[5]);
  two.attributes = {linear_color(two, -1, 2)};
  const RunResult one = run_of(two, request_of(1500), 1), all = run_of(two, request_of(1500));
  CHECK(one.mesh.vertices.size() == 1500);
  CHECK(values(one, "color") == values(all, "color"));
  // Vertices where the balls meet lie beside both of them, by less than an edge.
  CHECK(largest_error(one, -1, 2, [](WorldPoint p) { return p; }) < .03);
}

TEST_CASE("attributes: of triangles that are equally near the first counts, one that looks away only alone",
          "[attributes]") {
  Context context;
  TriangleSoup source;
  source.vertices = {{-9, -9, 0}, {9, -9, 0},     {0, 9, 0},     {-9, -9, 0}, {9, -9, 0},
                     {0, 9, 0},   {-9, -9, -.25}, {9, -9, -.25}, {0, 9, -.25}};
  source.triangles = {{0, 1, 2}, {3, 4, 5}, {7, 6, 8}};
  const Attribute number{"number", NumberType::f32, 1, {0, 0, 0, 1, 1, 1, 2, 2, 2}};
  const auto found = [&](double z, bool looks_up) {
    TriangleMesh mesh{{{0, 0, z}, {1, 0, z}, {0, 1, z}}, {{0, 1, 2}}};
    if (!looks_up) std::swap(mesh.triangles[0][1], mesh.triangles[0][2]);
    return transfer_attributes(source, {number}, mesh, context)[0].values;
  };
  CHECK(found(.1, true) == std::vector<double>{0, 0, 0});
  CHECK(found(-.2, true) == std::vector<double>{0, 0, 0});
  CHECK(found(.1, false) == std::vector<double>{2, 2, 2});
  source.vertices[6].z = source.vertices[7].z = source.vertices[8].z = -1;  // more than half an edge farther away
  CHECK(found(.1, false) == std::vector<double>{0, 0, 0});
}

TEST_CASE("attributes: what does not fit is refused", "[attributes]") {
  Context context;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  const TriangleMesh mesh{box.vertices, box.triangles};
  const Attribute three{"a", NumberType::f32, 1, {1, 2, 3}}, eight{"a", NumberType::f32, 1, std::vector<double>(8)};
  CHECK(transfer_attributes(box, {}, mesh, context).empty());
  CHECK(says(error_of([&] { transfer_attributes(box, {three}, mesh, context); }), "has 3 values; 8 vertices need 1"));
  CHECK(says(error_of([&] { transfer_attributes({}, {eight}, mesh, context); }), "no triangle"));
  TriangleSoup wrong = box;
  TriangleMesh wrong_mesh = mesh;
  wrong.vertices[3].x = wrong_mesh.vertices[5].z = std::nan("");
  CHECK(says(error_of([&] { transfer_attributes(wrong, {eight}, mesh, context); }), "vertex 3 of the source is not"));
  CHECK(says(error_of([&] { transfer_attributes(box, {eight}, wrong_mesh, context); }), "vertex 5 of the mesh is not"));
  wrong = box;
  wrong.triangles[2][1] = wrong_mesh.triangles[0][0] = 8;
  CHECK(says(error_of([&] { transfer_attributes(wrong, {eight}, mesh, context); }), "names vertex 8; there are 8"));
  CHECK(says(error_of([&] { transfer_attributes(box, {eight}, wrong_mesh, context); }), "names vertex 8; there are 8"));
  wrong = box;
  wrong.attributes = {three};
  CHECK(error_of([&] { input_of(wrong, "part"); }).code() == ErrorCode::unreadable_input);
  context.cancel = true;
  CHECK(error_of([&] { transfer_attributes(box, {eight}, mesh, context); }).code() == ErrorCode::interrupted);
}

TEST_CASE("attributes: those that were asked for reach the file, and the statistics name the others", "[attributes]") {
  const TemporaryFolder folder;
  TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 48);
  const auto height = [](WorldPoint p) { return p.z; };
  ball.attributes = {linear_color(ball, -1, 1), by_position(ball, "heat", NumberType::f64, height),
                     by_position(ball, "depth", NumberType::f32, height)};
  ball.dropped_attributes = {{"nx", "normals are not kept"}};
  RunRequest request = request_of(300);
  request.output = named_output(folder / "a.ply", "", StopAfter::mesh);
  request.options.values.attributes = Names{"depth", "color"};
  RunResult result = run_of(ball, request);
  CHECK(result.record.attributes.kept == Names{"color", "depth"});
  const TriangleSoup written = read_mesh(folder / "a.ply");
  REQUIRE(written.attributes.size() == 2);
  CHECK(written.attributes[1].name == "depth");
  CHECK(written.attributes[1].values == values(result, "depth"));
  const auto j = nlohmann::json::parse(statistics_json(result.record));
  CHECK(j["attributes"]["kept"] == Names{"color", "depth"});
  CHECK(j["attributes"]["dropped"][0]["name"] == "nx");
  CHECK(j["attributes"]["dropped"][1]["name"] == "heat");
  CHECK(j["attributes"]["dropped"][1]["reason"] == "not asked for");
  CHECK(j["options"]["attributes"] == "depth,color");

  request.output = named_output(folder / "a.obj", "", StopAfter::mesh);
  result = run_of(ball, request);
  CHECK(result.record.attributes.kept == Names{"color"});
  CHECK(result.record.warnings == Names{"part: depth dropped: OBJ files hold no numbers but colours"});
  CHECK(read_mesh(folder / "a.obj").attributes.size() == 1);

  request.output = named_output(folder / "b.ply", "", StopAfter::mesh);
  request.options.values.attributes = Names{};
  CHECK(run_of(ball, request).mesh.attributes.empty());
  CHECK(read_mesh(folder / "b.ply").attributes.empty());
}

TEST_CASE("attributes: a name that the mesh does not have is refused, with those that it has", "[attributes]") {
  TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  box.attributes = {linear_color(box, 0, 1)};
  box.dropped_attributes = {{"nx", "normals are not kept"}};
  RunRequest request = request_of(100);
  request.options.values.attributes = Names{"color", "colour"};
  const Error unknown = error_of([&] { run_of(box, request); });
  CHECK(unknown.code() == ErrorCode::usage);
  CHECK(says(unknown, "'colour', which part does not have; it has: color"));
  request.options.values.attributes = Names{"nx"};
  CHECK(says(error_of([&] { run_of(box, request); }), "'nx', but normals are not kept; it has: color"));
}

TEST_CASE("attributes: what is no mesh has none, which is said when one was asked for", "[attributes]") {
  PointCloud cloud;
  cloud.position = shapes::sphere({0, 0, 0}, 1, 60).vertices;
  Context context;
  context.backend = Backend::cpu;
  RunRequest request = request_of(200);
  CHECK(run(input_of(cloud, "cloud", 0), request, context).record.warnings.empty());
  request.options.values.attributes = Names{"color"};
  const RunResult result = run(input_of(cloud, "cloud", 0), request, context);
  REQUIRE(result.record.warnings.size() == 1);
  CHECK(result.record.warnings[0].find("--attributes") != std::string::npos);
  CHECK(result.mesh.attributes.empty());
}
