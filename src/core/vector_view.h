// Vectors as views.
#pragma once

#include <vector>

#include "isoshell/advanced/buffer.h"

namespace isoshell {

template <class T>
View<const T> view_of(const std::vector<T>& values) {
  return {values.data(), int64_t(values.size())};
}

}  // namespace isoshell
