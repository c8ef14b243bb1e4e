// Vectors as views and buffers.
#pragma once

#include <algorithm>
#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

template <class T>
View<const T> view_of(const std::vector<T>& values) {
  return {values.data(), int64_t(values.size())};
}

template <class T>
Buffer<T> buffer_of(const std::vector<T>& values) {
  Buffer<T> out(int64_t(values.size()));
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

}  // namespace isoshell
