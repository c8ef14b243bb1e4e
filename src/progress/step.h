// A step of a run, with its progress.
#pragma once

#include <string>
#include <type_traits>

#include "isoshell/backend.h"
#include "isoshell/error.h"
#include "progress/progress_meter.h"

namespace isoshell {

/// What an interruption of the work throws says that these files were written before; empty: none.
template <class Work>
std::invoke_result_t<Work> naming_written(const std::string& written, Work work) {
  try {
    return work();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::interrupted) throw;
    throw Error(e.code(), e.stage(),
                "interrupted; " + (written.empty() ? "nothing was written" : "written before: " + written));
  }
}

/// Runs work between its progress of 0 and of 1. Throws: interrupted, before it begins; what the work throws.
template <class Work>
std::invoke_result_t<Work> step(const char* name, const Context& context, ProgressMeter& meter, Work work) {
  const auto tell_end = [&] {
    if (context.progress) context.progress(name, 1);
    meter.end(name);
  };
  if (context.cancel) throw Error(ErrorCode::interrupted, name, "interrupted");
  meter.begin(name);
  if (context.progress) context.progress(name, 0);
  if constexpr (std::is_void_v<std::invoke_result_t<Work>>) {
    work();
    tell_end();
  } else {
    auto product = work();
    tell_end();
    return product;
  }
}

}  // namespace isoshell
