// Milliseconds per relaxation pass on the device, of both methods, and whether they give what the CPU gives.
//   bench_cuda_relax MESH [--check] [--no-time] [--no-shell] rRESOLUTION K [K ...] [rRESOLUTION K [K ...]] ...
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/isoshell.h"

using namespace isoshell;

namespace {

double now_us() {
  using Clock = std::chrono::steady_clock;
  return std::chrono::duration<double, std::micro>(Clock::now().time_since_epoch()).count();
}

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
  Context cuda;
  cuda.backend = Backend::cuda;
  const auto [lo, hi] = bounding_box(soup);
  Setup s;
  s.surface = snap_surface(soup, LatticeFrame::around(lo, hi, resolution), cuda);
  s.sites = voxelize(s.surface, cuda);
  s.samples = sample_sites(s.surface, s.sites, cuda);
  s.sheet = build_sheet(s.surface, s.sites, s.samples, {0, 0}, cuda);
  if (want_shell) s.shell = build_shell(s.sites, {2}, cuda);
  return s;
}

SeedSet copy_of(const SeedSet& seeds) { return to_host(seeds); }

/// Relaxes with so many passes on a backend; gives the digest of the seeds and the time.
struct Outcome {
  uint64_t seeds;
  RelaxReport report;
  double us;
};

template <class Relax>
Outcome relaxed(const SeedSet& start, int32_t passes, Backend backend, Relax relax) {
  Context context;
  context.backend = backend;
  SeedSet seeds = copy_of(start);
  RelaxOptions options;
  options.max_passes = passes;
  options.tolerance_ppb = 0;
  const double before = now_us();
  Outcome out{0, relax(seeds, options, context), 0};
  out.us = now_us() - before;
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
    Context context;
    context.backend = backend;
    const Triangulation made = triangulate_dual(sheet, copy_of(start), {}, context);
    digests[backend == Backend::cuda] = digest(to_world(to_host(made.mesh), sheet.frame)) ^ digest(to_host(made.seeds));
  }
  if (digests[0] != digests[1]) std::printf("DIFFERS dual k=%lld\n", (long long)start.size());
  return digests[0] == digests[1];
}

struct Times {
  double pass_us, start_us;
};

template <class Relax>
Times measure(const SeedSet& start, Relax relax) {
  std::vector<double> each, start_us;
  for (int repeat = 0; repeat < 5; ++repeat) {
    const double few = relaxed(start, 16, Backend::cuda, relax).us, many = relaxed(start, 80, Backend::cuda, relax).us;
    each.push_back((many - few) / 64);
    start_us.push_back(few - 16 * each.back());
  }
  std::sort(each.begin(), each.end());
  std::sort(start_us.begin(), start_us.end());
  return {each[2], start_us[2]};
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) return 2;
  bool want_check = false, want_shell = true, want_time = true;
  const TriangleSoup soup = read_mesh(argv[1]);
  Setup setup;
  const auto name = std::string(argv[1]).substr(std::string(argv[1]).rfind('/') + 1);
  bool all_same = true;
  for (int a = 2; a < argc; ++a) {
    if (!std::strcmp(argv[a], "--check")) {
      want_check = true;
      continue;
    }
    if (!std::strcmp(argv[a], "--no-time")) {
      want_time = false;
      continue;
    }
    if (!std::strcmp(argv[a], "--no-shell")) {
      want_shell = false;
      continue;
    }
    if (argv[a][0] == 'r') {
      const double before = now_us();
      setup = prepare(soup, std::atoi(argv[a] + 1), want_shell);
      std::printf("%s %s: %lld sheet vertices, %lld leaves, %lld shell voxels, prepared in %.0f ms\n", name.c_str(),
                  argv[a], (long long)setup.sheet.vertex_count(), (long long)setup.sheet.blocks.count(),
                  (long long)(want_shell ? setup.shell.voxels.voxel_count() : 0), (now_us() - before) / 1000);
      continue;
    }
    Context cpu;
    cpu.backend = Backend::cpu;
    const int64_t k = std::atoll(argv[a]);
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
                name.c_str(), (long long)k, (long long)setup.sheet.vertex_count(), sheet.pass_us / 1000,
                sheet.start_us / 1000, (long long)(want_shell ? setup.shell.voxels.voxel_count() : 0),
                shell.pass_us / 1000, shell.start_us / 1000, want_check ? same ? "same as the CPU" : "DIFFERS" : "");
    std::fflush(stdout);
  }
  return all_same ? 0 : 1;
}
