// Meshes a second by remesh_many: contexts side by side on one device, or on the CPU with a thread each.
//   bench_contexts MESH [MESH ...] [--device cpu|cuda] [--threads N[,N...]] [--runs N] [--vertices K]
// Every mesh is held against that of a run alone on the CPU; exit status 1 when one differs or a run fails.
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

struct Arguments {
  std::vector<std::string> meshes;
  std::string device = "cuda";
  std::vector<int> threads = {1, 2, 4, 8, 16, 32};
  int runs = 20;  ///< a thread
  int64_t vertices = 4000;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.meshes = bench::read_arguments(argc, argv, "bench_contexts MESH [MESH ...]", 1,
                                   {{"--device", "cpu|cuda", &a.device},
                                    {"--threads", "N[,N...]", &a.threads},
                                    {"--runs", "N", &a.runs},
                                    {"--vertices", "K", &a.vertices}});
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
  RemeshOptions options;
  options.vertices = a.vertices;
  std::vector<TriangleSoup> soups;
  std::vector<std::string> expected;
  for (const std::string& mesh : a.meshes) {
    soups.push_back(read_mesh(mesh));
    bench::BackendContext cpu(Backend::cpu);
    expected.push_back(digest_text(digest(remesh(soups.back(), options, cpu).mesh)));
  }
  bool all_right = true;
  for (const int threads : a.threads) {
    bench::BackendContext context(a.device == "cpu" ? Backend::cpu : Backend::cuda);
    const int64_t runs = int64_t(threads) * a.runs;
    const bench::Watch watch;
    const int failed = count_failed(soups, expected, options, threads, runs, context);
    const double seconds = watch.ms() / 1000;
    std::printf("%2d contexts, %4lld runs: %6.1f meshes a second, %d failed, %lld MiB of the device free\n", threads,
                (long long)runs, double(runs) / seconds, failed, (long long)(device_info(context).free_bytes >> 20));
    std::fflush(stdout);
    all_right &= failed == 0;
  }
  return all_right ? 0 : 1;
}
