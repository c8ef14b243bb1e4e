// What files hold of the corners of faces and of faces: read, written, and refused.
#include <cmath>
#include <cstring>

#include "core/attribute_values.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

using Names = std::vector<std::string>;
using Values = std::vector<double>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Values of_corner(const Attribute& a, size_t corner) {
  const double* const value = value_of(a, corner);
  return {value, value + a.components};
}

/// The label of each face, "" being none.
Names labels(const Attribute& a) {
  Names all;
  for (const double number : a.values) all.push_back(number < 0 ? "" : a.labels[size_t(number)]);
  return all;
}

/// Every corner has the value that `expected` gives for its vertex and face.
template <class Expected>
int64_t wrong_corners(const TriangleSoup& soup, const Attribute& a, Expected expected) {
  int64_t wrong = 0;
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) wrong += of_corner(a, 3 * t + i) != expected(t, soup.triangles[t][i]);
  return wrong;
}

/// A torus with texture coordinates and normals that differ from face to face, and three materials.
TriangleMesh decorated_torus(uint32_t n) {
  const TriangleSoup torus = shapes::torus(3, 1, n, n / 2);
  TriangleMesh mesh{torus.vertices, torus.triangles};
  Attribute uv{kUvName, NumberType::f32, 2, {}, AttributeDomain::corner};
  Attribute normal{kNormalName, NumberType::f32, 3, {}, AttributeDomain::corner};
  Attribute material{kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"red steel", "b", "c#"}};
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    for (const uint32_t v : mesh.triangles[t]) {
      uv.index.push_back(uint32_t(uv.values.size() / 2));
      uv.values.insert(uv.values.end(), {double(float(t) / 4), double(float(v) / 8)});
      normal.values.insert(normal.values.end(), {double(t % 7), double(v % 5), 1});
    }
    material.values.push_back(double(t % 4) - 1);
  }
  mesh.attributes = {uv, normal, material};
  mesh.files.materials = {"parts of it.mtl"};
  return mesh;
}

template <class T>
void put(std::string& out, T value, bool big_endian) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (size_t i = 0; i < sizeof(T); ++i) out += bytes[big_endian ? sizeof(T) - 1 - i : i];
}

}  // namespace

TEST_CASE("corners: OBJ gives texture coordinates, normals and names to the faces", "[mesh_file][unit]") {
  const TriangleSoup soup =
      read_text_as("obj", "mtllib a b.mtl\n" + kSquare +
                              "v 2 0 0\nvt 0 0\nvt 1 0 0\nvt 1 1\nvt .25\nvn 0 0 1\nvn 0 0 -2\n"
                              "f 1/1/1 2/2/1 3/3/1 4/4/1\no thing\ng left  right \nusemtl steel # x\nf 2//2 5/-1 3/3\n"
                              "g\nusemtl wood\nf 2/1 5/2 3/3\n");
  REQUIRE(names_of(soup.attributes) == Names{"uv", "normal", "object", "group", "material"});
  CHECK(soup.files.materials == Names{"a b.mtl"});
  REQUIRE(soup.triangles.size() == 4);
  const Attribute& uv = named(soup.attributes, "uv");
  const Values of_vertex[] = {{0, 0}, {1, 0}, {1, 1}, {.25, 0}};
  for (size_t corner = 0; corner < 6; ++corner)
    CHECK(of_corner(uv, corner) == of_vertex[soup.triangles[corner / 3][corner % 3]]);
  CHECK(std::isnan(of_corner(uv, 6)[0]));
  CHECK(of_corner(uv, 7) == Values{.25, 0});
  CHECK(of_corner(uv, 8) == Values{1, 1});
  CHECK(of_corner(named(soup.attributes, "normal"), 6) == Values{0, 0, -2});
  CHECK(std::isnan(of_corner(named(soup.attributes, "normal"), 7)[0]));
  CHECK(labels(named(soup.attributes, "object")) == Names{"", "", "thing", "thing"});
  CHECK(labels(named(soup.attributes, "group")) == Names{"", "", "left  right", ""});
  CHECK(labels(named(soup.attributes, "material")) == Names{"", "", "steel # x", "wood"});
}

