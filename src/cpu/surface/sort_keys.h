// Keys of two vertices by buckets of the first one.
#pragma once

#include "core/buckets.h"
#include "cpu/executor_tbb.h"
#include "stages/surface/soup_keys.h"

namespace isoshell {

struct CpuSortKeys {
  static void run(CpuExecutor& exec, View<KeyedIndex> keys, int64_t numbers) {
    const Buckets<Key> sorted = sort_into_buckets<Key>(
        numbers, keys.size, [&](int64_t i, auto put) { put(int64_t(keys[i].key >> 32), Key{keys[i]}); });
    exec.for_each("sorted keys", keys.size, [&](int64_t i) { keys[i] = sorted.items[i]; });
  }

 private:
  struct Key : KeyedIndex {
    bool operator<(const Key& other) const { return KeyedLess{}(*this, other); }
  };
};

}  // namespace isoshell
