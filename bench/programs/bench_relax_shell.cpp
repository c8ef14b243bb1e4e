// CPU nanoseconds a voxel (all threads together) of a relaxation pass in the shell, for several numbers of seeds in one
// shell. JSON on standard output, with digests of the seeds, so that two commits can be compared.
//   bench_relax_shell MESH K [K ...] [--resolution R] [--band D] [--threads T] [--repeats N]
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "bench/programs/program.h"
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
  const std::vector<std::string> words = bench::read_arguments(argc, argv, "bench_relax_shell MESH K [K ...]", 2,
                                                               {{"--resolution", "R", &a.resolution},
                                                                {"--band", "D", &a.band_vox},
                                                                {"--threads", "T", &a.threads},
                                                                {"--repeats", "N", &a.repeats}});
  a.mesh = words[0];
  for (size_t i = 1; i < words.size(); ++i) a.seeds.push_back(std::atoll(words[i].c_str()));
  return a;
}

struct Setup {
  SiteSet sites;
  SiteSamples samples;
  Shell shell;
};

Setup prepare(const Arguments& args, Context& context) {
  const TriangleSoup soup = read_mesh(args.mesh);
  const LatticeSurface surface = snap_surface(soup, bench::frame_of(soup, args.resolution), context);
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
  json row = {{"seeds", count}, {"digest", seeds}};
  bench::add_spread(row, "ns_per_voxel", bench::spread_of(ns_per_voxel));
  return row;
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  bench::BackendContext context(Backend::cpu, args.threads);
  const Setup setup = prepare(args, context);
  json rows = json::array();
  for (const int64_t count : args.seeds) rows.push_back(measure(setup, count, args.repeats, context));
  bench::print_result({{"bench", "relax_shell"},
                       {"mesh", bench::file_name(args.mesh)},
                       {"resolution", args.resolution},
                       {"band_vox", args.band_vox},
                       {"sites", setup.sites.voxels.voxel_count()},
                       {"voxels", setup.shell.voxels.voxel_count()},
                       {"threads", args.threads},
                       {"repeats", args.repeats},
                       {"rows", rows}});
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