TEST_CASE("corners: those of a polygon of very many keep their values, and the first one where a vertex repeats",
          "[mesh_file][unit]") {
  constexpr size_t kCorners = 30000;
  std::string text, values, corners;
  for (size_t i = 0; i < kCorners; ++i) {
    const double x = double(i < kCorners / 2 ? i : kCorners - i);
    text += "v " + std::to_string(x) + " " + std::to_string(i < kCorners / 2 ? -x * x : x * x + 1) + " 0\n";
    values += "vt " + std::to_string(i) + " 0\n";
    corners += " " + std::to_string(i + 1) + "/" + std::to_string(i + 1);
  }
  const TriangleSoup soup = read_text_as("obj", text + values + "vt -1 0\nf" + corners + " 1/-1\n");
  REQUIRE(soup.triangles.size() == kCorners - 2);
  const auto of_vertex = [](size_t, uint32_t v) { return Values{double(v), 0}; };
  CHECK(wrong_corners(soup, named(soup.attributes, "uv"), of_vertex) == 0);
}

TEST_CASE("corners: OBJ's indices that name nothing are refused with line and value", "[mesh_file][unit]") {
  const auto refusal = [](const std::string& face) {
    return error_of([&] { read_text_as("obj", kSquare + "vt 0 0\nvt 1 1\nvn 0 0 1\n" + face + "\n"); });
  };
  CHECK(
      says(refusal("f 1/1 2/3 3/1"),
           "line 8: a face names texture coordinate 3; the file holds texture coordinates 1 to 2; correct the index"));
  CHECK(says(refusal("f 1/1 2/-3 3/1"), "texture coordinate -3; 2 texture coordinates come before it, so -1 to -2"));
  CHECK(says(refusal("f 1/0 2/1 3/1"), "texture coordinate 0;"));
  CHECK(says(refusal("f 1//1 2//2 3//1"), "line 8: a face names normal 2; the file holds normals 1 to 1"));
  CHECK(says(refusal("f 1/a 2/1 3/1"), "line 8: a face corner is '1/a'; numbers of a vertex, a texture coordinate"));
  CHECK(says(refusal("f 1/1/1/1 2 3"), "'1/1/1/1'"));
  CHECK(says(error_of([] { read_text_as("obj", kSquare + "vt\nf 1/1 2/1 3/1\n"); }),
             "line 5: a texture coordinate needs a number; found the end of the line"));
  CHECK(says(error_of([] { read_text_as("obj", kSquare + "vn 0 0\nf 1 2 3\n"); }), "line 5: a normal needs three"));
  CHECK(read_text_as("obj", kSquare + "f 1/7/9 2/8 3//x\n").attributes.empty());  // there is nothing to name
  CHECK(read_text_as("obj", kSquare + "vt 0 0\nf 1 2 3\n").attributes.empty());   // and nothing that is named
}

TEST_CASE("corners: OBJ brings back what a large mesh has, sorted by material", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleMesh mesh = decorated_torus(240);
  write_mesh(folder / "a.obj", mesh);
  const TriangleSoup soup = read_mesh(folder / "a.obj");
  CHECK(soup.files.materials == mesh.files.materials);
  REQUIRE(names_of(soup.attributes) == Names{"uv", "normal", "material"});
  std::vector<size_t> order;
  for (const int material : {-1, 0, 1, 2})
    for (size_t t = 0; t < mesh.triangles.size(); ++t)
      if (mesh.attributes[2].values[t] == material) order.push_back(t);
  int64_t wrong = 0;
  for (size_t t = 0; t < order.size(); ++t) wrong += soup.triangles[t] != mesh.triangles[order[t]];
  CHECK(wrong == 0);
  CHECK(wrong_corners(soup, named(soup.attributes, "uv"), [&](size_t t, uint32_t v) {
          return Values{double(float(order[t]) / 4), double(float(v) / 8)};
        }) == 0);
  CHECK(wrong_corners(soup, named(soup.attributes, "normal"), [&](size_t t, uint32_t v) {
          return Values{double(order[t] % 7), double(v % 5), 1};
        }) == 0);
  const Names found = labels(named(soup.attributes, "material"));
  for (size_t t = 0; t < order.size(); ++t) wrong += found[t] != (Names{"", "red steel", "b", "c#"})[order[t] % 4];
  CHECK(wrong == 0);
}

