// Borders that are kept, as a user asks for them: every format, gates with their exit statuses, stage files.
#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;
using Json = nlohmann::json;

namespace {

const std::string kKeep = " --boundary keep --close-gaps 0 --vertices 400 --device cpu --force ";

/// Half a ball: its rim is its one border.
void write_bowl(const Folder& folder) {
  TriangleSoup soup = shapes::sphere({1, 2, 3}, 5, 48);
  soup.triangles.erase(std::remove_if(soup.triangles.begin(), soup.triangles.end(),
                                      [&](const std::array<uint32_t, 3>& t) {
                                        return soup.vertices[t[0]].z + soup.vertices[t[1]].z + soup.vertices[t[2]].z <
                                               9;
                                      }),
                       soup.triangles.end());
  folder.write_off("bowl.off", soup);
}

}  // namespace

TEST_CASE("borders: a bowl stays open in every format, and gates say so", "[cli][borders]") {
  Folder folder;
  write_bowl(folder);
  for (const char* format : {"ply", "obj", "stl", "off"}) {
    INFO(format);
    const std::string out = std::string("out.") + format;
    const auto r = folder.run("bowl.off " + out + kKeep +
                              "--require manifold,boundary-loops=1,components=1,genus=0 --stats s.json");
    CHECK(r.status == 0);
    CHECK(contains(r.err, "2-manifold with 1 border"));
    CHECK_FALSE(contains(r.err, "not kept"));
    const TriangleSoup mesh = read_mesh((folder / out).string());
    CHECK(mesh.triangles.size() == read_mesh((folder / "out.ply").string()).triangles.size());
  }
  const Json j = Json::parse(folder.content("s.json"));
  CHECK(j["features"]["kept"] == true);
  CHECK(j["features"]["border_loops"] == 1);
  CHECK(j["topology"]["closed"] == false);
  CHECK(j["topology"]["manifold"] == true);
  CHECK(j["borders"]["loops"] == 1);
  CHECK(j["borders"]["input_loops"] == 1);
  CHECK(j["borders"]["to_input_max"] < j["grid"]["voxel_size"]);
  CHECK(j["options"]["boundary"] == "keep");

  const auto open = folder.run("bowl.off out.ply" + kKeep + "--require closed,boundary-loops=0");
  CHECK(open.status == 6);
  CHECK(contains(open.err, "gate failed: closed: the mesh has 1 open boundary"));
  CHECK(contains(open.err, "gate failed: boundary-loops=0: the mesh has 1"));
  CHECK(folder.run("bowl.off out.ply --force --vertices 400 --device cpu --require closed,boundary-loops=0").status ==
        0);
}

TEST_CASE("borders: what cannot keep them is refused, or closed with a warning", "[cli][borders]") {
  Folder folder;
  write_bowl(folder);
  CHECK(folder.run("bowl.off out.ply --boundary open").status == 2);
  const auto shell = folder.run("bowl.off out.ply --method shell" + kKeep);
  CHECK(shell.status == 2);
  CHECK(contains(shell.err, "--boundary keep needs --method sheet"));
  CHECK(folder.run("bowl.off out.ply --save-voronoi v.vdb" + kKeep).status == 2);
  CHECK_FALSE(folder.has("out.ply"));
  const auto few = folder.run("bowl.off out.ply --boundary keep --close-gaps 0 --device cpu --vertices 8");
  CHECK(few.status == 0);
  if (contains(few.err, "not closed")) CHECK(contains(few.err, "not kept"));
}

#ifdef ISOSHELL_TEST_VDB
TEST_CASE("borders: resumed from a shell, the result is the same, byte by byte", "[cli][vdb][borders]") {
  Folder folder;
  write_bowl(folder);
  REQUIRE(folder.run("bowl.off once.ply --save-shell s.vdb" + kKeep).status == 0);
  REQUIRE(folder.run("s.vdb again.ply --device cpu").status == 0);
  CHECK(folder.content("once.ply") == folder.content("again.ply"));
  const auto closed = folder.run("s.vdb no.ply --boundary close");
  CHECK(closed.status == 2);
  CHECK(contains(closed.err, "--boundary is fixed by the shell stage file: it was keep"));
}
#endif
