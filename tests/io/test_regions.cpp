// Regions that faces part: in every format that holds them, and back from PLY files.
#include <nlohmann/json.hpp>

#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "run/choose_attributes.h"
#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;

namespace {

using Labels = std::vector<std::array<int32_t, 2>>;

/// Two tetrahedra with a wall between them: the regions 3 and 7 in a background.
TriangleMesh two_tetrahedra() {
  TriangleMesh mesh{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -1}},
                    {{0, 1, 3}, {0, 3, 2}, {1, 2, 3}, {0, 1, 2}, {0, 4, 1}, {0, 2, 4}, {1, 4, 2}}};
  mesh.regions.labels = {{3, 0}, {3, 0}, {3, 0}, {3, 7}, {7, 0}, {7, 0}, {7, 0}};
  mesh.regions.names = {{3, "femur"}, {7, "left tibia"}};
  return mesh;
}

std::string written(const TriangleMesh& mesh, const std::string& ending) {
  const TemporaryFolder folder;
  write_mesh(folder / ("mesh." + ending), mesh);
  return get_file(folder / ("mesh." + ending));
}

/// The faces of `two_tetrahedra`, one of them a row, with the two numbers of each row in properties of these types.
TriangleSoup ascii(const std::string& inside_type, const std::string& outside_type, const std::string& rows,
                   const std::string& notes = "") {
  return read_text_as("ply", "ply\nformat ascii 1.0\n" + notes +
                                 "element vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
                                 "element face 2\nproperty list uchar int vertex_indices\nproperty " +
                                 inside_type + " region_inside\nproperty " + outside_type +
                                 " region_outside\nproperty list uchar float texcoord\nend_header\n"
                                 "0 0 0\n1 0 0\n0 1 0\n" +
                                 rows);
}

}  // namespace

TEST_CASE("regions: a PLY file gives back every label, the names and the background", "[mesh_file][unit]") {
  TriangleMesh mesh = two_tetrahedra();
  for (const int32_t background : {0, -5}) {
    mesh.regions.background = background;
    for (auto& [inside, outside] : mesh.regions.labels) outside = outside == 7 ? 7 : background;
    const std::string file = written(mesh, "ply");
    CHECK(contains(file, "property int region_inside\nproperty int region_outside\n"));
    CHECK(contains(file, "comment region 7 left tibia\n"));
    const TriangleSoup soup = read_text_as("ply", file);
    CHECK(soup.triangles == mesh.triangles);
    CHECK(soup.regions.labels == mesh.regions.labels);
    CHECK(soup.regions.background == background);
    REQUIRE(soup.regions.names.size() == 2);
    CHECK(soup.regions.names[1].label == 7);
    CHECK(soup.regions.names[1].name == "left tibia");
    CHECK(soup.attributes.empty());
  }
}

TEST_CASE("regions: faces of a PLY file that have the background or the larger label behind them are turned",
          "[mesh_file][unit]") {
  const TriangleSoup soup = ascii("uchar", "short", "3 0 1 2 0 9 6 0 0 1 0 0 1\n3 0 2 1 9 4 6 0 0 0 1 1 0\n");
  CHECK(soup.regions.labels == Labels{{9, 0}, {4, 9}});
  CHECK(soup.triangles == std::vector<std::array<uint32_t, 3>>{{0, 2, 1}, {0, 1, 2}});
  const Attribute& uv = named(soup.attributes, kUvName);
  for (size_t corner = 0; corner < 6; ++corner) {
    const WorldPoint& p = soup.vertices[soup.triangles[corner / 3][corner % 3]];
    CHECK(uv.values[2 * corner] == p.x);
    CHECK(uv.values[2 * corner + 1] == p.y);
  }
}

TEST_CASE("regions: faces of sheets have one label on both sides and stay as they are turned", "[mesh_file][unit]") {
  const TriangleSoup soup = ascii("int", "int", "3 0 1 2 1 1 0\n3 0 2 1 0 0 0\n");
  CHECK(soup.regions.labels == Labels{{1, 1}, {0, 0}});
  CHECK(soup.triangles == std::vector<std::array<uint32_t, 3>>{{0, 1, 2}, {0, 2, 1}});
}