TEST_CASE("corners: PLY brings back what a large mesh has", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  TriangleMesh mesh = decorated_torus(240);
  mesh.files.textures = {"wood grain.png", "b.jpg"};
  mesh.attributes.push_back(
      {kTextureName, NumberType::i32, 1, Values(mesh.triangles.size(), 1), AttributeDomain::face});
  mesh.attributes.push_back(
      {kColorName, NumberType::u8, 3, Values(3 * mesh.triangles.size(), 9), AttributeDomain::face});
  mesh.attributes.push_back({kColorName, NumberType::u8, 4, Values(4 * mesh.vertices.size(), 5)});
  write_mesh(folder / "a.ply", mesh);
  const TriangleSoup soup = read_mesh(folder / "a.ply");
  CHECK(soup.triangles == mesh.triangles);
  CHECK(soup.files.materials == mesh.files.materials);
  CHECK(soup.files.textures == mesh.files.textures);
  REQUIRE(names_of(soup.attributes) == Names{"color", "uv", "normal", "material", "texnumber", "color"});
  CHECK(soup.attributes[0].values == mesh.attributes[5].values);
  CHECK(soup.attributes[5].domain == AttributeDomain::face);
  CHECK(soup.attributes[5].values == mesh.attributes[4].values);
  CHECK(named(soup.attributes, "texnumber").values == mesh.attributes[3].values);
  CHECK(named(soup.attributes, "uv").values == mesh.attributes[0].values);
  CHECK(named(soup.attributes, "normal").values == mesh.attributes[1].values);
  CHECK(named(soup.attributes, "material").values == mesh.attributes[2].values);
  CHECK(named(soup.attributes, "material").labels == mesh.attributes[2].labels);
}

TEST_CASE("corners: PLY's lists of texture coordinates are read as MeshLab writes them", "[mesh_file][unit]") {
  const std::string head =
      "ply\nformat ascii 1.0\ncomment VCGLIB generated\ncomment TextureFile my image.png\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nelement face 2\n"
      "property list uchar int vertex_indices\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "property list uchar float texcoord\nproperty int texnumber\nproperty list uchar int marks\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
  const TriangleSoup soup =
      read_text_as("ply", head + "4 0 1 2 3 1 2 3 8 0 .5 1 .5 1 1 0 1 2 1 7\n3 3 2 1 4 5 6 0 0 0\n");
  REQUIRE(names_of(soup.attributes) == Names{"color", "uv", "texnumber"});
  CHECK(soup.files.textures == Names{"my image.png"});
  const Values of_vertex[] = {{0, .5}, {1, .5}, {1, 1}, {0, 1}};
  for (size_t corner = 0; corner < 6; ++corner)
    CHECK(of_corner(named(soup.attributes, "uv"), corner) == of_vertex[soup.triangles[corner / 3][corner % 3]]);
  CHECK(std::isnan(of_corner(named(soup.attributes, "uv"), 7)[1]));
  CHECK(named(soup.attributes, "texnumber").values == Values{2, 2, 0});
  CHECK(named(soup.attributes, "color").values == Values{1, 2, 3, 1, 2, 3, 4, 5, 6});
  REQUIRE(soup.dropped_attributes.size() == 1);
  CHECK(soup.dropped_attributes[0].name == "marks");
  const Error wrong =
      error_of([&] { read_text_as("ply", head + "4 0 1 2 3 1 2 3 0 0 0\n3 3 2 1 4 5 6 5 1 2 3 4 5 0 0\n"); });
  CHECK(wrong.code() == ErrorCode::unreadable_input);
  CHECK(says(wrong, "line 23: a face of 3 corners has 5 values in its list texcoord; 2 a corner are needed, or none"));
}

