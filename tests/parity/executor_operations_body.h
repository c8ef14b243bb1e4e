// The operations of executor_operations.h over any executor. Includers say by to_executor(executor, Buffer) how a host
// array gets to where the executor works.
#pragma once

#include <algorithm>

#include "parity/canary_cases.h"
#include "parity/executor_operations.h"
#include "voxel/random.h"

namespace isoshell::parity {

struct WriteRandom {
  View<uint64_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = random_bits(7, uint64_t(i)); }
};
struct WriteBytes {
  View<uint8_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = uint8_t(i % 251); }
};
struct ByteAt {
  View<const uint8_t> bytes;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return bytes[i]; }
};
struct WriteReversed {
  View<uint64_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = uint64_t(out.size - 1 - i); }
};
struct CentredRest {
  ISOSHELL_HD int64_t operator()(int64_t i) const { return i % 1000 - 499; }
};
struct RandomMultiple {
  uint64_t modulus;
  ISOSHELL_HD bool operator()(int64_t i) const { return random_bits(9, uint64_t(i)) % modulus == 0; }
};
struct LastOfEach {
  int64_t modulus;
  ISOSHELL_HD bool operator()(int64_t i) const { return i % modulus == modulus - 1; }
};
template <class T>
struct Smaller {
  ISOSHELL_HD bool operator()(const T& a, const T& b) const { return a < b; }
};
struct Larger {
  ISOSHELL_HD bool operator()(uint64_t a, uint64_t b) const { return a > b; }
};
struct OddKeyOrder {
  ISOSHELL_HD bool operator()(const OddKey& a, const OddKey& b) const {
    if (a.high != b.high) return a.high < b.high;
    if (a.low != b.low) return a.low < b.low;
    return a.tag < b.tag;
  }
};

template <class Executor>
class OperationsOf : public ExecutorOperations {
 public:
  explicit OperationsOf(Context& context) : exec_(context, "operations") {}

  std::vector<uint32_t> fill(int64_t count, uint32_t value) override {
    auto out = exec_.template make<uint32_t>(count);
    exec_.fill(out.view(), value);
    return here(out);
  }
  std::vector<uint8_t> fill_bytes(int64_t count, uint8_t value) override {
    auto out = exec_.template make<uint8_t>(count);
    exec_.fill(out.view(), value);
    return here(out);
  }
  std::vector<uint64_t> copy(const std::vector<uint64_t>& values) override {
    const auto from = there(values);
    auto out = exec_.template make<uint64_t>(from.size());
    exec_.copy(from.view(), out.view());
    return here(out);
  }
  uint64_t value(const std::vector<uint64_t>& values, int64_t i) override {
    const auto from = there(values);
    return exec_.value(from.view(), i);
  }
  std::vector<uint64_t> for_each(int64_t count) override {
    auto out = exec_.template make<uint64_t>(count);
    exec_.for_each("write random", count, WriteRandom{out.view()});
    return here(out);
  }
  std::vector<int64_t> exclusive_scan(std::vector<int64_t> counts, int64_t& total) override {
    return scanned(counts, total);
  }
  std::vector<uint32_t> exclusive_scan(std::vector<uint32_t> counts, uint32_t& total) override {
    return scanned(counts, total);
  }
  std::vector<int64_t> exclusive_scan_of(int64_t count, int64_t& total) override {
    auto out = exec_.template make<int64_t>(count + 1);
    total = exec_.exclusive_scan_of(count, CentredRest{}, out.view());
    return here(out);
  }
  std::vector<int64_t> inclusive_scan(std::vector<int64_t> counts) override { return scanned(counts); }
  std::vector<uint32_t> inclusive_scan(std::vector<uint32_t> counts) override { return scanned(counts); }
  std::vector<uint64_t> sort(std::vector<uint64_t> keys) override { return sorted(keys, Smaller<uint64_t>()); }
  std::vector<uint32_t> sort(std::vector<uint32_t> keys) override { return sorted(keys, Smaller<uint32_t>()); }
  std::vector<uint64_t> sort_descending(std::vector<uint64_t> keys) override { return sorted(keys, Larger()); }
  std::vector<OddKey> sort(std::vector<OddKey> keys) override { return sorted(keys, OddKeyOrder()); }
  std::vector<uint32_t> select(int64_t count, uint64_t modulus) override {
    const auto out = exec_.select(count, RandomMultiple{modulus});
    return here(out);
  }
  int64_t sum(int64_t count) override { return exec_.sum(count, CentredRest{}); }
  std::vector<int64_t> sum_into(int64_t count) override {
    auto out = exec_.template make<int64_t>(3);
    exec_.fill(out.view(), int64_t(-1));
    exec_.sum_into(out.view().part(1, 1), count, CentredRest{});
    return here(out);
  }
  std::vector<uint64_t> canary(const std::vector<CanaryOperands>& cases) override {
    const auto operands = there(cases);
    auto out = exec_.template make<uint64_t>(operands.size());
    exec_.for_each("canary", operands.size(), CanaryStep{operands.view(), out.view()});
    return here(out);
  }

