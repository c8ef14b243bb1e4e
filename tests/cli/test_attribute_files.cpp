// What a file has beside its positions, through the command into other files.
#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;
using Json = nlohmann::json;

namespace {

const std::string kQuick = " --vertices 300 --resolution 48 ";

}  // namespace

TEST_CASE("attribute files: numbers at the vertices of a file reach the result, and a wrong name lists them", "[cli]") {
  Folder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  TriangleMesh mesh{ball.vertices, ball.triangles};
  mesh.attributes = {{"color", NumberType::u8, 3, std::vector<double>(3 * ball.vertices.size(), 77)},
                     {"heat", NumberType::f64, 1, std::vector<double>(ball.vertices.size(), 0.1)}};
  write_mesh(folder / "ball.ply", mesh);
  REQUIRE(folder.run("ball.ply out.ply --stats s.json" + kQuick).status == 0);
  const std::vector<Attribute> found = read_mesh(folder / "out.ply").attributes;
  REQUIRE(found.size() == 2);
  CHECK(found[0].type == NumberType::u8);
  CHECK(found[0].values == std::vector<double>(900, 77));
  CHECK(found[1].values == std::vector<double>(300, 0.1));
  CHECK(Json::parse(folder.content("s.json"))["attributes"]["kept"] == Json({"color", "heat"}));
  const auto wrong = folder.run("ball.ply wrong.ply --attributes heat,age" + kQuick);
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err, "'age', which ball.ply does not have; it has: color, heat"));
}

TEST_CASE("attribute files: texture coordinates, materials and their library go from OBJ to OBJ and PLY", "[cli]") {
  Folder folder;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 1, 1});
  TriangleMesh mesh{box.vertices, box.triangles};
  Attribute uv{kUvName, NumberType::f32, 2, {}, AttributeDomain::corner};
  Attribute material{kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"steel", "wood"}};
  for (size_t t = 0; t < box.triangles.size(); ++t) {
    const bool is_top = std::all_of(box.triangles[t].begin(), box.triangles[t].end(),
                                    [&](uint32_t v) { return box.vertices[v].z == 1; });
    for (const uint32_t v : box.triangles[t])
      uv.values.insert(uv.values.end(), {box.vertices[v].x + box.vertices[v].z, box.vertices[v].y + 3 * is_top});
    material.values.push_back(is_top);
  }
  mesh.attributes = {uv, material};
  mesh.files.materials = {"box.mtl"};
  write_mesh(folder / "box.obj", mesh);
  REQUIRE(folder.run("box.obj out.obj --features auto --stats s.json" + kQuick).status == 0);
  const std::string text = folder.content("out.obj");
  CHECK(text.compare(0, 15, "mtllib box.mtl\n") == 0);
  CHECK(contains(text, "\nusemtl wood\nf "));
  CHECK(contains(text, "\nvt "));
  const Json stats = Json::parse(folder.content("s.json"));
  CHECK(stats["attributes"]["kept"] == Json({"uv", "material"}));
  CHECK(stats["features"]["kept"] == true);
  REQUIRE(folder.run("box.obj out.ply --attributes material" + kQuick).status == 0);
  const TriangleSoup back = read_mesh(folder / "out.ply");
  REQUIRE(back.attributes.size() == 1);
  CHECK(back.attributes[0].labels == std::vector<std::string>{"steel", "wood"});
  CHECK(back.files.materials == std::vector<std::string>{"box.mtl"});
  const auto lost = folder.run("box.obj out.stl --attributes uv" + kQuick);
  CHECK(lost.status == 0);
  CHECK(contains(lost.err, "box.obj: uv dropped: STL files are written without attributes"));
  const auto wrong = folder.run("box.obj wrong.ply --attributes vt" + kQuick);
  CHECK(wrong.status == 2);
  CHECK(contains(wrong.err, "'vt', which box.obj does not have; it has: uv, material"));
}

