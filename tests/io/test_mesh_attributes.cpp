// What stands at the vertices of files: read with its name and type, written, and refused.
#include <cmath>
#include <cstring>
#include <limits>

#include "isoshell/io/point_file.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"

using namespace isoshell;

namespace {

const std::string kPlace = "property float x\nproperty float y\nproperty float z\n";
const std::string kFace = "element face 1\nproperty list uchar int vertex_indices\nend_header\n";

/// One triangle as text, with these properties behind the positions and these values in the rows.
TriangleSoup ascii(const std::string& properties, const std::string (&rows)[3]) {
  return read_text_as("ply", "ply\nformat ascii 1.0\nelement vertex 3\n" + kPlace + properties + kFace + "0 0 0 " +
                                 rows[0] + "\n1 0 0 " + rows[1] + "\n0 1 0 " + rows[2] + "\n3 0 1 2\n");
}

template <class T>
void put(std::string& out, T value, bool big_endian) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof(T));
  for (size_t i = 0; i < sizeof(T); ++i) out += bytes[big_endian ? sizeof(T) - 1 - i : i];
}

using Names = std::vector<std::string>;
using Values = std::vector<double>;

}  // namespace

TEST_CASE("attributes: numbers of a PLY file's vertices come with their names and types", "[mesh_file][unit]") {
  const TriangleSoup soup = ascii(
      "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\nproperty double quality\n"
      "property int id\nproperty float nx\nproperty float ny\nproperty float nz\nproperty list uchar int near\n"
      "property float s\nproperty float t\nproperty uchar gap\n",
      {"1 2 3 4 0.1 -7 0 0 1 2 5 6 .5 .5 1", "5 6 7 8 1e300 8 0 0 1 0 .5 .5 1", "255 0 9 1 -2 9 0 0 1 1 4 .5 .5 0"});
  REQUIRE(names_of(soup.attributes) == Names{"color", "quality", "id", "normal", "uv"});
  CHECK(soup.attributes[0].type == NumberType::u8);
  CHECK(soup.attributes[0].components == 4);
  CHECK(soup.attributes[0].values == Values{1, 2, 3, 4, 5, 6, 7, 8, 255, 0, 9, 1});
  CHECK(soup.attributes[1].type == NumberType::f64);
  CHECK(soup.attributes[1].values == Values{0.1, 1e300, -2});
  CHECK(soup.attributes[2].type == NumberType::i32);
  CHECK(soup.attributes[2].values == Values{-7, 8, 9});
  Names dropped;
  for (const DroppedAttribute& d : soup.dropped_attributes) dropped.push_back(d.name + ": " + d.reason);
  CHECK(dropped == Names{"near: lists are not kept", "gap: the result has its own flag of that name"});
  CHECK(soup.attributes[3].domain == AttributeDomain::corner);
  CHECK(soup.attributes[4].domain == AttributeDomain::corner);
  CHECK(soup.attributes[4].index == std::vector<uint32_t>{0, 1, 2});
  CHECK(soup.attributes[4].values == Values{.5, .5, .5, .5, .5, .5});
}

