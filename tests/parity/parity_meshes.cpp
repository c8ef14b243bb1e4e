// Whole runs over a folder of meshes: every digest of the device against the CPU's, for both methods, several times.
//   parity_meshes FOLDER [--vertices K] [--resolution R] [--runs N] [--method sheet|shell] [--only NAME]
// One line a mesh; exit status 1 when a digest differs, 77 without a device.
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

struct Arguments {
  std::string folder, only;
  RemeshOptions options;
  int runs = 3;
  std::vector<Method> methods = {Method::sheet, Method::shell};
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.options.vertices = 4000;
  a.options.want_shell = a.options.want_digests = true;
  if (argc < 2) {
    std::fprintf(stderr,
                 "usage: parity_meshes FOLDER [--vertices K] [--resolution R] [--runs N] "
                 "[--method sheet|shell] [--only NAME]\n");
    std::exit(2);
  }
  a.folder = argv[1];
  for (int i = 2; i + 1 < argc; i += 2) {
    const std::string key = argv[i], value = argv[i + 1];
    if (key == "--vertices") a.options.vertices = std::stol(value);
    if (key == "--resolution") a.options.resolution = int32_t(std::stol(value));
    if (key == "--runs") a.runs = int(std::stol(value));
    if (key == "--method") a.methods = {value == "shell" ? Method::shell : Method::sheet};
    if (key == "--only") a.only = value;
  }
  return a;
}

struct ProductDigests {
  std::map<std::string, std::string> digests;
  std::string error;
  double ms = 0;
};

/// Every product of the run, the labels of the Voronoi volume included.
ProductDigests run(const TriangleSoup& soup, const RemeshOptions& options, Backend backend) {
  Context context;
  context.backend = backend;
  ProductDigests result;
  const auto start = std::chrono::steady_clock::now();
  try {
    const Prepared prepared = prepare(soup, options, context);
    result.digests = prepared.report().digests;
    Relaxed relaxed = relax(prepared, context);
    relaxed.report.digests["labels"] = digest_text(digest(flood_shell(prepared.shell(), relaxed.seeds, context)));
    result.digests = relaxed.report.digests;
    result.digests["passes"] = std::to_string(relaxed.report.relax.passes);
    result.digests["mesh"] = triangulate(prepared, std::move(relaxed), context).report.digests["mesh"];
  } catch (const Error& e) {
    result.error = e.stage() + ": " + e.what();
  }
  result.ms = std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
  return result;
}

std::string first_difference(const ProductDigests& cpu, const ProductDigests& cuda) {
  if (cpu.error != cuda.error) return "errors: '" + cpu.error + "' and '" + cuda.error + "'";
  for (const char* product : {"surface", "sites", "samples", "shell", "sheet", "passes", "seeds", "labels", "mesh"}) {
    const auto a = cpu.digests.find(product), b = cuda.digests.find(product);
    if ((a == cpu.digests.end()) != (b == cuda.digests.end()) || (a != cpu.digests.end() && a->second != b->second))
      return std::string(product) + ": " + (a == cpu.digests.end() ? "none" : a->second) + " and " +
             (b == cuda.digests.end() ? "none" : b->second);
  }
  return "";
}

}  // namespace

int main(int argc, char** argv) {
  const Arguments args = parse(argc, argv);
  try {
    Context context;
    context.backend = Backend::cuda;
    backend_name(context);
  } catch (const Error& e) {
    std::printf("skipped: %s\n", e.what());
    return 77;
  }
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(args.folder)) {
    const std::string ending = entry.path().extension();
    if ((ending == ".off" || ending == ".obj" || ending == ".ply" || ending == ".stl") &&
        (args.only.empty() || entry.path().stem() == args.only))
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  int differing = 0, runs = 0;
  std::printf("%-24s %-6s %10s %10s %10s  %s\n", "mesh", "method", "cpu ms", "first ms", "best ms", "digests");
  for (const auto& file : files)
    for (const Method method : args.methods) {
      RemeshOptions options = args.options;
      options.method = method;
      const TriangleSoup soup = read_mesh(file.string());
      const ProductDigests cpu = run(soup, options, Backend::cpu);
      std::string verdict;
      double first = 0, best = 0;
      for (int i = 0; i < args.runs; ++i, ++runs) {
        const ProductDigests cuda = run(soup, options, Backend::cuda);
        if (i == 0) first = best = cuda.ms;
        best = std::min(best, cuda.ms);
        const std::string difference = first_difference(cpu, cuda);
        if (verdict.empty() && !difference.empty())
          verdict = "run " + std::to_string(i + 1) + " DIFFERS: " + difference;
      }
      if (!verdict.empty()) ++differing;
      std::printf("%-24s %-6s %10.0f %10.1f %10.1f  %s\n", file.filename().c_str(),
                  method == Method::shell ? "shell" : "sheet", cpu.ms, first, best,
                  verdict.empty() ? ("equal, mesh " + cpu.digests.at("passes") + " passes " +
                                     (cpu.error.empty() ? cpu.digests.at("mesh") : cpu.error))
                                        .c_str()
                                  : verdict.c_str());
      std::fflush(stdout);
    }
  std::printf("%d runs on the device, %d of %zu cases differ\n", runs, differing, files.size() * args.methods.size());
  return differing == 0 && !files.empty() ? 0 : 1;
}