TEST_CASE("corners: both byte orders of binary PLY bring values of faces, in rows of changing length",
          "[mesh_file][unit]") {
  for (const bool big_endian : {false, true}) {
    std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                        "_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
                        "property float u\nproperty float v\nelement face 2\nproperty short rank\n"
                        "property list uchar int vertex_indices\nproperty double heat\nend_header\n";
    for (int v = 0; v < 4; ++v)
      for (const float value : {float(v == 1 || v == 2), float(v > 1), 0.f, v / 4.f, v / 8.f})
        put(bytes, value, big_endian);
    for (const int count : {4, 3}) {
      put(bytes, int16_t(-count), big_endian);
      bytes += char(count);
      for (int32_t v = 0; v < count; ++v) put(bytes, v, big_endian);
      put(bytes, count + .5, big_endian);
    }
    const TriangleSoup soup = read_text_as("ply", bytes);
    REQUIRE(names_of(soup.attributes) == Names{"uv", "rank", "heat"});
    CHECK(named(soup.attributes, "rank").values == Values{-4, -4, -3});
    CHECK(named(soup.attributes, "heat").values == Values{4.5, 4.5, 3.5});
    CHECK(wrong_corners(soup, named(soup.attributes, "uv"), [](size_t, uint32_t v) {
            return Values{v / 4., v / 8.};
          }) == 0);
  }
}

TEST_CASE("corners: normals that are the same all around stand at PLY's vertices", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 12);
  Attribute normal{kNormalName, NumberType::f32, 3, {}, AttributeDomain::corner};
  for (const auto& t : ball.triangles) normal.index.insert(normal.index.end(), t.begin(), t.end());
  for (const WorldPoint& p : ball.vertices)
    for (const double x : {p.x, p.y, p.z}) normal.values.push_back(double(float(x)));
  write_mesh(folder / "a.ply", {ball.vertices, ball.triangles, {}, {normal}});
  CHECK(get_file(folder / "a.ply").find("property float nx\n") != std::string::npos);
  const TriangleSoup back = read_mesh(folder / "a.ply");
  REQUIRE(names_of(back.attributes) == Names{"normal"});
  CHECK(back.attributes[0].values == normal.values);
  CHECK(back.attributes[0].index == normal.index);
}

TEST_CASE("corners: labels that do not fit their numbers are no labels", "[mesh_file][unit]") {
  const auto soup = [](const std::string& number) {
    return read_text_as("ply",
                        "ply\nformat ascii 1.0\ncomment label part 0 lid\ncomment label part 2 lost\n"
                        "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                        "element face 1\nproperty list uchar int vertex_indices\nproperty int part\nend_header\n"
                        "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 " +
                            number + "\n");
  };
  CHECK(labels(named(soup("0").attributes, "part")) == Names{"lid"});
  CHECK(named(soup("1").attributes, "part").labels.empty());
  CHECK(named(soup("1").attributes, "part").values == Values{1});
}

TEST_CASE("corners: what does not fit a mesh, or PLY, is refused", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto refusal = [&](const Attribute& a) {
    return error_of([&] { write_mesh(folder / "a.ply", {box.vertices, box.triangles, {}, {a}}); });
  };
  const AttributeDomain corner = AttributeDomain::corner, face = AttributeDomain::face;
  CHECK(says(refusal({kUvName, NumberType::f32, 2, Values(6), corner}), "6 values; 36 corners need 2 each"));
  CHECK(says(refusal({"a", NumberType::f32, 1, Values(3), face}), "3 values; 12 faces need 1 each"));
  CHECK(says(refusal({kUvName, NumberType::f32, 2, Values(2), corner, {0, 0}}), "2 indices; 36 corners need one each"));
  CHECK(says(refusal({kUvName, NumberType::f32, 2, Values(2), corner, std::vector<uint32_t>(36, 1)}), "the index 1"));
  CHECK(says(refusal({"a", NumberType::i32, 1, Values(12, 2), face, {}, {"x", "y"}}), "the number 2.0"));
  CHECK(says(refusal({"a", NumberType::i32, 1, Values(36), corner}), "'a' of corners"));
  CHECK(folder.file_count() == 0);
}
