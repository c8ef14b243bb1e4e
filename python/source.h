// What a run starts from: a file, or what was copied or borrowed from arrays.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <memory>
#include <string>

#include "isoshell/run/run.h"

namespace isoshell::python {

struct Source {
  std::string path;  ///< of a file; empty: of memory
  /// Of memory: makes the input, once, on the thread of the run.
  std::function<Input(const RunRequest&, const Context&)> read;
  nanobind::object kept;                      ///< whose memory is borrowed meanwhile
  std::shared_ptr<const SizingField> sizing;  ///< edge lengths that were given as an array; null: none were

  bool is_file() const { return !read; }
};

/// Source, with a way to make one of each kind.
void bind_source(nanobind::module_& m);

}  // namespace isoshell::python
