// Regions of a result as files of their own.
#include <algorithm>
#include <map>
#include <utility>

#include "cli/command.h"
#include "isoshell/io/label_file.h"
#include "regions/label_volumes.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

namespace {

const std::string kRun = " --vertices 1000 --device cpu ";

/// Three grains and a volume around them; two names are the same but for their case, one is no name of a file.
void write_grains(const Folder& folder) {
  LabelVolume volume = voronoi_grains(14, 4);
  volume.names = {{1, "Bone"}, {2, "bone"}, {3, "../left lung"}};
  write_labels((folder / "grains.vdb").string(), volume);
}

/// Whether every edge has two faces, which pass it in opposite directions.
bool is_closed(const TriangleSoup& mesh) {
  std::map<std::pair<uint32_t, uint32_t>, int> passes;
  for (const auto& t : mesh.triangles)
    for (size_t c = 0; c < 3; ++c) ++passes[{t[c], t[(c + 1) % 3]}];
  return std::all_of(passes.begin(), passes.end(), [&](const auto& pass) {
    const auto back = passes.find({pass.first.second, pass.first.first});
    return pass.second == 1 && back != passes.end();
  });
}

}  // namespace

TEST_CASE("run: every region is a closed mesh in a file of its own, by its name or else its label", "[cli][vdb]") {
  Folder folder;
  write_grains(folder);
  const auto r = folder.run("grains.vdb all.ply --split-regions parts" + kRun);
  INFO(r.err);
  REQUIRE(r.status == 0);
  CHECK(std::distance(fs::directory_iterator(folder / "parts"), fs::directory_iterator()) == 4);
  for (const char* name : {"Bone_1.ply", "bone_2.ply", "_._left_lung.ply", "4.ply"}) {
    INFO(name);
    REQUIRE(folder.has("parts/" + std::string(name)));
    CHECK(is_closed(read_mesh((folder / "parts" / name).string())));
  }
}

TEST_CASE("run: the format of the output is that of the files of regions", "[cli][vdb]") {
  Folder folder;
  write_grains(folder);
  REQUIRE(folder.run("grains.vdb - --output-format stl --split-regions ./parts/" + kRun + ">all.stl").status == 0);
  CHECK(folder.has("parts/4.stl"));
  CHECK(folder.has("all.stl"));
}

TEST_CASE("run: a file of a region that is there is replaced by --force alone, and found before the work",
          "[cli][vdb]") {
  Folder folder;
  write_grains(folder);
  fs::create_directory(folder / "parts");
  folder.write("parts/4.ply", "precious");
  const auto r = folder.run("grains.vdb all.ply --split-regions parts" + kRun);
  CHECK(r.status == 4);
  CHECK(contains(r.err, "parts/4.ply: exists already"));
  CHECK_FALSE(folder.has("all.ply"));
  CHECK(folder.content("parts/4.ply") == "precious");
  CHECK(folder.run("grains.vdb all.ply --force --split-regions parts" + kRun).status == 0);
  CHECK(folder.content("parts/4.ply").substr(0, 3) == "ply");
}

TEST_CASE("run: files of regions are refused where they cannot be", "[cli][vdb]") {
  Folder folder;
  write_grains(folder);
  folder.write("file", "");
  folder.write_off("ball.off", shapes::box({0, 0, 0}, {1, 1, 1}));
  const std::string to = "grains.vdb all.ply --split-regions ";
  CHECK(folder.run(to + "none/parts" + kRun).status == 4);
  CHECK(contains(folder.run(to + "file" + kRun).err, "file: is no folder"));
  CHECK(folder.run("grains.vdb s.vdb --stop-after shell --split-regions parts" + kRun).status == 2);
  CHECK(folder.run("a.####.vdb b.####.ply --frames 1-2 --split-regions parts" + kRun).status == 2);
  const auto without = folder.run("ball.off all.ply --split-regions parts" + kRun);
  CHECK(without.status == 2);
  CHECK(contains(without.err, "INPUT has none"));
  fs::create_directory(folder / "same");
  const auto twice = folder.run("grains.vdb same/4.ply --split-regions same" + kRun);
  CHECK(twice.status == 2);
  CHECK(contains(twice.err, "named twice"));
  CHECK_FALSE(folder.has("parts"));
  CHECK_FALSE(folder.has("all.ply"));
}
