// How a device is chosen, and how a stage on it ends early: too little memory, a device that is not there, a cancelled
// run.
#include "isoshell/error.h"
#include "isoshell/isoshell.h"
#include "parity/cuda_streams.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

LatticeSurface ball() {
  Context context;
  context.backend = Backend::cpu;  // so that it holds none of the device's memory
  const TriangleSoup soup = shapes::sphere({0, 0, 0}, 1, 48);
  return snap_surface(soup, LatticeFrame::around({-1, -1, -1}, {1, 1, 1}, 200), context);
}

}  // namespace

TEST_CASE("device: the one that runs is named", "[device]") {
  const TestContext context;
  const DeviceInfo info = device_info(context);
  CHECK(info.backend == "cuda");
  CHECK(info.number == 0);
  CHECK_FALSE(info.name.empty());
  CHECK_FALSE(info.cuda_version.empty());
  CHECK(info.memory_bytes >= info.free_bytes);
  CHECK(info.free_bytes > 0);
  WARN(info.name << ", driver " << info.driver_version << ", CUDA " << info.cuda_version);
}

TEST_CASE("device: auto takes it, and a number beyond the last is refused", "[device]") {
  Context context;
  CHECK(std::string(backend_name(context)) == "cuda");
  context.backend = Backend::cuda;
  context.device = 1000;
  const Error error = error_of([&] { voxelize(ball(), context); });
  CHECK(error.code() == ErrorCode::no_device);
  CHECK(says(error, "no CUDA device 1000: this machine has"));
}

TEST_CASE("device: a stage beyond the memory limit ends with out_of_memory and gives everything back", "[device]") {
  const LatticeSurface surface = ball();
  TestContext context;
  context.memory_limit_bytes = 100000;
  const Error error = error_of([&] { voxelize(surface, context); });
  CHECK(error.code() == ErrorCode::out_of_memory);
  CHECK(says(error, "limit"));
  context.memory_limit_bytes = 0;
  const uint64_t whole = digest(voxelize(surface, context));
  Context cpu;
  cpu.backend = Backend::cpu;
  CHECK(whole == digest(voxelize(surface, cpu)));
  reset_device_memory_peak(context.device);
  CHECK(device_memory_peak_bytes(context.device) == 0);
}

TEST_CASE("device: a copy for another context is of what was enqueued before it", "[device]") {
  Context from, to;
  from.backend = to.backend = Backend::cuda;
  for (const int64_t count : {int64_t(1), int64_t(1000), int64_t(1) << 26}) {
    CAPTURE(count);
    CHECK(parity::wrong_in_copy(from, to, count) == 0);
  }
  to.backend = Backend::best;
  to.device = 1;
  if (std::string(backend_name(to)) != "cuda") {
    WARN("one device only: nothing is copied between two");
    return;
  }
  CHECK(parity::wrong_in_copy(from, to, int64_t(1) << 24) == 0);
}

TEST_CASE("device: contexts take each other's products and change them", "[device]") {
  const LatticeSurface surface = ball();
  const auto run = [&](Context& one, Context& other) {
    Shell shell;
    SeedSet seeds;
    {
      const SiteSet sites = voxelize(surface, one);
      shell = build_shell(sites, {3}, other);
      const SiteSamples samples = sample_sites(surface, sites, other);
      seeds = place_seeds(sites, samples, {300, 0}, one);
      seeds = relax_in_shell(shell, sites, samples, std::move(seeds), {5, 0, 0}, other).seeds;
    }
    seeds = relax_in_shell(shell, voxelize(surface, other), sample_sites(surface, voxelize(surface, one), other),
                           std::move(seeds), {5, 0, 0}, one)
                .seeds;
    return std::vector<uint64_t>{digest(shell), digest(seeds)};
  };
  Context cpu, one, other;
  cpu.backend = Backend::cpu;
  one.backend = other.backend = Backend::cuda;
  const std::vector<uint64_t> expected = run(cpu, cpu);
  for (int round = 0; round < 10; ++round) CHECK(run(one, other) == expected);
  CHECK(run(one, cpu) == expected);
  CHECK(run(cpu, other) == expected);
}

TEST_CASE("device: every stage stops when its context is cancelled", "[device]") {
  Context cpu;
  cpu.backend = Backend::cpu;
  const LatticeSurface surface = ball();
  const SiteSet sites = voxelize(surface, cpu);
  const SiteSamples samples = sample_sites(surface, sites, cpu);
  const Shell shell = build_shell(sites, {2}, cpu);
  const Sheet sheet = build_sheet(surface, sites, samples, {0, 0}, cpu);
  const SeedSet seeds = place_seeds(sheet, {300, 0}, cpu);
  TestContext context;
  context.cancel = true;
  SeedSet moved = to_host(seeds);
  DualReport report;
  const std::function<void()> stages[] = {[&] { voxelize(surface, context); },
                                          [&] { sample_sites(surface, sites, context); },
                                          [&] { build_shell(sites, {2}, context); },
                                          [&] {
                                            build_sheet(surface, sites, samples, {0, 0}, context);
                                          },
                                          [&] {
                                            relax_on_sheet(sheet, moved, {20, 0, 0}, context);
                                          },
                                          [&] {
                                            relax_in_shell(shell, sites, samples, moved, {20, 0, 0}, context);
                                          },
                                          [&] { flood_shell(shell, seeds, context); },
                                          [&] { triangulate_dual(sheet, moved, {}, report, context); }};
  for (const auto& stage : stages) CHECK(error_of(stage).code() == ErrorCode::interrupted);
}
