// --regions: meshes whose parts touch, by the command.
#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <utility>
#include <vector>

#include "cli/command.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

namespace {

const std::string kRun = " --vertices 600 --device cpu --require regions ";

/// Boxes as groups of an OBJ file.
void write_boxes(const fs::path& path, const std::vector<std::pair<std::string, TriangleSoup>>& groups) {
  std::ofstream file(path);
  size_t first = 1;
  for (const auto& [name, soup] : groups) {
    file << "g " << name << "\n";
    for (const WorldPoint& p : soup.vertices) file << "v " << p.x << " " << p.y << " " << p.z << "\n";
    for (const auto& t : soup.triangles)
      file << "f " << t[0] + first << " " << t[1] + first << " " << t[2] + first << "\n";
    first += soup.vertices.size();
  }
}

}  // namespace

TEST_CASE("run: groups of an OBJ file become regions with their names", "[cli]") {
  Folder folder;
  write_boxes(folder / "two.obj",
              {{"left", shapes::box({0, 0, 0}, {1, 1, 1})}, {"right", shapes::box({1, 0, 0}, {2, 1, 1})}});
  for (const char* parts : {"components", "groups", "group"}) {
    const auto r =
        folder.run("two.obj two.ply --force --regions " + std::string(parts) + " --split-regions parts" + kRun);
    INFO(r.err);
    REQUIRE(r.status == 0);
    const TriangleSoup mesh = read_mesh((folder / "two.ply").string());
    CHECK(mesh.vertices.size() == 600);
    REQUIRE(mesh.regions.names.size() == 2);
    CHECK(mesh.regions.names[1].name == "right");
    CHECK(folder.has("parts/left.ply"));
    CHECK(folder.has("parts/right.ply"));
  }
}

TEST_CASE("run: solids of a text STL become regions with their names, and groups of what can hold them", "[cli]") {
  Folder folder;
  std::ofstream file(folder / "two.stl");
  for (const auto& [name, soup] :
       {std::pair{"left", shapes::box({0, 0, 0}, {1, 1, 1})}, std::pair{"right", shapes::box({1, 0, 0}, {2, 1, 1})}}) {
    file << "solid " << name << "\n";
    for (const auto& t : soup.triangles) {
      file << "facet normal 0 0 0\nouter loop\n";
      for (const uint32_t v : t)
        file << "vertex " << soup.vertices[v].x << " " << soup.vertices[v].y << " " << soup.vertices[v].z << "\n";
      file << "endloop\nendfacet\n";
    }
    file << "endsolid " << name << "\n";
  }
  file.close();
  const auto r = folder.run("two.stl two.ply --regions groups" + kRun);
  INFO(r.err);
  REQUIRE(r.status == 0);
  const TriangleSoup mesh = read_mesh((folder / "two.ply").string());
  REQUIRE(mesh.regions.names.size() == 2);
  CHECK(mesh.regions.names[0].name == "left");
  CHECK(mesh.regions.names[1].name == "right");
  const std::string run = "--vertices 600 --device cpu";
  REQUIRE(folder.run("two.stl two.obj " + run).status == 0);
  CHECK(contains(folder.content("two.obj"), "\ng right\nf "));
  const auto lost = folder.run("two.stl out.stl --attributes group " + run);
  CHECK(lost.status == 0);
  CHECK(contains(lost.err, "two.stl: group dropped: STL files are written without attributes"));
}

TEST_CASE("run: regions with a sheet are read again as they were written", "[cli]") {
  Folder folder;
  TriangleSoup sheet;
  sheet.vertices = {{1, 1, 2}, {3, 1, 2}, {3, 3, 2}, {1, 3, 2}};
  sheet.triangles = {{0, 1, 2}, {0, 2, 3}};
  write_boxes(folder / "cut.obj", {{"cube", shapes::box({0, 0, 0}, {4, 4, 4})}, {"sheet", sheet}});
  const auto r = folder.run("cut.obj cut.ply --regions components" + kRun);
  INFO(r.err);
  REQUIRE(r.status == 0);
  const auto again = folder.run("cut.ply again.ply" + kRun);
  INFO(again.err);
  CHECK(again.status == 0);
  const FaceRegions regions = read_mesh((folder / "again.ply").string()).regions;
  CHECK(std::count(regions.labels.begin(), regions.labels.end(), std::array<int32_t, 2>{1, 1}) > 10);
}

TEST_CASE("run: --regions names what it cannot use", "[cli]") {
  Folder folder;
  folder.write_off("cube.off", shapes::box({0, 0, 0}, {1, 1, 1}));
  const auto groups = folder.run("cube.off out.ply --regions groups");
  CHECK(groups.status != 0);
  CHECK(contains(groups.err, "the faces have no groups and no objects"));
  REQUIRE(folder.run("cube.off cube.ply --regions components" + kRun).status == 0);
  CHECK(contains(folder.run("cube.ply out.ply --regions cells").err, "part regions already"));
}
