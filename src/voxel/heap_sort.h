// Sorting a short list inside one step: insertion while it is cheap, heap sort where lists are long.
#pragma once

#include <cstdint>

#include "isoshell/advanced/host_device.h"

namespace isoshell {

template <class T>
ISOSHELL_HD inline void sift_down(T* a, int64_t root, int64_t count) {
  const T value = a[root];
  for (int64_t child; (child = 2 * root + 1) < count; root = child) {
    if (child + 1 < count && a[child] < a[child + 1]) ++child;
    if (!(value < a[child])) break;
    a[root] = a[child];
  }
  a[root] = value;
}

/// In place, no extra memory. Cost: O(n log n); less when the list is short.
template <class T>
ISOSHELL_HD inline void sort_ascending(T* a, int64_t count) {
  if (count <= 48) {
    for (int64_t i = 1; i < count; ++i) {
      const T value = a[i];
      int64_t j = i;
      for (; j > 0 && value < a[j - 1]; --j) a[j] = a[j - 1];
      a[j] = value;
    }
    return;
  }
  for (int64_t i = count / 2 - 1; i >= 0; --i) sift_down(a, i, count);
  for (int64_t end = count - 1; end > 0; --end) {
    const T largest = a[0];
    a[0] = a[end];
    a[end] = largest;
    sift_down(a, int64_t(0), end);
  }
}

}  // namespace isoshell
