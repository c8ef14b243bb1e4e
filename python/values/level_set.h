// Level sets as arrays.
#pragma once

#include <nanobind/nanobind.h>

#include <memory>

#include "isoshell/advanced/level_set.h"

namespace isoshell::python {

/// A level set in host memory; never null.
struct MadeLevelSet {
  std::shared_ptr<const LevelSet> set;
};

void bind_level_set(nanobind::module_& m);

}  // namespace isoshell::python
