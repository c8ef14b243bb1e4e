// Meshes a second by remesh_many: contexts side by side on one device, or on the CPU with a thread each.
//   bench_contexts MESH [MESH ...] [--device cpu|cuda] [--threads N[,N...]] [--runs N] [--vertices K]
// Every mesh is held against that of a run alone on the CPU; exit status 1 when one differs or a run fails.
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

struct Arguments {
  std::vector<std::string> meshes;
  Backend backend = Backend::cuda;
  std::vector<int> threads = {1, 2, 4, 8, 16, 32};
  int runs = 20;  ///< a thread
  int64_t vertices = 4000;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    if (word.rfind("--", 0) != 0) {
      a.meshes.push_back(word);
      continue;
    }
    const char* value = i + 1 < argc ? argv[++i] : "";
    if (word == "--device") a.backend = std::strcmp(value, "cpu") == 0 ? Backend::cpu : Backend::cuda;
    if (word == "--runs") a.runs = std::atoi(value);
    if (word == "--vertices") a.vertices = std::atoll(value);
    if (word == "--threads") {
      a.threads.clear();
      std::istringstream list(value);
      for (std::string number; std::getline(list, number, ',');) a.threads.push_back(std::atoi(number.c_str()));
    }
  }
  return a;
}

/// How many results are not as they should be; says why the first one is not.
int count_failed(const std::vector<TriangleSoup>& soups, const std::vector<std::string>& expected,
                 const RemeshOptions& options, int workers, int64_t runs, Context& context) {
  int failed = 0;
  ManyRequest request;
  request.workers = workers;
  request.next = [&, next = int64_t(0)]() mutable -> std::optional<TriangleSoup> {
    if (next == runs) return {};
    return soups[size_t(next++) % soups.size()];
  };
  request.take = [&](ManyResult result) {
    if (!result.error && digest_text(digest(result.made.mesh)) == expected[size_t(result.index) % soups.size()]) return;
    if (failed++ == 0) std::printf("%s\n", result.error ? result.error->what() : "another mesh than alone");
  };
  remesh_many(request, options, context);
  return failed;
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments a = parse(argc, argv);
  if (a.meshes.empty()) return 2;
  RemeshOptions options;
  options.vertices = a.vertices;
  std::vector<TriangleSoup> soups;
  std::vector<std::string> expected;
  for (const std::string& mesh : a.meshes) {
    soups.push_back(read_mesh(mesh));
    Context cpu;
    cpu.backend = Backend::cpu;
    expected.push_back(digest_text(digest(remesh(soups.back(), options, cpu).mesh)));
  }
  bool all_right = true;
  for (const int threads : a.threads) {
    Context context;
    context.backend = a.backend;
    const int64_t runs = int64_t(threads) * a.runs;
    const auto start = std::chrono::steady_clock::now();
    const int failed = count_failed(soups, expected, options, threads, runs, context);
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    std::printf("%2d contexts, %4lld runs: %6.1f meshes a second, %d failed, %lld MiB of the device free\n", threads,
                (long long)runs, double(runs) / seconds, failed, (long long)(device_info(context).free_bytes >> 20));
    std::fflush(stdout);
    all_right &= failed == 0;
  }
  return all_right ? 0 : 1;
}
