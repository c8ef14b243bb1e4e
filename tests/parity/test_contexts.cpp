// Many contexts at once in one process: each remeshes on a thread of its own, and every mesh has the bytes that a
// context alone gives.
#include <atomic>
#include <chrono>
#include <map>
#include <mutex>
#include <thread>

#include "isoshell/error.h"
#include "isoshell/isoshell.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/source_folder.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

bool on_device() { return test_backend() == Backend::cuda; }

RemeshOptions options_for(Method method) {
  RemeshOptions options;
  options.vertices = 1500;
  options.method = method;
  options.want_digests = true;
  return options;
}

struct Model {
  TriangleSoup soup;
  std::map<Method, std::string> expected;  ///< digest of the mesh, made by one context on the CPU
};

const std::vector<Model>& models() {
  static const std::vector<Model> made = [] {
    std::vector<Model> models;
    models.push_back({read_mesh(source_folder() + "/tests/data/nefertiti.ply"), {}});
    models.push_back({shapes::torus(3, 1, 96, 48), {}});
    models.push_back({shapes::sphere({0, 0, 0}, 1, 64), {}});
    models.push_back({shapes::box({0, 0, 0}, {3, 2, 1}), {}});
    for (Model& model : models)
      for (const Method method : {Method::sheet, Method::shell}) {
        Context cpu;
        cpu.backend = Backend::cpu;
        model.expected[method] = remesh(model.soup, options_for(method), cpu).report.digests["mesh"];
      }
    return models;
  }();
  return made;
}

enum class Run { whole, cancelled, capped };

/// One run; returns what is wrong with how it ended, or nothing.
std::string run_once(const Model& model, Method method, Run how, Context& context) {
  context.backend = test_backend();
  context.threads = on_device() ? 0 : 1;
  context.cancel = false;
  context.memory_limit_bytes = how == Run::capped ? int64_t(1) << 18 : 0;
  std::thread canceller;
  if (how == Run::cancelled)
    canceller = std::thread([&] {
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
      context.cancel = true;
    });
  std::string wrong;
  try {
    if (how == Run::capped && on_device()) {  // beyond the estimate, which would refuse the whole run
      const auto [lo, hi] = bounding_box(model.soup);
      voxelize(snap_surface(model.soup, LatticeFrame::around(lo, hi, 600), context), context);
    }
    RemeshResult result = remesh(model.soup, options_for(method), context);
    if (how == Run::capped) wrong = "a run was not refused at 256 KiB";
    if (result.report.digests["mesh"] != model.expected.at(method)) wrong = "another mesh than that of the CPU";
  } catch (const Error& e) {
    const bool wanted = (how == Run::cancelled && e.code() == ErrorCode::interrupted) ||
                        (how == Run::capped && e.code() == ErrorCode::out_of_memory);
    if (!wanted) wrong = e.what();
  }
  if (canceller.joinable()) canceller.join();
  return wrong;
}

/// What went wrong, and how often. `kept`: a thread keeps its context. `rough`: some runs take the paper's method, some
/// are cancelled, some may take too little memory.
std::map<std::string, int> run_side_by_side(int threads, int runs_a_thread, bool kept, bool rough) {
  std::atomic<int> next{0};
  std::mutex mutex;
  std::map<std::string, int> wrong;
  const auto work = [&] {
    Context own;
    for (int run; (run = next++) < threads * runs_a_thread;) {
      const Run how = rough && run % 7 == 6 ? Run::cancelled : rough && run % 11 == 10 ? Run::capped : Run::whole;
      Context fresh;
      const std::string said = run_once(models()[size_t(run) % models().size()],
                                        rough && run % 5 == 4 ? Method::shell : Method::sheet, how, kept ? own : fresh);
      const std::lock_guard<std::mutex> lock(mutex);
      if (!said.empty()) ++wrong[said];
    }
  };
  std::vector<std::thread> pool;
  for (int t = 0; t < threads; ++t) pool.emplace_back(work);
  for (std::thread& t : pool) t.join();
  return wrong;
}

SiteSet sites_at(int32_t resolution, Context& context) {
  static const TriangleSoup soup = shapes::sphere({0, 0, 0}, 1, 64);
  return voxelize(snap_surface(soup, LatticeFrame::around({-1, -1, -1}, {1, 1, 1}, resolution), context), context);
}

std::vector<int> thread_counts() { return on_device() ? std::vector<int>{2, 8, 16} : std::vector<int>{3}; }
int runs_a_thread() { return on_device() ? 20 : 2; }
const std::map<std::string, int> kNothing;

}  // namespace

TEST_CASE("contexts: many at once give the bytes of one", "[contexts]") {
  for (const int threads : thread_counts())
    for (const bool kept : {false, true}) {
      CAPTURE(threads, kept);
      CHECK(run_side_by_side(threads, runs_a_thread(), kept, false) == kNothing);
    }
}

TEST_CASE("contexts: cancelled and capped runs leave those beside them alone", "[contexts]") {
  for (const int threads : thread_counts())
    for (const bool kept : {false, true}) {
      CAPTURE(threads, kept);
      CHECK(run_side_by_side(threads, runs_a_thread(), kept, true) == kNothing);
    }
}

TEST_CASE("contexts: a memory limit counts what the context itself takes", "[contexts]") {
  if (!on_device()) return;  // a limit is the host's, or the device's where it runs there
  TestContext large, small;
  const SiteSet held = sites_at(1000, large);
  REQUIRE(device_memory_peak_bytes(large.device) > int64_t(32) << 20);
  small.memory_limit_bytes = int64_t(16) << 20;
  CHECK(sites_at(100, small).voxels.voxel_count() > 0);
}

TEST_CASE("contexts: a product that an earlier context left behind gives no room above a limit", "[contexts]") {
  if (!on_device()) return;
  const auto peak_bytes_from_now = [](const auto& run) {
    reset_device_memory_peak(0);
    const int64_t before = device_memory_peak_bytes(0);
    run();
    return device_memory_peak_bytes(0) - before;
  };
  SiteSet left;
  const int64_t needed_bytes = peak_bytes_from_now([&] {
    TestContext earlier;
    left = sites_at(1000, earlier);
  });
  const int64_t left_bytes = left.voxels.leaf_key.size_bytes() + left.voxels.mask.size_bytes();
  REQUIRE(left_bytes > int64_t(1) << 20);
  TestContext next;
  CHECK(sites_at(100, next).voxels.voxel_count() > 0);
  left = {};
  next.memory_limit_bytes = needed_bytes - left_bytes / 2;
  CHECK(error_of([&] { sites_at(1000, next); }).code() == ErrorCode::out_of_memory);
}

TEST_CASE("contexts: the device's memory stays as it is after the first round", "[contexts]") {
  if (!on_device()) return;
  const auto free_bytes_after = [](int rounds) {
    for (int i = 0; i < rounds; ++i) run_side_by_side(8, 4, false, true);
    return device_info(TestContext()).free_bytes;
  };
  const int64_t before = free_bytes_after(2), after = free_bytes_after(6);
  CHECK(before - after <= int64_t(64) << 20);  // the order in which threads take blocks is chance
}
