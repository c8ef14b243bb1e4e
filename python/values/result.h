// The mesh of a run and all that is known of it.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>
#include <string>
#include <vector>

#include "isoshell/run/run.h"

namespace isoshell::python {

/// A RunResult as Python has it: it can be pickled, and its record is the statistics alone.
struct MadeResult {
  TriangleMesh mesh;
  std::string statistics;  ///< JSON
  std::vector<std::string> gates, missed_gates;
  std::string frame_note;                          ///< of a frame of a sequence: MeshWriteOptions::made_of
  std::shared_ptr<const LevelSet> level_set = {};  ///< where it was kept; not pickled
};

MadeResult made_of(RunResult result);

void bind_result(nanobind::module_& m);

}  // namespace isoshell::python
