// What the command takes for free memory.
#include <filesystem>
#include <fstream>

#include "support/catch.h"
#include "support/temporary_file.h"
#include "vdb_isomesh/memory.h"

using namespace isoshell;
using namespace isoshell::tool;

namespace {

constexpr int64_t kMiB = 1 << 20;

/// The limit inside a control group that says these three numbers about itself.
int64_t limit_of_group(const std::string& most, int64_t used, int64_t idle) {
  const TemporaryFile folder("group");
  std::filesystem::create_directory(folder.path);
  std::ofstream(folder.path + "/memory.max") << most << "\n";
  std::ofstream(folder.path + "/memory.current") << used << "\n";
  std::ofstream(folder.path + "/memory.stat") << "anon 7\ninactive_file " << idle << "\nactive_file 5\n";
  const int64_t limit = default_memory_limit_bytes(folder.path);
  std::filesystem::remove_all(folder.path);
  return limit;
}

}  // namespace

TEST_CASE("memory: the default is four fifths of what the control group leaves, idle pages of files included",
          "[cli]") {
  CHECK(limit_of_group(std::to_string(10 * kMiB), 8 * kMiB, 0) == 2 * kMiB / 5 * 4);
  CHECK(limit_of_group(std::to_string(10 * kMiB), 10 * kMiB, 5 * kMiB) == 5 * kMiB / 5 * 4);
}

TEST_CASE("memory: a group that has nothing left is a limit, not none", "[cli]") {
  CHECK(limit_of_group(std::to_string(10 * kMiB), 10 * kMiB, 0) == 1);
  CHECK(limit_of_group(std::to_string(10 * kMiB), 11 * kMiB, 0) == 1);
}

TEST_CASE("memory: without a group's limit it is the machine's", "[cli]") {
  CHECK(limit_of_group("max", kMiB, 0) > 100 * kMiB);
  CHECK(default_memory_limit_bytes("/no such group") > 100 * kMiB);
}
