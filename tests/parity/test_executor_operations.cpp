// Every word of an executor gives its one mathematical answer, on every backend, at sizes around those of warps and
// blocks, and beyond 32 bits where memory allows. And floating point keeps to IEEE 754.
#include <algorithm>
#include <functional>
#include <numeric>
#include <tuple>

#include "isoshell/error.h"
#include "parity/canary_table.h"
#include "parity/executor_operations.h"
#include "support/catch.h"
#include "support/test_context.h"
#include "voxel/random.h"

using namespace isoshell;
using namespace isoshell::parity;

namespace {

constexpr int64_t kSizes[] = {0, 1, 2, 31, 32, 33, 127, 128, 129, 1000, 1024, 1025, 4096, 16384, 16385, 65537, 1000007};
constexpr int64_t kBeyond32Bits = (int64_t(1) << 31) + 77;

struct Operations {
  TestContext context;
  std::unique_ptr<ExecutorOperations> operations;

  Operations() {
    operations =
        context.backend == Backend::cuda ? cuda_executor_operations(context) : tbb_executor_operations(context);
  }
  ExecutorOperations* operator->() { return operations.get(); }
};

template <class T>
std::vector<T> random_values(int64_t count, uint64_t below, uint64_t seed) {
  std::vector<T> out = std::vector<T>(size_t(count));
  for (size_t i = 0; i < out.size(); ++i) out[i] = T(random_bits(seed, i) % below);
  return out;
}

template <class T>
std::vector<T> exclusive_sums(const std::vector<T>& counts, T& total) {
  std::vector<T> out(counts.size());
  total = 0;
  for (size_t i = 0; i < out.size(); ++i) {
    out[i] = total;
    total = T(total + counts[i]);
  }
  return out;
}

template <class T>
std::vector<T> inclusive_sums(std::vector<T> counts) {
  std::partial_sum(counts.begin(), counts.end(), counts.begin());
  return counts;
}

/// Runs `work` unless memory is short. The host's is not tried: these sizes are for devices.
void with_large_memory(const std::function<void()>& work) {
  if (test_backend() != Backend::cuda) return;
  try {
    work();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_memory) throw;
    WARN("left out: " << e.what());
  }
}

}  // namespace

TEST_CASE("executor operations: fill and for_each reach every element", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    CHECK(operations->fill(n, 0xdeadbeefu) == std::vector<uint32_t>(size_t(n), 0xdeadbeefu));
    CHECK(operations->fill_bytes(n, 0xa5) == std::vector<uint8_t>(size_t(n), 0xa5));
    std::vector<uint64_t> expected(size_t(n), 0);
    for (size_t i = 0; i < expected.size(); ++i) expected[i] = random_bits(7, i);
    CHECK(operations->for_each(n) == expected);
  }
}

TEST_CASE("executor operations: copy and value read what was written", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    const std::vector<uint64_t> values = random_values<uint64_t>(n, UINT64_MAX, 11);
    CHECK(operations->copy(values) == values);
    for (int64_t i : {int64_t(0), n / 2, n - 1})
      if (n > 0) CHECK(operations->value(values, i) == values[size_t(i)]);
  }
}

TEST_CASE("executor operations: scans add up in both widths", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    const std::vector<int64_t> wide = random_values<int64_t>(n, uint64_t(1) << 40, 1);
    int64_t total = -1, expected_total = -1;
    const std::vector<int64_t> expected = exclusive_sums(wide, expected_total);
    CHECK(operations->exclusive_scan(wide, total) == expected);
    CHECK(total == expected_total);
    CHECK(operations->inclusive_scan(wide) == inclusive_sums(wide));

    const std::vector<uint32_t> narrow = random_values<uint32_t>(n, 9, 2);
    uint32_t narrow_total = 1, expected_narrow_total = 1;
    const std::vector<uint32_t> expected_narrow = exclusive_sums(narrow, expected_narrow_total);
    CHECK(operations->exclusive_scan(narrow, narrow_total) == expected_narrow);
    CHECK(narrow_total == expected_narrow_total);
    CHECK(operations->inclusive_scan(narrow) == inclusive_sums(narrow));
  }
}

TEST_CASE("executor operations: a scan of terms gives the sum of all, too", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    std::vector<int64_t> expected(size_t(n) + 1, 0);
    for (int64_t i = 0; i < n; ++i) expected[size_t(i) + 1] = expected[size_t(i)] + i % 1000 - 499;
    int64_t total = 1;
    CHECK(operations->exclusive_scan_of(n, total) == expected);
    CHECK(total == expected.back());
  }
}

