// What a run starts from: a file, or what was copied or borrowed from arrays.
#pragma once

#include <nanobind/nanobind.h>

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/previous_frame.h"
#include "isoshell/run/run.h"

namespace isoshell::python {

/// Makes the input of what is in memory.
using ReadMemory = std::function<Input(const RunRequest&, const Context&)>;

struct Source {
  std::string path;                           ///< of a file; empty: of memory
  ReadMemory read;                            ///< of memory: once, on the thread of the run; empty: of a file
  nanobind::object kept;                      ///< whose memory is borrowed meanwhile
  std::shared_ptr<const SizingField> sizing;  ///< edge lengths that were given as an array; null: none were
  /// Where the surface goes until the next frame, once that has been read; empty: no array says it.
  std::function<std::shared_ptr<const VelocityField>()> velocity = {};

  std::shared_ptr<TriangleSoup> surface = {};                ///< of a mesh in memory, until a run takes it
  std::vector<std::string> also = {};                        ///< of level sets more files, beside that of the path
  std::vector<std::shared_ptr<const GridField>> grids = {};  ///< whose values vertices of the result get

  bool is_file() const { return !read; }
};

/// By `read`, or the file of the request where it is empty.
Input input_of_run(const ReadMemory& read, const RunRequest& request, const Context& context);

/// The run of that input.
RunResult run_from(const ReadMemory& read, const RunRequest& request, Context& context);

/// Source, with a way to make one of each kind.
void bind_source(nanobind::module_& m);

}  // namespace isoshell::python