TEST_CASE("attributes: both byte orders of binary PLY are read, in rows of fixed and of changing length",
          "[mesh_file][unit]") {
  for (const bool big_endian : {false, true})
    for (const bool has_list : {false, true}) {
      std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                          "_endian 1.0\nelement vertex 3\nproperty short heat\n" + kPlace +
                          (has_list ? "property list uchar uchar near\n" : "") + "property float blue\n" +
                          "property float red\nproperty float green\n" + kFace;
      const float xyz[3][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
      for (int v = 0; v < 3; ++v) {
        put(bytes, int16_t(-100 * v), big_endian);
        for (const float value : xyz[v]) put(bytes, value, big_endian);
        if (has_list) bytes += std::string(1, char(v)) + std::string(size_t(v), 'x');
        for (int part = 0; part < 3; ++part) put(bytes, float(v) + 0.25f * float(part), big_endian);
      }
      bytes += '\3';
      for (int32_t v = 0; v < 3; ++v) put(bytes, v, big_endian);
      const TriangleSoup soup = read_text_as("ply", bytes);
      CHECK(names_of(soup.attributes) == Names{"heat", "color"});
      CHECK(soup.attributes[0].values == Values{0, -100, -200});
      CHECK(soup.attributes[1].values == Values{.25, .5, 0, 1.25, 1.5, 1, 2.25, 2.5, 2});
      CHECK(soup.attributes[1].type == NumberType::f32);
      CHECK(same_bits(soup.vertices[1], {1, 0, 0}));
    }
}

TEST_CASE("attributes: red, green and blue are the colour only together, of one type, and under a free name",
          "[mesh_file][unit]") {
  CHECK(names_of(ascii("property uchar red\nproperty uchar green\n", {"1 2", "1 2", "1 2"}).attributes) ==
        Names{"red", "green"});
  CHECK(names_of(ascii("property uchar red\nproperty uchar green\nproperty float blue\n", {"1 2 3", "1 2 3", "1 2 3"})
                     .attributes) == Names{"red", "green", "blue"});
  CHECK(names_of(ascii("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float alpha\n",
                       {"1 2 3 .5", "1 2 3 .5", "1 2 3 .5"})
                     .attributes) == Names{"color", "alpha"});
  CHECK(names_of(ascii("property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float color\n",
                       {"1 2 3 .5", "1 2 3 .5", "1 2 3 .5"})
                     .attributes) == Names{"red", "green", "blue", "color"});
}

TEST_CASE("attributes: a property may have the name of a keyword or a type", "[mesh_file][unit]") {
  const TriangleSoup soup = ascii(
      "property float element\nproperty float end_header\nproperty float property\nproperty uchar float\n"
      "property float list\nproperty float u\n",
      {"1 2 3 4 5 6", "1 2 3 4 5 6", "1 2 3 4 5 6"});
  CHECK(names_of(soup.attributes) == Names{"element", "end_header", "property", "float", "list", "u"});
  const TemporaryFolder folder;
  write_mesh(folder / "a.ply", {soup.vertices, soup.triangles, {}, soup.attributes});
  const TriangleSoup back = read_mesh(folder / "a.ply");
  CHECK(names_of(back.attributes) == names_of(soup.attributes));
  CHECK(named(back.attributes, "end_header").values == Values{2, 2, 2});
}

TEST_CASE("attributes: text that is no number is refused with its line, one out of range limited",
          "[mesh_file][unit]") {
  const auto refusal = [](const std::string& properties, const std::string& row) {
    return error_of([&] { ascii(properties, {"1", row, "1"}); });
  };
  CHECK(says(refusal("property float q\n", "red"), "line 12: element vertex: a number is expected; found 'red'"));
  CHECK(says(refusal("property float q\n", ""), "found the end of the line"));
  CHECK(says(refusal("property float\n", "1"), "line 7: a property line needs a type and a name"));
  CHECK(says(refusal("property half q\n", "1"), "'half' is no PLY type"));
  CHECK(says(refusal("property float x\n", "1"), "declared twice"));
  CHECK(ascii("property uchar q\n", {"300", "-1", "1.5"}).attributes[0].values == Values{255, 0, 2});
  CHECK(ascii("property int q\n", {"1e10", "-2.5", "-1e10"}).attributes[0].values ==
        Values{2147483647, -2, -2147483648.});
  CHECK(std::isnan(ascii("property float q\n", {"1", "nan", "2"}).attributes[0].values[1]));
}

TEST_CASE("attributes: PLY brings every type back, beside the flag for gaps", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 1, 12);
  TriangleMesh mesh{ball.vertices, ball.triangles, std::vector<uint8_t>(ball.vertices.size(), 1)};
  const double largest[] = {127, 255, 32767, 65535, 2147483647, 4294967295., 3.5, 1e300};
  for (int type = 0; type < 8; ++type) {
    Attribute a{"p" + std::to_string(type), NumberType(type), 1, Values(ball.vertices.size(), 0)};
    a.values[1] = largest[type];
    a.values[2] = 1;
    mesh.attributes.push_back(a);
  }
  mesh.attributes.push_back({"color", NumberType::u8, 4, Values(4 * ball.vertices.size(), 200)});
  write_mesh(folder / "a.ply", mesh);
  const TriangleSoup soup = read_mesh(folder / "a.ply");
  REQUIRE(soup.attributes.size() == mesh.attributes.size());
  for (size_t i = 0; i < mesh.attributes.size(); ++i) {
    INFO(mesh.attributes[i].name);
    CHECK(soup.attributes[i].name == mesh.attributes[i].name);
    CHECK(soup.attributes[i].type == mesh.attributes[i].type);
    CHECK(soup.attributes[i].values == mesh.attributes[i].values);
  }
  CHECK(soup.triangles == mesh.triangles);
}

