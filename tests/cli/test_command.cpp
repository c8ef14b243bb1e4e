// The command as a user meets it: exit statuses, messages, files, pipes, signals.

#include "cli/command.h"
#include "cli/quick_ball.h"
#include "support/catch.h"
#include "support/refusals.h"

using namespace isoshell;
using namespace isoshell::cli;

TEST_CASE("command: help goes to standard output and is the guide's table of options", "[cli]") {
  Folder folder;
  const auto help = folder.run("--help");
  CHECK(help.status == 0);
  CHECK(help.err.empty());
  const auto table = folder.shell("'" + source_folder() + "/scripts/option_table.sh' '" + command_path() + "'");
  REQUIRE(table.status == 0);
  CHECK(contains(table.out, "| `--vertices K` |"));
  CHECK(contains(content(source_folder() + "/docs/guide/command.md"),
                 "<!-- options: begin -->\n" + table.out + "<!-- options: end -->"));
}

TEST_CASE("command: README's program is the first example", "[cli]") {
  CHECK(contains(content(source_folder() + "/README.md"),
                 "```cpp\n" + content(source_folder() + "/examples/01_remesh.cpp") + "```"));
}

TEST_CASE("command: wrong usage exits with 2 and one line", "[cli]") {
  Folder folder;
  const auto r = folder.run("in.off out.ply --vertces 10");
  CHECK(r.status == 2);
  CHECK(r.err == "vdb_isomesh: error: unknown option --vertces; did you mean --vertices?\n");
  CHECK(r.out.empty());
}

TEST_CASE("command: an input that cannot be read exits with 3 and is named", "[cli]") {
  Folder folder;
  CHECK(folder.run("gone.off out.ply").status == 3);
  CHECK(contains(folder.run("gone.off out.ply").err, "gone.off: no such file"));
  for (const char* pattern : {"gone.####.off", "gone_%04d.off", "'*.off'"}) {
    const auto r = folder.run(std::string(pattern) + " out.ply");
    CHECK(r.status == 3);
    CHECK(contains(r.err,
                   "only vdb_isomesh with --frames, as 1-240, takes a pattern, as mesh.####.ply or mesh.%04d.ply"));
  }
  CHECK(contains(folder.run(". out.ply --input-format off").err, "is a folder"));
  folder.write("cloud.xyz", "0 0 0\n1 1 1\n");
  CHECK(folder.run("cloud.xyz out.ply").status == 5);
  CHECK(contains(folder.run("cloud.xyz out.ply").err, "only 2 different points"));
  folder.write("cloud.ply",
               "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n0 0 0\n");
  CHECK(contains(folder.run("cloud.ply out.ply").err, "only 1 different points"));
  folder.write("smoke.nvdb", "x");
  CHECK(contains(folder.run("smoke.nvdb out.ply").err, "truncated"));
  folder.write("text.txt", "x");
  CHECK(contains(folder.run("text.txt out.ply").err, "--input-format"));
  folder.write("liar.off", "OFF\n100 200 0\n0 0 0\n");
  const auto liar = folder.run("liar.off out.ply");
  CHECK(liar.status == 3);
  CHECK(contains(liar.err, "liar.off"));
  CHECK_FALSE(folder.has("out.ply"));
}

TEST_CASE("command: an output that cannot be written exits with 4, before any work", "[cli]") {
  Folder folder;
  write_ball(folder);
  folder.write("old.ply", "precious");
  const auto r = folder.run("ball.off old.ply" + kQuick);
  CHECK(r.status == 4);
  CHECK(contains(r.err, "old.ply: exists already; --force replaces it"));
  CHECK(folder.content("old.ply") == "precious");
  CHECK(folder.run("ball.off nowhere/out.ply" + kQuick).status == 4);
  CHECK(folder.run("ball.off /dev/null --output-format ply" + kQuick).status == 4);
  folder.write("stats.json", "old");
  CHECK(folder.run("ball.off new.ply --stats stats.json" + kQuick).status == 4);
  CHECK(folder.run("ball.off both.ply --stats both.ply" + kQuick).status == 2);
  CHECK(folder.file_count() == 3);
}

TEST_CASE("command: cuda is never replaced by the CPU in silence", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --device cuda" + kQuick);
  if (r.status != 0) {
    CHECK(r.status == 8);
    CHECK(contains(r.err, "no CUDA device"));
    CHECK_FALSE(folder.has("out.ply"));
  }
  const auto far = folder.run("ball.off out2.ply --device cuda:999" + kQuick);
  CHECK(far.status == 8);
  CHECK(contains(far.err, "no CUDA device"));
  CHECK(contains(far.err, "--device cpu"));
}

TEST_CASE("command: a run over the memory cap exits with 7 before it allocates", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --resolution 4096 --max-memory 100M");
  CHECK(r.status == 7);
  CHECK(contains(r.err, "--max-memory"));
  CHECK_FALSE(folder.has("out.ply"));
}

TEST_CASE("command: a dry run says what it would take and writes nothing", "[cli]") {
  Folder folder;
  write_ball(folder);
  const auto r = folder.run("ball.off out.ply --dry-run" + kQuick);
  CHECK(r.status == 0);
  CHECK(contains(r.err, "resolution 48"));
  CHECK(contains(r.err, "MiB"));
  CHECK(r.out.empty());
  CHECK(folder.file_count() == 1);
  CHECK(folder.run("ball.off --dry-run --max-memory 1M" + kQuick).status == 7);
  folder.write("old.ply", "precious");
  folder.write("old.json", "precious");
  CHECK(folder.run("ball.off old.ply --stats old.json --dry-run" + kQuick).status == 0);
  CHECK(folder.content("old.ply") == "precious");
  CHECK(folder.content("old.json") == "precious");
}
