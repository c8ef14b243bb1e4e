// Runs every reader over its corpus, without a fuzzer: what was found once stays fixed.
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "fuzz/targets.h"
#include "support/source_folder.h"

int main() {
  namespace fs = std::filesystem;
  for (const isoshell::fuzz::Target& target : isoshell::fuzz::targets()) {
    int count = 0;
    for (const auto& entry :
         fs::directory_iterator(fs::path(isoshell::source_folder()) / "tests/fuzz/corpus" / target.name)) {
      std::ifstream in(entry.path(), std::ios::binary);
      const std::vector<char> bytes{std::istreambuf_iterator<char>(in), {}};
      isoshell::fuzz::run_or_abort(target, {bytes.data(), int64_t(bytes.size())});
      ++count;
    }
    std::printf("%s: %d inputs\n", target.name, count);
    if (count == 0) return 1;
  }
  return 0;
}
