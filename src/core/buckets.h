// Items by bucket and ascending in each: what one sort of all gives, faster where buckets are small.
#pragma once

#include <algorithm>

#include "core/parallel_ranges.h"
#include "isoshell/advanced/buffer.h"
#include "voxel/atomic.h"

namespace isoshell {

template <class T, class Offset = int64_t>
struct Buckets {
  Buffer<Offset> first;  ///< count + 1 offsets into items
  Buffer<T> items;

  int64_t count() const { return first.size() - 1; }
  View<const T> in(int64_t bucket) const { return items.view().part(first[bucket], first[bucket + 1] - first[bucket]); }
};

/// Turns counts per bucket, and one more, into offsets.
inline void offsets_from_counts(View<int64_t> counts) {
  int64_t total = 0;
  for (int64_t& c : counts) {
    const int64_t here = c;
    c = total;
    total += here;
  }
}

/// `list(i, put)` calls put(bucket, item) for the items of source i, the same ones whenever it is called. Equal items
/// are not told apart, and `Offset` counts them all. Cost: O(items), and a sort of each bucket.
template <class T, class Offset = int64_t, class List>
Buckets<T, Offset> sort_into_buckets(int64_t buckets, int64_t sources, List list) {
  Buckets<T, Offset> out;
  out.first = Buffer<Offset>(buckets + 1);
  std::fill(out.first.begin(), out.first.end(), Offset(0));
  const bool is_alone = loops_run_alone();  // atomics cost more than all the rest
  const auto add = [&](int64_t bucket, Offset more) {
    Offset& first = out.first[bucket];
    return is_alone ? first += more : __atomic_add_fetch(&first, more, __ATOMIC_RELAXED);
  };
  // From the last one on: buckets that are filled from their ends then are nearly in the order of sources.
  const auto for_each_source = [&](auto put) {
    for_each_index(int64_t(0), sources, [&](int64_t i) { list(sources - 1 - i, put); });
  };
  for_each_source([&](int64_t bucket, const T&) { add(bucket, 1); });
  Offset total = 0;
  for (Offset& f : out.first) f = total += f;  // where buckets end, until they are filled from there on
  out.items = Buffer<T>(int64_t(total));
  for_each_source([&](int64_t bucket, const T& item) { out.items[add(bucket, Offset(-1))] = item; });
  for_each_index(int64_t(0), buckets,
                 [&](int64_t b) { std::sort(out.items.begin() + out.first[b], out.items.begin() + out.first[b + 1]); });
  return out;
}

/// Leaves every item once in its bucket.
template <class T>
Buckets<T> without_repeats(const Buckets<T>& all) {
  Buckets<T> out;
  out.first = Buffer<int64_t>(all.first.size());
  out.first[all.count()] = 0;
  for_each_index(int64_t(0), all.count(), [&](int64_t b) {
    const View<const T> in = all.in(b);
    int64_t count = 0;
    for (int64_t i = 0; i < in.size; ++i) count += i == 0 || in[i - 1] < in[i] ? 1 : 0;
    out.first[b] = count;
  });
  offsets_from_counts(out.first.view());
  out.items = Buffer<T>(out.first[all.count()]);
  for_each_index(int64_t(0), all.count(), [&](int64_t b) {
    const View<const T> in = all.in(b);
    std::unique_copy(in.begin(), in.end(), out.items.begin() + out.first[b]);
  });
  return out;
}

}  // namespace isoshell