TEST_CASE("executor operations: sort orders keys of one, two and three words, repeats included",
          "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    for (const uint64_t below : {UINT64_MAX, uint64_t(5)}) {
      const std::vector<uint64_t> keys = random_values<uint64_t>(n, below, 3);
      std::vector<uint64_t> ordered = keys;
      std::sort(ordered.begin(), ordered.end());
      CHECK(operations->sort(keys) == ordered);
      std::reverse(ordered.begin(), ordered.end());
      CHECK(operations->sort_descending(keys) == ordered);
    }
    const std::vector<uint32_t> narrow = random_values<uint32_t>(n, uint64_t(1) << 32, 4);
    std::vector<uint32_t> narrow_ordered = narrow;
    std::sort(narrow_ordered.begin(), narrow_ordered.end());
    CHECK(operations->sort(narrow) == narrow_ordered);

    std::vector<OddKey> odd = std::vector<OddKey>(size_t(n));
    for (uint32_t i = 0; i < odd.size(); ++i)
      odd[i] = {uint32_t(random_bits(5, i) % 7), uint32_t(random_bits(6, i) % 1000), i};
    std::vector<OddKey> odd_ordered = odd;
    std::sort(odd_ordered.begin(), odd_ordered.end(), [](const OddKey& a, const OddKey& b) {
      return std::tie(a.high, a.low, a.tag) < std::tie(b.high, b.low, b.tag);
    });
    CHECK(operations->sort(odd) == odd_ordered);
  }
}

TEST_CASE("executor operations: select keeps what it is told to, in order", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes)
    for (const uint64_t modulus : {uint64_t(1), uint64_t(2), uint64_t(37), uint64_t(1) << 62}) {
      CAPTURE(n, modulus);
      std::vector<uint32_t> expected;
      for (uint32_t i = 0; i < n; ++i)
        if (random_bits(9, i) % modulus == 0) expected.push_back(i);
      CHECK(operations->select(n, modulus) == expected);
    }
}

TEST_CASE("executor operations: sum is exact, with terms of both signs", "[parity][executor_operations]") {
  Operations operations;
  for (int64_t n : kSizes) {
    CAPTURE(n);
    int64_t expected = 0;
    for (int64_t i = 0; i < n; ++i) expected += i % 1000 - 499;
    CHECK(operations->sum(n) == expected);
    CHECK(operations->sum_into(n) == std::vector<int64_t>{-1, expected, -1});
  }
}

TEST_CASE("executor operations: arrays of more than two thousand million elements", "[parity][executor_operations]") {
  Operations operations;
  const int64_t n = kBeyond32Bits;
  with_large_memory([&] {
    const int64_t rest = n % 1000;
    CHECK(operations->sum(n) == n / 1000 * 500 + rest * (rest - 1) / 2 - 499 * rest);
  });
  with_large_memory([&] {
    int64_t expected = n / 251 * (250 * 251 / 2);
    for (int64_t i = n / 251 * 251; i < n; ++i) expected += i % 251;
    CHECK(operations->write_and_sum(n) == expected);
  });
  with_large_memory([&] {
    CHECK(operations->scan_ones(n, {0, 1, n / 2, n - 1}) == std::vector<int64_t>{0, 1, n / 2, n - 1, n});
  });
  with_large_memory([&] {
    CHECK(operations->sort_reversed(n, {0, 1, n / 2, n - 1}) ==
          std::vector<uint64_t>{0, 1, uint64_t(n / 2), uint64_t(n - 1)});
  });
  with_large_memory([&] {
    const int64_t modulus = 1001, kept = n / modulus;
    CHECK(operations->select_multiples(n, modulus) == std::vector<int64_t>{kept, kept * modulus - 1});
  });
}

TEST_CASE("executor operations: a cancelled context stops every backend", "[parity][executor_operations]") {
  Operations operations;
  operations.context.cancel = true;
  for (const int64_t n : {1, 1000, 100000}) {
    CAPTURE(n);
    int64_t total;
    uint32_t small_total;
    const std::vector<int64_t> counts(size_t(n), 1);
    const std::vector<uint32_t> small_counts(size_t(n), 1);
    CHECK_THROWS_AS(operations->fill(n, 1), Error);
    CHECK_THROWS_AS(operations->for_each(n), Error);
    CHECK_THROWS_AS(operations->exclusive_scan(counts, total), Error);
    CHECK_THROWS_AS(operations->exclusive_scan(small_counts, small_total), Error);
    CHECK_THROWS_AS(operations->inclusive_scan(counts), Error);
    CHECK_THROWS_AS(operations->inclusive_scan(small_counts), Error);
    CHECK_THROWS_AS(operations->sort(std::vector<uint64_t>(size_t(n))), Error);
    CHECK_THROWS_AS(operations->sort(std::vector<OddKey>(size_t(n))), Error);
    CHECK_THROWS_AS(operations->select(n, 2), Error);
    CHECK_THROWS_AS(operations->sum(n), Error);
    CHECK_THROWS_AS(operations->sum_into(n), Error);
  }
}

TEST_CASE("canary: floating point is that of IEEE 754, bit by bit", "[parity][canary]") {
  Operations operations;
  std::vector<CanaryOperands> operands;
  for (const CanaryCase& c : kCanaries) operands.push_back(c.operands);
  const std::vector<uint64_t> bits = operations->canary(operands);
  for (size_t i = 0; i < bits.size(); ++i) {
    CAPTURE(i, operands[i].operation, operands[i].a, operands[i].b, operands[i].c);
    CHECK(bits[i] == kCanaries[i].expected);
  }
}
