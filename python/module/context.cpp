#include "module/context.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/vector.h>

#include "isoshell/error.h"
#include "values/text.h"

namespace nb = nanobind;

namespace isoshell::python {

Place::Place(const Keywords& keywords) : settings_(arguments_of(keywords, "")) { renew(); }

void Place::renew() {
  context_ = std::make_shared<Context>();
  context_->backend = settings_.backend;
  context_->device = settings_.device;
  context_->threads = settings_.threads;
}

void Place::close() {
  const Lease last(*this);
  renew();
}

Place::Lease::Lease(Place& place) : place_(&place) {
  if (place.busy_.exchange(true))
    throw Error(ErrorCode::usage, "context", "the context is at work already; give each thread one of its own");
  place.context_->cancel = false;
  place.context_->memory_limit_bytes = place.settings_.max_memory_bytes;  // 0: by what is free when the run begins
}

void bind_context(nb::module_& m) {
  m.def(
      "memory_limit", [](const Keywords& keywords) { return arguments_of(keywords, "").max_memory_bytes; },
      nb::arg("keywords"), "The option max_memory in bytes; 0 without it.");
  nb::class_<Place>(m, "Place", "The device, threads and memory of runs, one at a time.")
      .def(nb::init<const Keywords&>(), nb::arg("keywords"))
      .def_prop_ro("max_bytes", &Place::max_memory_bytes)
      .def("cancel", &Place::cancel)
      .def("close", &Place::close);
}

}  // namespace isoshell::python
