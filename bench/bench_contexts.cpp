// Meshes a second with many contexts side by side on one device: every thread has its own and remeshes in a loop.
//   bench_contexts MESH [MESH ...] [--threads N[,N...]] [--runs N] [--vertices K]
// Every mesh is held against the CPU's; exit status 1 when one differs or a run fails.
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

struct Arguments {
  std::vector<std::string> meshes;
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

std::string mesh_digest(const TriangleSoup& soup, int64_t vertices, Context& context) {
  RemeshOptions options;
  options.vertices = vertices;
  options.want_digests = true;
  return remesh(soup, options, context).report.digests["mesh"];
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments a = parse(argc, argv);
  if (a.meshes.empty()) return 2;
  std::vector<TriangleSoup> soups;
  std::vector<std::string> expected;
  for (const std::string& mesh : a.meshes) {
    soups.push_back(read_mesh(mesh));
    Context cpu;
    cpu.backend = Backend::cpu;
    expected.push_back(mesh_digest(soups.back(), a.vertices, cpu));
  }
  bool all_right = true;
  for (const int threads : a.threads) {
    std::atomic<int> next{0}, failed{0};
    const auto work = [&] {
      Context context;
      context.backend = Backend::cuda;
      for (int run; (run = next++) < threads * a.runs;) {
        const size_t mesh = size_t(run) % soups.size();
        try {
          failed += mesh_digest(soups[mesh], a.vertices, context) != expected[mesh];
        } catch (const std::exception& e) {
          if (failed++ == 0) std::printf("%s\n", e.what());
        }
      }
    };
    const auto start = std::chrono::steady_clock::now();
    std::vector<std::thread> pool;
    for (int t = 0; t < threads; ++t) pool.emplace_back(work);
    for (std::thread& t : pool) t.join();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    Context device;
    device.backend = Backend::cuda;
    std::printf("%2d contexts, %4d runs: %6.1f meshes a second, %d failed, %lld MiB of the device free\n", threads,
                threads * a.runs, threads * a.runs / seconds, failed.load(),
                (long long)(device_info(device).free_bytes >> 20));
    std::fflush(stdout);
    all_right &= failed == 0;
  }
  return all_right ? 0 : 1;
}
