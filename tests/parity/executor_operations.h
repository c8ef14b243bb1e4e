// Every operation of an executor (exec/executor.h) with arguments a test can make up, so that one test asks all
// backends. The bodies are in executor_operations_body.h; tbb_executor_operations.cpp and cuda_executor_operations.cu
// instantiate them.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "isoshell/backend.h"

namespace isoshell::parity {

/// One operation of canary_cases.h on bits of operands; see CanaryStep.
struct CanaryOperands {
  uint64_t operation;
  uint64_t a, b, c;
};

/// 12 bytes, as no machine word has: merge sort, not radix sort.
struct OddKey {
  uint32_t high, low, tag;
};
inline bool operator==(const OddKey& a, const OddKey& b) {
  return a.high == b.high && a.low == b.low && a.tag == b.tag;
}

/// Inputs and results lie in host memory; what happens between them is the executor's.
class ExecutorOperations {
 public:
  virtual ~ExecutorOperations() = default;
  virtual std::vector<uint32_t> fill(int64_t count, uint32_t value) = 0;
  virtual std::vector<uint8_t> fill_bytes(int64_t count, uint8_t value) = 0;
  virtual std::vector<uint64_t> copy(const std::vector<uint64_t>& values) = 0;
  virtual uint64_t value(const std::vector<uint64_t>& values, int64_t i) = 0;
  /// random_bits(7, i) per element.
  virtual std::vector<uint64_t> for_each(int64_t count) = 0;
  virtual std::vector<int64_t> exclusive_scan(std::vector<int64_t> counts, int64_t& total) = 0;
  virtual std::vector<uint32_t> exclusive_scan(std::vector<uint32_t> counts, uint32_t& total) = 0;
  /// Of i % 1000 - 499, with the sum of all behind.
  virtual std::vector<int64_t> exclusive_scan_of(int64_t count, int64_t& total) = 0;
  virtual std::vector<int64_t> inclusive_scan(std::vector<int64_t> counts) = 0;
  virtual std::vector<uint32_t> inclusive_scan(std::vector<uint32_t> counts) = 0;
  virtual std::vector<uint64_t> sort(std::vector<uint64_t> keys) = 0;
  virtual std::vector<uint32_t> sort(std::vector<uint32_t> keys) = 0;
  virtual std::vector<uint64_t> sort_descending(std::vector<uint64_t> keys) = 0;
  virtual std::vector<OddKey> sort(std::vector<OddKey> keys) = 0;
  /// Ascending i below count with random_bits(9, i) % modulus == 0.
  virtual std::vector<uint32_t> select(int64_t count, uint64_t modulus) = 0;
  /// Sum of i % 1000 - 499.
  virtual int64_t sum(int64_t count) = 0;
  /// The same into the middle one of three numbers that are -1 before.
  virtual std::vector<int64_t> sum_into(int64_t count) = 0;
  virtual std::vector<uint64_t> canary(const std::vector<CanaryOperands>& cases) = 0;

  // On arrays that stay with the executor, of more elements than 32 bits count.

  /// Writes i % 251 to `count` bytes by for_each and adds them up by sum.
  virtual int64_t write_and_sum(int64_t count) = 0;
  /// Exclusive scan of `count` ones in 64 bits; element i of the result at each of `at`, then the total.
  virtual std::vector<int64_t> scan_ones(int64_t count, const std::vector<int64_t>& at) = 0;
  /// Sorts count - 1, ..., 1, 0 and gives the elements at each of `at`.
  virtual std::vector<uint64_t> sort_reversed(int64_t count, const std::vector<int64_t>& at) = 0;
  /// Number of selected i below count with i % modulus == modulus - 1, then the last of them.
  virtual std::vector<int64_t> select_multiples(int64_t count, int64_t modulus) = 0;
};

std::unique_ptr<ExecutorOperations> tbb_executor_operations(Context& context);
/// Null in a build without CUDA. Throws: no_device.
std::unique_ptr<ExecutorOperations> cuda_executor_operations(Context& context);

}  // namespace isoshell::parity
