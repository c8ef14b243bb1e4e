// Many surfaces side by side: their results in order, each with the bytes that it has alone.
#include <algorithm>
#include <atomic>
#include <chrono>
#include <thread>

#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/workers.h"
#include "isoshell/remesh_many.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

RemeshOptions small() {
  RemeshOptions options;
  options.vertices = 60;
  options.resolution = 24;
  return options;
}

/// Every third is a box, and takes longer or shorter than the tori beside it.
TriangleSoup surface(int64_t i) {
  if (i % 3 == 0) return shapes::box({0, 0, 0}, {1, 1, 1 + 0.1 * double(i)});
  return shapes::torus(3, 1 + 0.05 * double(i), 24, 12);
}

std::string digest_alone(int64_t i) {
  TestContext context;
  return digest_text(digest(remesh(surface(i), small(), context).mesh));
}

/// Gives so many surfaces, and no more.
auto first_surfaces(int64_t count) {
  return [count, i = int64_t(0)]() mutable -> std::optional<TriangleSoup> {
    if (i == count) return {};
    return surface(i++);
  };
}

struct Stop {};

}  // namespace

TEST_CASE("many: results come in the order of the surfaces and have the bytes of remesh", "[many]") {
  constexpr int64_t kSurfaces = 9;
  std::vector<std::string> expected;
  for (int64_t i = 0; i < kSurfaces; ++i) expected.push_back(digest_alone(i));
  for (const int workers : {0, 1, 3}) {
    CAPTURE(workers);
    std::vector<std::string> digests;
    const auto take = [&](const ManyResult& result) {
      CHECK(result.index == int64_t(digests.size()));
      CHECK_FALSE(result.error);
      digests.push_back(digest_text(digest(result.made.mesh)));
    };
    TestContext context;
    CHECK(remesh_many({first_surfaces(kSurfaces), take, workers}, small(), context) == kSurfaces);
    CHECK(digests == expected);
  }
}

TEST_CASE("many: no surfaces give no results", "[many]") {
  TestContext context;
  const auto take = [](const ManyResult&) { FAIL("there is nothing to take"); };
  CHECK(remesh_many({first_surfaces(0), take}, small(), context) == 0);
}

TEST_CASE("many: the error of a bad surface stands in its place, and the others are as they were", "[many]") {
  const auto next = [all = first_surfaces(5), i = 0]() mutable {
    std::optional<TriangleSoup> soup = all();
    if (i++ == 2) soup->triangles.clear();
    return soup;
  };
  TestContext alone;
  TriangleSoup bad = surface(2);
  bad.triangles.clear();
  const Error expected = error_of([&] { remesh(bad, small(), alone.plain()); });
  const auto take = [&](const ManyResult& result) {
    CAPTURE(result.index);
    CHECK(result.error.has_value() == (result.index == 2));
    if (result.error) {
      CHECK(result.error->code() == expected.code());
      CHECK(result.error->stage() == expected.stage());
      CHECK(std::string(result.error->what()) == expected.what());
    } else {
      CHECK(digest_text(digest(result.made.mesh)) == digest_alone(result.index));
    }
  };
  TestContext context;
  CHECK(remesh_many({next, take, 2}, small(), context) == 5);
}

TEST_CASE("many: no more surfaces are taken than may be under way, however many come", "[many]") {
  int64_t asked_for = 0, handed_out = 0, most = 0;
  const auto endless = [&]() -> std::optional<TriangleSoup> {
    most = std::max(most, ++asked_for - handed_out);
    return surface(0);
  };
  const auto take = [&](const ManyResult&) {
    std::this_thread::sleep_for(std::chrono::milliseconds(20));  // slower than the workers
    if (++handed_out == 12) throw Stop();
  };
  TestContext context;
  CHECK_THROWS_AS(remesh_many({endless, take, 2, 3}, small(), context), Stop);
  CHECK(most <= 3);
  CHECK(handed_out == 12);
}

TEST_CASE("many: what the functions throw ends it", "[many]") {
  TestContext context;
  const auto pass = [](const ManyResult&) {};
  const auto no_source = []() -> std::optional<TriangleSoup> { throw Stop(); };
  CHECK_THROWS_AS(remesh_many({no_source, pass, 2}, small(), context), Stop);
  const auto no_triangles = []() -> std::optional<TriangleSoup> { return TriangleSoup(); };
  const auto stop_at_error = [](ManyResult result) {
    if (result.error) throw *result.error;
  };
  const Error error = error_of([&] { remesh_many({no_triangles, stop_at_error, 2}, small(), context); });
  CHECK(error.code() == ErrorCode::nothing_to_mesh);
}

TEST_CASE("many: a context that is cancelled ends it, however long a run would take", "[many]") {
  RemeshOptions large;
  large.vertices = 400000;
  TestContext context;
  std::thread canceller([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    context.cancel = true;
  });
  const auto take = [](const ManyResult&) {};
  const auto endless = []() -> std::optional<TriangleSoup> { return shapes::torus(3, 1, 96, 48); };
  const Error error = error_of([&] { remesh_many({endless, take, 2}, large, context); });
  canceller.join();
  CHECK(error.code() == ErrorCode::interrupted);
}

TEST_CASE("many: every worker has a context of its own, as the one it was made from", "[many]") {
  Context like;
  like.backend = Backend::cpu;
  like.memory_limit_bytes = 1 << 20;
  Workers workers(like, 2);
  std::atomic<int> there{0};
  const auto meet = [&there](Context& own) {
    ++there;
    while (there < 2) std::this_thread::yield();  // so that each worker has one
    return &own;
  };
  auto one = workers.begin(meet), other = workers.begin(meet);
  const Context *first = one.get(), *second = other.get();
  CHECK(first != second);
  for (const Context* own : {first, second}) {
    CHECK(own->backend == Backend::cpu);
    CHECK(own->threads == 1);
    CHECK(own->memory_limit_bytes == 1 << 20);
  }
}

TEST_CASE("many: what no worker has taken is dropped when the workers end", "[many]") {
  std::future<int> dropped;
  {
    Context like;
    like.backend = Backend::cpu;
    Workers workers(like, 1);
    std::atomic<bool> began{false};
    workers.begin([&began](Context& own) {
      began = true;
      while (!own.cancel) std::this_thread::yield();
      return 0;
    });
    dropped = workers.begin([](Context&) { return 1; });
    while (!began) std::this_thread::yield();
  }
  CHECK_THROWS_AS(dropped.get(), std::future_error);
}
