// CPU nanoseconds a voxel (all threads together) of a relaxation pass in the shell, for several numbers of seeds in one
// shell. JSON on standard output, with digests of the seeds, so that two commits can be compared.
//   bench_relax_shell MESH [--resolution R] [--band D] [--threads T] [--repeats N] K [K ...]
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "bench/programs/machine.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

constexpr int32_t kPasses = 6;  ///< and one alone, so that the difference is that of five passes

struct Arguments {
  std::string mesh;
  int32_t resolution = 512, band_vox = 2;
  int threads = 0, repeats = 3;
  std::vector<int64_t> seeds;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  for (int i = 2; i < argc; ++i) {
    const std::string key = argv[i];
    if (key.compare(0, 2, "--") != 0) {
      a.seeds.push_back(std::atoll(argv[i]));
      continue;
    }
    const int value = i + 1 < argc ? std::atoi(argv[++i]) : 0;
    if (key == "--resolution") a.resolution = value;
    if (key == "--band") a.band_vox = value;
    if (key == "--threads") a.threads = value;
    if (key == "--repeats") a.repeats = value;
  }
  if (a.seeds.empty()) {
    std::fprintf(stderr,
                 "usage: bench_relax_shell MESH [--resolution R] [--band D] [--threads T] [--repeats N] K [K ...]\n");
    std::exit(2);
  }
  a.mesh = argv[1];
  return a;
}

struct Setup {
  SiteSet sites;
  SiteSamples samples;
  Shell shell;
};

Setup prepare(const Arguments& args, Context& context) {
  const TriangleSoup soup = read_mesh(args.mesh);
  const auto [lo, hi] = bounding_box(soup);
  const LatticeSurface surface = snap_surface(soup, LatticeFrame::around(lo, hi, args.resolution), context);
  Setup s;
  s.sites = voxelize(surface, context);
  s.samples = sample_sites(surface, s.sites, context);
  s.shell = build_shell(s.sites, {args.band_vox}, context);
  return s;
}

struct Timed {
  double cpu_ns;
  uint64_t seeds;
};

Timed relaxed(const Setup& setup, int64_t count, int32_t passes, Context& context) {
  SeedSet seeds = place_seeds(setup.sites, setup.samples, {count, 0}, context);
  const std::clock_t start = std::clock();
  seeds = relax_in_shell(setup.shell, setup.sites, setup.samples, std::move(seeds), {passes, 0, 0}, context).seeds;
  return {double(std::clock() - start) * 1e9 / CLOCKS_PER_SEC, digest(seeds)};
}

json measure(const Setup& setup, int64_t count, int repeats, Context& context) {
  const double voxels = double(setup.shell.voxels.voxel_count());
  std::vector<double> ns_per_voxel;
  uint64_t seeds = 0;
  for (int i = 0; i < repeats; ++i) {
    const double one = relaxed(setup, count, 1, context).cpu_ns;
    const Timed all = relaxed(setup, count, kPasses, context);
    ns_per_voxel.push_back((all.cpu_ns - one) / (kPasses - 1) / voxels);
    seeds = all.seeds;
  }
  std::sort(ns_per_voxel.begin(), ns_per_voxel.end());
  return {{"seeds", count},
          {"ns_per_voxel_median", ns_per_voxel[ns_per_voxel.size() / 2]},
          {"ns_per_voxel_min", ns_per_voxel.front()},
          {"ns_per_voxel_max", ns_per_voxel.back()},
          {"digest", seeds}};
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  Context context;
  context.backend = Backend::cpu;
  context.threads = args.threads;
  const Setup setup = prepare(args, context);
  json rows = json::array();
  for (const int64_t count : args.seeds) rows.push_back(measure(setup, count, args.repeats, context));
  const json out = {{"bench", "relax_shell"},
                    {"mesh", args.mesh.substr(args.mesh.find_last_of('/') + 1)},
                    {"resolution", args.resolution},
                    {"band_vox", args.band_vox},
                    {"sites", setup.sites.voxels.voxel_count()},
                    {"voxels", setup.shell.voxels.voxel_count()},
                    {"threads", args.threads},
                    {"repeats", args.repeats},
                    {"machine", bench::machine()},
                    {"rows", rows}};
  std::printf("%s\n", out.dump(2).c_str());
  return 0;
} catch (const std::exception& e) {
  std::fprintf(stderr, "bench_relax_shell: %s\n", e.what());
  return 1;
}
