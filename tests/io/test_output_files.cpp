// Outputs before any work and in their place: whole or not at all, one file each, and nothing that is not theirs.
#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include "io/bytes/output_place.h"
#include "io/leftovers.h"
#include "isoshell/io/output_files.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"

using namespace isoshell;
namespace fs = std::filesystem;

namespace {

std::string refusal(ErrorCode code, const std::vector<NamedFile>& outputs, bool overwrite = true,
                    const std::vector<NamedFile>& inputs = {}) {
  return message_of(code, [&] { check_output_files(outputs, inputs, overwrite); });
}

}  // namespace

TEST_CASE("output files: a name that no file can have is refused before any work", "[output_file][unit]") {
  const TemporaryFolder folder;
  fs::create_symlink(folder / "nowhere", folder / "link");
  fs::create_symlink("loop", folder / "loop");
  put_file(folder / "file", "x");
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "link"}}), "nowhere, which is not there"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / std::string(256, 'a')}}), "too long"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "loop"}}), "cannot be made"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "file/a"}}), "cannot be made"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "no/a"}}), "there is no folder"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "."}}), "is a folder"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / std::string("a\0b", 3)}}), "NUL"));
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "file"}}, false), "exists already"));
  CHECK(refusal(ErrorCode::usage, {{"OUTPUT", folder / std::string(255, 'a')}, {"--stats", ""}}).empty());
}

TEST_CASE("output files: one file is refused under two names, whatever links they go through", "[output_file][unit]") {
  const TemporaryFolder folder;
  fs::create_directory(folder / "real");
  fs::create_directory_symlink("real", folder / "other");
  put_file(folder / "real/there", "x");
  fs::create_symlink("real/there", folder / "link");
  fs::create_hard_link(folder / "real/there", folder / "hard");
  const std::string there = folder / "real/there", made = folder / "real/made";
  for (const std::string& same : {folder / "link", folder / "hard", folder / "other/there", folder / "real/../link"}) {
    INFO(same);
    const std::string twice = refusal(ErrorCode::usage, {{"OUTPUT", same}, {"--stats", there}});
    CHECK(contains(twice, "OUTPUT " + same + " and --stats " + there + " are one file"));
    CHECK(contains(refusal(ErrorCode::usage, {{"OUTPUT", same}}, true, {{"INPUT", there}}), "INPUT"));
  }
  const std::vector<NamedFile> input = {{"INPUT", there}, {"--sizing", made}};
  put_file(made, "x");
  CHECK(refusal(ErrorCode::usage, {{"OUTPUT", folder / "link", "INPUT"}}, true, input).empty());
  CHECK(contains(refusal(ErrorCode::unwritable_output, {{"OUTPUT", folder / "link", "INPUT"}}, false, input),
                 "is INPUT and exists already; --force"));
  CHECK(contains(refusal(ErrorCode::usage, {{"OUTPUT", made, "INPUT"}}, true, input), "--sizing"));
  fs::remove(made);
  CHECK(contains(refusal(ErrorCode::usage, {{"OUTPUT", made}, {"--stats", folder / "other/made"}}), "one file"));
  CHECK(refusal(ErrorCode::usage, {{"OUTPUT", made}, {"--stats", folder / "made"}}).empty());
  CHECK(get_file(there) == "x");
}

TEST_CASE("output files: neither way to take a name takes one that is there", "[output_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "new", "new");
  put_file(folder / "old", "old");
  CHECK(rename_to(folder / "new", folder / "old", false) == EEXIST);
  CHECK(get_file(folder / "old") == "old");
  CHECK_FALSE(
      message_of(ErrorCode::unwritable_output, [&] { put_in_place(folder / "new", folder / "old", false); }).empty());
  CHECK_FALSE(message_of(ErrorCode::unwritable_output, [&] { write_text(folder / "old", "text", false); }).empty());
  CHECK(get_file(folder / "old") == "old");
  put_in_place(folder / "new", folder / "old", true);
  CHECK(get_file(folder / "old") == "new");
  write_text(folder / "old", "text", true);
  CHECK(get_file(folder / "old") == "text");
  CHECK(folder.file_count() == 1);
}

TEST_CASE("output files: what replaces a file has its permissions, however it was made", "[output_file][unit]") {
  const TemporaryFolder folder;
  const fs::path old = folder / "old";
  const fs::perms own = fs::perms::owner_read | fs::perms::owner_write | fs::perms::group_exec;
  put_file(old.string(), "old");
  fs::permissions(old, own);
  write_text(old.string(), "text", true);
  CHECK(fs::status(old).permissions() == own);
  put_file(folder / "new", "new");
  put_in_place(folder / "new", old.string(), true);
  CHECK(get_file(old.string()) == "new");
  CHECK(fs::status(old).permissions() == own);
}

TEST_CASE("output files: without a standard input, files are closed all the same", "[output_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "in.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n");
  const int input = dup(STDIN_FILENO);
  close(STDIN_FILENO);
  const auto is_closed = [] { return fcntl(STDIN_FILENO, F_GETFD) < 0; };
  write_text(folder / "text", "text", false);
  const bool closes_outputs = is_closed();
  close(STDIN_FILENO);
  const size_t read = read_mesh(folder / "in.off").triangles.size();
  const bool closes_inputs = is_closed();
  close(STDIN_FILENO);
  if (input >= 0) {
    dup2(input, STDIN_FILENO);
    close(input);
  }
  CHECK(closes_outputs);
  CHECK(closes_inputs);
  CHECK(read == 1);
}

TEST_CASE("output files: a file system without a rename that keeps what is there takes names all the same",
          "[output_file][unit]") {
  const TemporaryFolder folder;
  put_file(folder / "old", "old");
  put_file(folder / "new", "new");
  CHECK(rename_by_link(folder / "new", folder / "old") == EEXIST);
  CHECK(rename_by_link(folder / "new", folder / "made") == 0);
  CHECK(get_file(folder / "made") == "new");
  CHECK_FALSE(fs::exists(folder / "new"));
  fs::create_directory(folder / "single");  // no folder has two names: EPERM, as of any file on such a file system
  CHECK(rename_by_link(folder / "single", folder / "old") == EEXIST);
  CHECK(rename_by_link(folder / "single", folder / "moved") == 0);
  CHECK(fs::is_directory(folder / "moved"));
  CHECK_FALSE(fs::exists(folder / "single"));
  CHECK(get_file(folder / "old") == "old");
}

TEST_CASE("output files: what a killed process of this host has left goes, and nothing else", "[output_file][unit]") {
  const TemporaryFolder folder;
  const std::string ended = std::to_string(ended_process());
  const std::string left = temporary_of(ended), held = temporary_of(ended), alive = temporary_of("1");
  const std::string others[] = {".isoshell-" + ended + "-0.tmp",
                                ".isoshell-another.host-" + ended + "-0.tmp",
                                left + "x",
                                "a" + left,
                                temporary_of(ended + "x"),
                                "mesh.ply"};
  for (const std::string& name : {left, held, alive}) put_file(folder / name, "part");
  for (const std::string& name : others) put_file(folder / name, "theirs");
  const int lock = open((folder / held).c_str(), O_RDONLY | O_CLOEXEC);
  REQUIRE(flock(lock, LOCK_EX) == 0);
  check_output_files({{"OUTPUT", folder / "out.ply"}}, {}, false);
  close(lock);
  CHECK_FALSE(fs::exists(folder / left));
  CHECK(fs::exists(folder / held));
  CHECK(fs::exists(folder / alive));
  for (const std::string& name : others) CHECK(fs::exists(folder / name));
}
