// Milliseconds per relaxation pass on the device, of both methods, and whether they give what the CPU gives.
//   bench_cuda_relax MESH rRESOLUTION K [K ...] [rRESOLUTION K [K ...]] ... [--check] [--no-time] [--no-shell]
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

/// What a bench of one grid needs.
struct Setup {
  LatticeSurface surface;
  SiteSet sites;
  SiteSamples samples;
  Sheet sheet;
  Shell shell;
};

/// On the device, where the products stay.
Setup prepare(const TriangleSoup& soup, int32_t resolution, bool want_shell) {
  bench::BackendContext cuda(Backend::cuda);
  Setup s;
  s.surface = snap_surface(soup, bench::frame_of(soup, resolution), cuda);
  s.sites = voxelize(s.surface, cuda);
  s.samples = sample_sites(s.surface, s.sites, cuda);
  s.sheet = build_sheet(s.surface, s.sites, s.samples, {0, 0}, cuda);
  if (want_shell) s.shell = build_shell(s.sites, {2}, cuda);
  return s;
}

/// Relaxes with so many passes on a backend; gives the digest of the seeds and the time.
struct Outcome {
  uint64_t seeds;
  RelaxReport report;
  double ms;
};

template <class Relax>
Outcome relaxed(const SeedSet& start, int32_t passes, Backend backend, Relax relax) {
  bench::BackendContext context(backend);
  SeedSet seeds = to_host(start);
  RelaxOptions options;
  options.max_passes = passes;
  options.tolerance_ppb = 0;
  const bench::Watch watch;
  Outcome out{0, relax(seeds, options, context), 0};
  out.ms = watch.ms();
  out.seeds = digest(to_host(seeds));
  return out;
}

template <class Relax>
bool check(const char* method, const SeedSet& start, Relax relax) {
  bool same = true;
  for (const int passes : {1, 2, 20}) {
    const Outcome cpu = relaxed(start, passes, Backend::cpu, relax),
                  cuda = relaxed(start, passes, Backend::cuda, relax);
    const std::vector<double>&a = cpu.report.energy, &b = cuda.report.energy;
    size_t first = 0;
    while (first < a.size() && first < b.size() && a[first] == b[first]) ++first;
    const bool equal = cpu.seeds == cuda.seeds && a == b;
    same &= equal;
    if (!equal)
      std::printf("DIFFERS %s k=%lld passes=%d digest %s, %zu and %zu energies, the first %zu agree\n", method,
                  (long long)start.size(), passes, cpu.seeds == cuda.seeds ? "same" : "differs", a.size(), b.size(),
                  first);
  }
  return same;
}

/// The dual labels the sheet by itself.
bool check_dual(const Sheet& sheet, const SeedSet& start) {
  uint64_t digests[2];
  for (const Backend backend : {Backend::cpu, Backend::cuda}) {
    bench::BackendContext context(backend);
    const Triangulation made = triangulate_dual(sheet, to_host(start), {}, context);
    digests[backend == Backend::cuda] = digest(to_world(to_host(made.mesh), sheet.frame)) ^ digest(to_host(made.seeds));
  }
  if (digests[0] != digests[1]) std::printf("DIFFERS dual k=%lld\n", (long long)start.size());
  return digests[0] == digests[1];
}

struct Times {
  double pass_ms, start_ms;
};

template <class Relax>
Times measure(const SeedSet& start, Relax relax) {
  std::vector<double> each, start_ms;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double few = relaxed(start, 16, Backend::cuda, relax).ms, many = relaxed(start, 80, Backend::cuda, relax).ms;
    each.push_back((many - few) / 64);
    start_ms.push_back(few - 16 * each.back());
  }
  return {bench::spread_of(each).median, bench::spread_of(start_ms).median};
}

}  // namespace

int main(int argc, char** argv) {
  bool want_check = false, no_time = false, no_shell = false;
  const std::vector<std::string> words =
      bench::read_arguments(argc, argv, "bench_cuda_relax MESH rRESOLUTION K [K ...] [rRESOLUTION K [K ...]] ...", 3,
                            {{"--check", "", &want_check}, {"--no-time", "", &no_time}, {"--no-shell", "", &no_shell}});
  const bool want_time = !no_time, want_shell = !no_shell;
  const TriangleSoup soup = read_mesh(words[0]);
  const std::string name = bench::file_name(words[0]);
  Setup setup;
  bool all_same = true;
  for (size_t i = 1; i < words.size(); ++i) {
    const char* const word = words[i].c_str();
    if (word[0] == 'r') {
      const bench::Watch watch;
      setup = prepare(soup, std::atoi(word + 1), want_shell);
      std::printf("%s %s: %lld sheet vertices, %lld leaves, %lld shell voxels, prepared in %.0f ms\n", name.c_str(),
                  word, (long long)setup.sheet.vertex_count(), (long long)setup.sheet.blocks.count(),
                  (long long)(want_shell ? setup.shell.voxels.voxel_count() : 0), watch.ms());
      continue;
    }
    bench::BackendContext cpu(Backend::cpu);
    const int64_t k = std::atoll(word);
    const auto on_sheet = [&](SeedSet& seeds, const RelaxOptions& o, Context& c) {
      RelaxedSeeds relaxed = relax_on_sheet(setup.sheet, std::move(seeds), o, c);
      seeds = std::move(relaxed.seeds);
      return relaxed.report;
    };
    const SeedSet start = place_seeds(setup.sheet, {k, 1}, cpu);
    bool same = true;
    if (want_check) {
      same = check("sheet", start, on_sheet);
      same &= check_dual(setup.sheet, start);
    }
    const Times sheet = want_time ? measure(start, on_sheet) : Times{};
    Times shell{};
    if (want_shell) {
      const auto in_shell = [&](SeedSet& seeds, const RelaxOptions& o, Context& c) {
        RelaxedSeeds relaxed = relax_in_shell(setup.shell, setup.sites, setup.samples, std::move(seeds), o, c);
        seeds = std::move(relaxed.seeds);
        return relaxed.report;
      };
      const SeedSet sites = place_seeds(setup.sites, setup.samples, {k, 1}, cpu);
      if (want_check) same &= check("shell", sites, in_shell);
      if (want_time) shell = measure(sites, in_shell);
    }
    all_same &= same;
    std::printf("%-16s k %8lld  sheet V %9lld %8.4f ms (+ %.2f)  shell voxels %9lld %8.4f ms (+ %.2f)  %s\n",
                name.c_str(), (long long)k, (long long)setup.sheet.vertex_count(), sheet.pass_ms, sheet.start_ms,
                (long long)(want_shell ? setup.shell.voxels.voxel_count() : 0), shell.pass_ms, shell.start_ms,
                want_check ? same ? "same as the CPU" : "DIFFERS" : "");
    std::fflush(stdout);
  }
  return all_same ? 0 : 1;
}
