// Arrays as bytes of a pickled value.
#pragma once

#include <nanobind/nanobind.h>

#include <cstring>
#include <string>
#include <type_traits>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "isoshell/error.h"

namespace isoshell::python {

/// Throws: usage.
[[noreturn]] inline void refuse_state(const std::string& type) {
  throw Error(ErrorCode::usage, "arguments", "this is no pickled " + type + " of this version");
}

template <class T>
nanobind::bytes packed(const T* values, size_t count) {
  static_assert(std::is_trivially_copyable_v<T>);
  return nanobind::bytes(static_cast<const void*>(values), count * sizeof(T));
}
template <class T>
nanobind::bytes packed(const std::vector<T>& values) {
  return packed(values.data(), values.size());
}

template <class T>
nanobind::bytes packed(const Buffer<T>& values) {
  return packed(values.data(), size_t(values.size()));
}

/// Throws: usage for bytes that are no whole number of them; `type` is what was pickled.
template <class T>
std::vector<T> unpacked(nanobind::handle state, const char* type = "isoshell.Result") {
  const auto bytes = nanobind::cast<nanobind::bytes>(state);
  if (bytes.size() % sizeof(T) != 0) refuse_state(type);
  std::vector<T> values(bytes.size() / sizeof(T));
  if (!values.empty()) std::memcpy(static_cast<void*>(values.data()), bytes.c_str(), bytes.size());
  return values;
}

}  // namespace isoshell::python
