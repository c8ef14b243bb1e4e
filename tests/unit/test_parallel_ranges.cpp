// Loops over threads: every index once, sums, and what a body throws.
#include <atomic>
#include <functional>
#include <stdexcept>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("parallel ranges: every index is visited once, whatever the grain", "[parallel_ranges]") {
  for (const int64_t count : {0, 1, 7, 10000})
    for (const int64_t grain : {1, 64, 100000}) {
      std::vector<std::atomic<int>> visits(size_t(count) + 1);
      for_ranges(count, grain, [&](int64_t begin, int64_t end) {
        for (int64_t i = begin; i < end; ++i) ++visits[size_t(i)];
      });
      for (int64_t i = 0; i < count; ++i) REQUIRE(visits[size_t(i)] == 1);
      CHECK(visits.back() == 0);
      CHECK(sum_over_ranges(count, grain, [](int64_t begin, int64_t end) {
              int64_t part = 0;
              for (int64_t i = begin; i < end; ++i) part += i;
              return part;
            }) == count * (count - 1) / 2);
    }
}

TEST_CASE("parallel ranges: indices of any type begin where they are told, and none are between ends that cross",
          "[parallel_ranges]") {
  std::atomic<int64_t> sum{0};
  const auto add = [&](auto i) { sum += int64_t(i); };
  for_each_index(int32_t(-3), int32_t(5), add);
  CHECK(sum == 4);  // -3 + ... + 4
  for_each_index(4000000000u, 4000000003u, add);
  CHECK(sum == 4 + 12000000003);
  for_each_index(size_t(5), size_t(2), add);
  for_each_index(int64_t(1), int64_t(-1), add);
  CHECK(sum == 4 + 12000000003);
}

TEST_CASE("parallel ranges: what a body throws is thrown to the caller", "[parallel_ranges]") {
  CHECK_THROWS_AS(for_each_index(0, 1000,
                                 [](int i) {
                                   if (i == 700) throw std::runtime_error("700");
                                 }),
                  std::runtime_error);
}

TEST_CASE("parallel ranges: values are joined in one order, whatever the threads", "[parallel_ranges]") {
  const auto part = [](size_t i) { return 1 / double(i + 1); };
  for (const size_t count : {size_t(0), size_t(1), size_t(4096), size_t(100000)}) {
    const double sum = joined_over(count, 0., part, std::plus<double>());
    Context context;
    for (context.threads = 1; context.threads < 4; ++context.threads)
      CHECK(run_with_threads(context, [&] { return joined_over(count, 0., part, std::plus<double>()); }) == sum);
    double serial = 0;
    for (size_t i = 0; i < count; ++i) serial += part(i);
    CHECK(sum == Approx(serial).epsilon(1e-12));
  }
}
