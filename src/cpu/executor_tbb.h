// The CPU executors: exec/executor.h over TBB, and the set of kernels that bodies call.
#pragma once

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <functional>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "cpu/cpu_kernels.h"
#include "isoshell/advanced/buffer.h"

namespace isoshell {

/// What both executors of the CPU have in common. Runs under the context's thread limit.
class TbbExecutor {
 public:
  /// Passes of a loop that are enqueued before its state is read: no read costs anything here.
  static constexpr int kPassBatch = 1;

  Context& context() { return context_; }

  template <class T>
  Buffer<T> make(int64_t count) {
    return Buffer<T>(count);
  }

  template <class T>
  void fill(View<T> out, T value) {
    for_each("fill", out.size, [=](int64_t i) { out[i] = value; });
  }

  template <class T>
  void copy(View<const T> from, View<T> to) {
    for_each("copy", from.size, [=](int64_t i) { to[i] = from[i]; });
  }

  template <class T>
  T value(View<const T> values, int64_t i) {
    return values[i];
  }

  template <class Step>
  void for_each(const char*, int64_t count, Step step) {
    check_cancel(context_, stage_);
    for_ranges(count, grain(count), [&](int64_t begin, int64_t end) {
      if (context_.cancel.load(std::memory_order_relaxed)) return;
      for (int64_t i = begin; i < end; ++i) step(i);
    });
    check_cancel(context_, stage_);
  }

  template <class T>
  T exclusive_scan(View<T> counts) {
    check_cancel(context_, stage_);
    T total = 0;
    for (T& c : counts) {
      const T here = c;
      c = total;
      total += here;
    }
    return total;
  }

  template <class T, class Term>
  T exclusive_scan_of(int64_t count, Term term, View<T> out) {
    for_each("terms", count, [=](int64_t i) { out[i] = T(term(i)); });
    const T total = exclusive_scan(out.part(0, count));
    if (out.size > count) out[count] = total;
    return total;
  }

  template <class T>
  void inclusive_scan(View<T> counts) {
    check_cancel(context_, stage_);
    T total = 0;
    for (T& c : counts) c = total += c;
  }

  template <class T, class Less = std::less<T>>
  void sort(View<T> keys, Less less = {}) {
    check_cancel(context_, stage_);
    tbb::parallel_sort(keys.begin(), keys.end(), less);
  }

  template <class Term>
  int64_t sum(int64_t count, Term term) {
    check_cancel(context_, stage_);
    return sum_over_ranges(count, grain(count), [&](int64_t begin, int64_t end) {
      int64_t part = 0;
      for (int64_t i = begin; i < end; ++i) part += term(i);
      return part;
    });
  }

  template <class Term>
  void sum_into(View<int64_t> out, int64_t count, Term term) {
    out[0] = sum(count, term);
  }

  template <class Keep>
  Buffer<uint32_t> select(int64_t count, Keep keep) {
    constexpr int64_t kChunk = 4096;
    const int64_t chunks = (count + kChunk - 1) / kChunk;
    Buffer<int64_t> start(chunks);
    for_each("count kept", chunks, [&](int64_t c) {
      int64_t kept = 0;
      for (int64_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i) kept += keep(i) ? 1 : 0;
      start[c] = kept;
    });
    Buffer<uint32_t> out(exclusive_scan(start.view()));
    for_each("compact kept", chunks, [&](int64_t c) {
      int64_t at = start[c];
      for (int64_t i = c * kChunk; i < std::min(count, (c + 1) * kChunk); ++i)
        if (keep(i)) out[at++] = uint32_t(i);
    });
    return out;
  }

 protected:
  TbbExecutor(Context& context, const char* stage) : context_(context), stage_(stage) {}

 private:
  // Enough pieces for balance, few enough that small steps are not all overhead.
  static int64_t grain(int64_t count) { return std::clamp<int64_t>(count / 64, 1, 1024); }

  Context& context_;
  const char* stage_;
};

/// One executor per stage call. Its set is part of its type, and so of the type of every body that runs on it.
template <class Set>
class TbbExecutorWith : public TbbExecutor {
 public:
  using Kernels = Set;
  TbbExecutorWith(Context& context, const char* stage) : TbbExecutor(context, stage) {}
};

using CpuExecutor = TbbExecutorWith<CpuKernels>;
using PlainExecutor = TbbExecutorWith<PlainKernels>;

}  // namespace isoshell