TEST_CASE("regions: numbers of faces that are no labels stay attributes", "[mesh_file][unit]") {
  const std::string rows = "3 0 1 2 1 2 0\n3 0 2 1 2 1 0\n";
  CHECK(ascii("int", "int", rows).regions.labels == Labels{{1, 2}, {1, 2}});
  for (const TriangleSoup& soup :
       {ascii("float", "int", rows), ascii("uint", "uint", "3 0 1 2 1 2 0\n3 0 2 1 2147483648 1 0\n")}) {
    CHECK(soup.regions.empty());
    CHECK(named(soup.attributes, "region_inside").values.size() == 2);
    CHECK(named(soup.attributes, "region_outside").values.size() == 2);
  }
}

TEST_CASE("regions: notes of a PLY file that are no names of regions are passed over", "[mesh_file][unit]") {
  const TriangleSoup soup = ascii("int", "int", "3 0 1 2 5 1 0\n3 0 2 1 2 1 0\n",
                                  "comment region of interest\ncomment region 5 b\ncomment region 5 c\n"
                                  "comment region 99999999999 d\ncomment region 2 a\ncomment region_background 1\n");
  CHECK(soup.regions.background == 1);
  CHECK(soup.regions.labels == Labels{{5, 1}, {2, 1}});
  REQUIRE(soup.regions.names.size() == 2);
  CHECK(soup.regions.names[0].name == "a");
  CHECK(soup.regions.names[1].name == "b");
}

TEST_CASE("regions: an OBJ file has a group for each pair, called by names where there are any", "[mesh_file][unit]") {
  TriangleMesh mesh = two_tetrahedra();
  const TriangleSoup soup = read_text_as("obj", written(mesh, "obj"));
  const Attribute& group = named(soup.attributes, kGroupName);
  CHECK(group.labels == std::vector<std::string>{"femur_0", "femur_left_tibia", "left_tibia_0"});
  CHECK(group.values == std::vector<double>{0, 0, 0, 1, 2, 2, 2});
  mesh.regions.names = {{3, "bone"}, {7, "bone"}};
  CHECK(contains(written(mesh, "obj"), "g 3_0\n"));
  CHECK(contains(written(mesh, "obj"), "g bone_bone\n"));
  mesh.attributes.push_back(
      {kGroupName, NumberType::i32, 1, {-1, 0, 0, 0, 0, 0, 0}, AttributeDomain::face, {}, {"leg"}});
  CHECK(contains(written(mesh, "obj"), "g leg bone_bone\n"));
}

TEST_CASE("regions: a glTF file has a primitive for each pair, which its extras name", "[mesh_file][unit]") {
  TriangleMesh mesh = two_tetrahedra();
  mesh.attributes.push_back(
      {kMaterialName, NumberType::i32, 1, {0, 0, 0, 0, 0, -1, -1}, AttributeDomain::face, {}, {"m"}});
  const nlohmann::json json = nlohmann::json::parse(written(mesh, "gltf"));
  const nlohmann::json& primitives = json["meshes"][0]["primitives"];
  REQUIRE(primitives.size() == 4);
  const int32_t pairs[4][2] = {{7, 0}, {3, 0}, {3, 7}, {7, 0}};
  const size_t corners[4] = {6, 9, 3, 3};
  for (size_t p = 0; p < 4; ++p) {
    CHECK(primitives[p]["extras"]["regions"] == nlohmann::json::array({pairs[p][0], pairs[p][1]}));
    CHECK(primitives[p].contains("material") == (p > 0));
    CHECK(json["accessors"][size_t(primitives[p]["indices"])]["count"] == corners[p]);
  }
  CHECK(json["meshes"][0]["extras"]["region_background"] == 0);
  CHECK(json["meshes"][0]["extras"]["region_names"]["7"] == "left tibia");
  CHECK(read_text_as("gltf", written(mesh, "gltf")).triangles.size() == 7);
}

TEST_CASE("regions: labels of another number of faces are refused", "[mesh_file][unit]") {
  TriangleMesh mesh = two_tetrahedra();
  mesh.regions.labels.pop_back();
  CHECK(says(error_of([&] { written(mesh, "ply"); }), "another number of faces"));
}

TEST_CASE("regions: a run whose format does not hold them warns", "[mesh_file][unit]") {
  for (const FileFormat& format : file_formats()) {
    Input input;
    input.facts.path = "bones.ply";
    input.soup.regions = two_tetrahedra().regions;
    AttributeReport report;
    std::string warnings;
    choose_attributes(input, {}, format.name, true, report, [&](MessageKind kind, const std::string& text) {
      if (kind == MessageKind::warning) warnings += text;
    });
    INFO(format.name);
    CHECK(contains(warnings, "which regions a face parts") == (format.name == "stl" || format.name == "off"));
  }
}