TEST_CASE(
    "attribute files: colours, texture coordinates and materials go from glTF to glTF and PLY, and from OBJ to glTF",
    "[cli]") {
  Folder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  TriangleMesh mesh{ball.vertices, ball.triangles};
  Attribute color{kColorName, NumberType::u8, 3, {}};
  for (size_t v = 0; v < ball.vertices.size(); ++v) color.values.insert(color.values.end(), {10, 20, 30});
  Attribute uv{kUvName, NumberType::f32, 2, {}, AttributeDomain::corner};
  Attribute material{kMaterialName, NumberType::i32, 1, {}, AttributeDomain::face, {}, {"clay", "gold"}};
  for (const auto& t : ball.triangles) {
    const bool is_top = ball.vertices[t[0]].z + ball.vertices[t[1]].z + ball.vertices[t[2]].z > 0;
    for (const uint32_t v : t)
      uv.values.insert(uv.values.end(), {ball.vertices[v].x, ball.vertices[v].y + 20 * is_top});
    material.values.push_back(is_top);
  }
  mesh.attributes = {color, uv, material};
  mesh.files.gltf_materials = R"({"materials":[{"name":"clay"},{"name":"gold","pbrMetallicRoughness":)"
                              R"({"metallicFactor":0.25}}]})";
  write_mesh(folder / "ball.glb", mesh);
  mesh.attributes.erase(mesh.attributes.begin());
  write_mesh(folder / "ball.obj", mesh);
  const auto attributes_of = [&](const std::string& input, const std::string& output) {
    const auto r = folder.run(input + " " + output + " --require closed,manifold" + kQuick);
    INFO(r.err);
    REQUIRE(r.status == 0);
    return read_mesh(folder / output);
  };
  for (const std::string output : {"a.glb", "a.gltf"}) {
    const TriangleSoup soup = attributes_of("ball.glb", output);
    REQUIRE(soup.attributes.size() == 3);
    CHECK(soup.attributes[0].type == NumberType::u8);
    CHECK(std::vector<double>(soup.attributes[0].values.begin(), soup.attributes[0].values.begin() + 3) ==
          std::vector<double>{10, 20, 30});
    CHECK(soup.attributes[1].name == kUvName);
    CHECK(soup.attributes[2].labels == std::vector<std::string>{"clay", "gold"});
    CHECK(contains(soup.files.gltf_materials, R"("metallicFactor":0.25)"));
    CHECK(soup.vertices.size() == 300);
  }
  CHECK(attributes_of("ball.glb", "a.ply").attributes.size() == 3);
  const TriangleSoup of_obj = attributes_of("ball.obj", "b.glb");
  REQUIRE(of_obj.attributes.size() == 2);
  CHECK(of_obj.attributes[1].labels == std::vector<std::string>{"clay", "gold"});
}

TEST_CASE("attribute files: a glTF file is meshed as a PLY file of its positions, where its nodes put it", "[cli]") {
  Folder folder;
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  TriangleMesh mesh{ball.vertices, ball.triangles};
  for (WorldPoint& p : mesh.vertices) p = {double(float(p.x)), double(float(p.y)), double(float(p.z))};
  write_mesh(folder / "ball.ply", mesh);
  write_mesh(folder / "ball.glb", mesh);
  REQUIRE(folder.run("ball.ply of_ply.off" + kQuick).status == 0);
  REQUIRE(folder.run("ball.glb of_glb.off" + kQuick).status == 0);
  CHECK(folder.content("of_ply.off") == folder.content("of_glb.off"));
  REQUIRE(folder.run("- of_pipe.off --input-format glb <ball.glb" + kQuick).status == 0);
  CHECK(folder.content("of_ply.off") == folder.content("of_pipe.off"));
  REQUIRE(folder.run("ball.glb - --output-format glb >of_pipe.glb" + kQuick).status == 0);
  CHECK(read_mesh(folder / "of_pipe.glb").triangles == read_mesh(folder / "of_ply.off").triangles);
}