TEST_CASE("attributes: OBJ holds colours from 0 to 1 behind positions", "[mesh_file][unit]") {
  const TriangleSoup soup =
      read_text_as("obj",
                   "v 0 0 0 .5 0.25 1\r\nv 1 0 0\nv 0 1 0 1 0 0 # red\nv 1 1 0 1\nv 2 1 0 1 .1 .2 .3\n"
                   "v 2 2 0 1 0 zero\nf 1 2 3\nf 4 5 6\n");
  REQUIRE(names_of(soup.attributes) == Names{"color"});
  CHECK(soup.attributes[0].values == Values{.5, .25, 1, 1, 1, 1, 1, 0, 0, 1, 1, 1, 1, 1, 1, 1, 1, 1});
  CHECK(read_text_as("obj", "v 0 0 0 1\nv 1 0 0\nv 0 1 0\nf 1 2 3\n").attributes.empty());
  const TemporaryFolder folder;
  TriangleMesh mesh{soup.vertices, soup.triangles, {}, soup.attributes};
  write_mesh(folder / "a.obj", mesh);
  const TriangleSoup back = read_mesh(folder / "a.obj");
  CHECK(back.attributes[0].values == soup.attributes[0].values);
  CHECK(back.triangles == soup.triangles);
  mesh.attributes = {{"heat", NumberType::f32, 1, Values(6, 3)}, {"color", NumberType::u8, 4, Values(24, 51)}};
  write_mesh(folder / "b.obj", mesh);
  CHECK(get_file(folder / "b.obj").compare(0, 20, "v 0 0 0 0.2 0.2 0.2\n") == 0);
}

TEST_CASE("attributes: OBJ's colours are found in every part of a large file", "[mesh_file][unit]") {
  TriangleSoup torus = shapes::torus(3, 1, 200, 100);
  Attribute color{"color", NumberType::f32, 3, {}};
  for (size_t i = 0; i < 3 * torus.vertices.size(); ++i) color.values.push_back(double(float(i % 1000) / 1000));
  const TemporaryFolder folder;
  write_mesh(folder / "a.obj", {torus.vertices, torus.triangles, {}, {color}});
  REQUIRE(read_mesh(folder / "a.obj").attributes.size() == 1);
  const Values back = read_mesh(folder / "a.obj").attributes[0].values;
  int64_t wrong = 0;
  for (size_t i = 0; i < back.size(); ++i) wrong += float(back[i]) != float(color.values[i]);
  CHECK(wrong == 0);
}

TEST_CASE("attributes: a mesh with attributes that cannot be written is refused", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  const auto refusal = [&](std::vector<Attribute> attributes) {
    return error_of([&] { write_mesh(folder / "a.ply", {box.vertices, box.triangles, {}, std::move(attributes)}); });
  };
  const Values eight(8, 1);
  CHECK(refusal({{"a", NumberType::f32, 1, {1, 2}}}).code() == ErrorCode::usage);
  CHECK(says(refusal({{"a", NumberType::f32, 1, {1, 2}}}), "has 2 values; 8 vertices need 1 each"));
  CHECK(says(refusal({{"a b", NumberType::f32, 1, eight}}), "'a b'"));
  CHECK(says(refusal({{"", NumberType::f32, 1, eight}}), "''"));
  CHECK(says(refusal({{"x", NumberType::f32, 1, eight}}), "would have the name 'x'"));
  CHECK(says(refusal({{"gap", NumberType::f32, 1, eight}}), "would have the name 'gap'"));
  CHECK(says(refusal({{"a", NumberType::f32, 1, eight}, {"a", NumberType::u8, 1, eight}}), "the name 'a'"));
  CHECK(says(refusal({{"a", NumberType::f32, 2, Values(16, 0)}}), "of 2 components"));
  CHECK(folder.file_count() == 0);
}

TEST_CASE("attributes: a PLY file without faces is still a cloud", "[mesh_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "a.ply", "ply\nformat ascii 1.0\nelement vertex 2\n" + kPlace +
                                 "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n"
                                 "0 0 0 1 2 3\n1 1 1 4 5 6\n");
  CHECK(read_points(folder / "a.ply", "ply").position.size() == 2);
}
