#include "values/device_arrays.h"

#include <nanobind/ndarray.h>

#include <algorithm>
#include <cstddef>
#include <future>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/advanced/device_memory.h"
#include "isoshell/device_info.h"
#include "isoshell/error.h"
#include "values/arrays.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {
namespace {

using DeviceArray = nb::ndarray<nb::ro>;

/// On a thread of its own, since the device of the calling one is its program's to choose.
template <class Work>
auto elsewhere(Work work) {
  const nb::gil_scoped_release released;
  return std::async(std::launch::async, work).get();
}

/// Why arrays of this CUDA device cannot be read; empty when they can.
std::string why_not_readable(int device) {
  return elsewhere([device]() -> std::string {
    Context context;
    context.backend = Backend::cuda;
    context.device = device;
    try {
      device_info(context);
    } catch (const Error& e) {
      return e.what();
    }
    return "";
  });
}

/// Where the values of an array begin and end, counted in values from data().
struct Span {
  int64_t begin = 0, end = 0;
};
Span span_of(const DeviceArray& a) {
  Span span{0, 1};
  for (size_t i = 0; i < a.ndim(); ++i) {
    const auto last = (int64_t(a.shape(i)) - 1) * a.stride(i);
    if (a.shape(i) == 0) return {};
    span.begin += std::min<int64_t>(0, last);
    span.end += std::max<int64_t>(0, last);
  }
  return span;
}

/// An array of the host with the values, and the strides, of one whose work the legacy default stream waits for: what
/// lies between its first and its last value is copied at once.
nb::object copied(const DeviceArray& a) {
  const auto item = int64_t(a.itemsize());
  const Span span = span_of(a);
  auto kept = std::make_unique<std::vector<std::byte>>(size_t((span.end - span.begin) * item));
  elsewhere([&] {
    copy_from_device(kept->data(), static_cast<const std::byte*>(a.data()) + span.begin * item, int64_t(kept->size()),
                     a.device_id());
  });
  std::vector<size_t> shape;
  std::vector<int64_t> strides;
  for (size_t i = 0; i < a.ndim(); ++i) {
    shape.push_back(a.shape(i));
    strides.push_back(a.stride(i));
  }
  std::byte* const data = kept->data() - span.begin * item;
  const nb::capsule owner = owner_of(std::move(kept));
  return nb::cast(nb::ndarray<nb::numpy>(data, shape.size(), shape.data(), owner, strides.data(), a.dtype()));
}

}  // namespace

void bind_device_arrays(nb::module_& m) {
  m.def("why_not_readable", why_not_readable, nb::arg("device"),
        "Why arrays of this CUDA device cannot be read; empty when they can.");
  m.def("copied_from_device", copied, nb::arg("capsule"),
        nb::sig("def copied_from_device(capsule: typing.Any) -> typing.Any"),
        "Of a DLPack capsule of a CUDA device, whose work the legacy default stream waits for, an array of the host.");
}

}  // namespace isoshell::python
