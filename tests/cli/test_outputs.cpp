// Where the command's files go when others write there, streams are closed or signals come.
#include <nlohmann/json.hpp>

#include "cli/command.h"
#include "cli/quick_ball.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

namespace {

/// Runs the command on a pipe, which it opens once its outputs were looked at; `meanwhile` happens then.
Folder::Result run_on_pipe(Folder& folder, const std::string& arguments, const std::string& meanwhile) {
  return folder.shell("mkfifo pipe.off; '" + command_path() + "' " + arguments + " & exec 3>pipe.off; " + meanwhile +
                      "; exec 3>&-; wait $!");
}

}  // namespace

TEST_CASE("outputs: a file that appears while a run goes on stays", "[cli]") {
  for (const std::string name : {"out.ply", "s.json", "s.vdb"}) {
    Folder folder;
    write_ball(folder);
    if (name == "s.vdb" && folder.run("ball.off stage.vdb --stop-after shell" + kQuick).status == 4) continue;
    const std::string shell = name == "s.vdb" ? " --save-shell s.vdb" : "";
    const auto r = run_on_pipe(folder, "pipe.off out.ply --stats s.json" + shell + kQuick,
                               "echo mine > " + name + "; cat ball.off >&3");
    INFO(name << ": " << r.err);
    CHECK(r.status == 4);
    CHECK(contains(r.err, name + ": exists already"));
    CHECK(folder.content(name) == "mine\n");
  }
}

TEST_CASE("outputs: one file under two names is refused before any work", "[cli]") {
  Folder folder;
  write_ball(folder);
  folder.write("s.json", "precious");
  fs::create_symlink("s.json", folder / "link.ply");
  fs::create_symlink("ball.off", folder / "same.off");
  fs::create_symlink("gone.json", folder / "dangling.ply");
  const auto linked = folder.run("ball.off link.ply --stats s.json --force" + kQuick);
  CHECK(linked.status == 2);
  CHECK(contains(linked.err, "OUTPUT link.ply and --stats s.json are one file"));
  const auto itself = folder.run("ball.off out.ply --stats same.off --force" + kQuick);
  CHECK(itself.status == 2);
  CHECK(contains(itself.err, "--stats same.off and INPUT ball.off are one file"));
  CHECK(folder.run("ball.off - --output-format off --force >>ball.off" + kQuick).status == 2);
  CHECK(folder.run("ball.off - --output-format ply --stats s.json --force >s.json" + kQuick).status == 2);
  CHECK(folder.run("gone.off dangling.ply --force" + kQuick).status == 4);
  CHECK(folder.run("gone.off " + std::string(300, 'a') + ".ply" + kQuick).status == 4);
  CHECK_FALSE(folder.has("gone.json"));
}

TEST_CASE("outputs: a result takes the place of its input, whole or not at all, where --force says so", "[cli]") {
  Folder folder;
  write_ball(folder);
  fs::create_symlink("ball.off", folder / "link.off");
  const std::string given = folder.content("ball.off");
  const auto refused = folder.run("ball.off link.off" + kQuick);
  CHECK(refused.status == 4);
  CHECK(contains(refused.err, "link.off: is INPUT and exists already; --force replaces it"));
  CHECK(folder.shell("ulimit -f 1; '" + command_path() + "' ball.off ball.off --force" + kQuick).status == 4);
  CHECK(folder.content("ball.off") == given);
  CHECK(folder.run("ball.off other.off" + kQuick).status == 0);
  CHECK(folder.run("ball.off link.off --force" + kQuick).status == 0);
  CHECK(folder.content("ball.off") == folder.content("other.off"));
  CHECK(fs::is_symlink(folder / "link.off"));
}

TEST_CASE("outputs: no file gets the number of a closed standard stream", "[cli]") {
  Folder folder;
  write_ball(folder);
  REQUIRE(folder.run("ball.off whole.ply" + kQuick).status == 0);
  const auto r = folder.run("ball.off out.ply --stats - >&-" + kQuick);
  CHECK(r.status == 4);
  CHECK(contains(r.err, "standard output: is closed"));
  CHECK_FALSE(folder.has("out.ply"));
  CHECK(folder.run("ball.off - --output-format ply >&-" + kQuick).status == 4);
  CHECK(folder.run("--help >&-").status == 4);
  CHECK(folder.run("- out.ply --input-format off <&-" + kQuick).status == 3);
  CHECK(folder.run("ball.off out.ply <&- >&- 2>&-" + kQuick).status == 0);
  CHECK(folder.content("out.ply") == folder.content("whole.ply"));
}

TEST_CASE("outputs: an interrupted sequence says what it has written", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r =
      folder.shell("cp ball.off in.1.off; cp ball.off in.2.off; mkfifo in.3.off; '" + command_path() +
                   "' in.#.off out.#.ply --frames 1-3 " + kQuick + "& exec 3>in.3.off; kill -INT $!; wait $!");
  INFO(r.err);
  CHECK(r.status == 130);
  CHECK(contains(r.err, "interrupted; written before: out.1.ply to out.2.ply, 2 f"));
  CHECK((folder.has("out.1.ply") && folder.has("out.2.ply") && !folder.has("out.3.ply")));
}

TEST_CASE("outputs: a dry run prints its estimate as JSON, and writes no file", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --dry-run --stats - -q" + kQuick);
  REQUIRE(r.status == 0);
  const auto j = nlohmann::json::parse(r.out);
  CHECK(j["schema"] == 1);
  CHECK(j["estimate"]["resolution"] == 48);
  CHECK(j["estimate"]["vertices"] == 300);
  CHECK(j["estimate"]["memory_bytes"] > 0);
  CHECK(j["memory_limit_bytes"] > 0);
  const auto over = folder.run("ball.off --dry-run --stats - --max-memory 1M" + kQuick);
  CHECK(over.status == 7);
  CHECK(nlohmann::json::parse(over.out)["memory_limit_bytes"] == 1 << 20);
  const auto file = folder.run("ball.off --dry-run --stats s.json" + kQuick);
  CHECK(contains(file.err, "a dry run writes no files"));
  CHECK(folder.file_count() == 1);
}