  int64_t write_and_sum(int64_t count) override {
    auto bytes = exec_.template make<uint8_t>(count);
    exec_.for_each("write bytes", count, WriteBytes{bytes.view()});
    const Buffer<uint8_t>& written = bytes;
    return exec_.sum(count, ByteAt{written.view()});
  }
  std::vector<int64_t> scan_ones(int64_t count, const std::vector<int64_t>& at) override {
    auto ones = exec_.template make<int64_t>(count);
    exec_.fill(ones.view(), int64_t(1));
    const int64_t total = exec_.exclusive_scan(ones.view());
    std::vector<int64_t> out;
    const Buffer<int64_t>& scanned = ones;
    for (int64_t i : at) out.push_back(exec_.value(scanned.view(), i));
    out.push_back(total);
    return out;
  }
  std::vector<uint64_t> sort_reversed(int64_t count, const std::vector<int64_t>& at) override {
    auto keys = exec_.template make<uint64_t>(count);
    exec_.for_each("write reversed", count, WriteReversed{keys.view()});
    exec_.sort(keys.view());
    std::vector<uint64_t> out;
    const Buffer<uint64_t>& sorted = keys;
    for (int64_t i : at) out.push_back(exec_.value(sorted.view(), i));
    return out;
  }
  std::vector<int64_t> select_multiples(int64_t count, int64_t modulus) override {
    const Buffer<uint32_t> kept = exec_.select(count, LastOfEach{modulus});
    return {kept.size(), kept.empty() ? -1 : int64_t(exec_.value(kept.view(), kept.size() - 1))};
  }

 private:
  template <class T>
  static std::vector<T> here(const Buffer<T>& buffer) {
    const Buffer<T> copy = buffer.to_host();
    return {copy.begin(), copy.end()};
  }
  template <class T>
  Buffer<T> there(const std::vector<T>& values) {
    Buffer<T> copy(int64_t(values.size()));
    std::copy(values.begin(), values.end(), copy.begin());
    return to_executor(exec_, std::move(copy));
  }

  template <class T>
  std::vector<T> scanned(const std::vector<T>& counts, T& total) {
    auto buffer = there(counts);
    total = exec_.exclusive_scan(buffer.view());
    return here(buffer);
  }
  template <class T>
  std::vector<T> scanned(const std::vector<T>& counts) {
    auto buffer = there(counts);
    exec_.inclusive_scan(buffer.view());
    return here(buffer);
  }
  template <class T, class Less>
  std::vector<T> sorted(const std::vector<T>& keys, Less less) {
    auto buffer = there(keys);
    exec_.sort(buffer.view(), less);
    return here(buffer);
  }

  Executor exec_;
};

}  // namespace isoshell::parity
