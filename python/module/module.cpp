// The compiled part of the package isoshell: what its Python files, which people see, stand on.
#include <nanobind/nanobind.h>

#include "isoshell/version.h"
#include "module/context.h"
#include "module/many.h"
#include "module/mesh_info.h"
#include "module/report.h"
#include "module/run.h"
#include "module/sequence.h"
#include "module/stages.h"
#include "values/device_arrays.h"
#include "values/errors.h"
#include "values/files.h"
#include "values/keywords.h"
#include "values/labels.h"
#include "values/level_set.h"
#include "values/result.h"
#include "values/source.h"

namespace nb = nanobind;

NB_MODULE(_isoshell, m) {
  using namespace isoshell::python;
  m.attr("VERSION") = ISOSHELL_VERSION;
  bind_errors(m);
  bind_keywords(m);
  bind_files(m);
  bind_device_arrays(m);
  bind_labels(m);
  bind_source(m);
  bind_context(m);
  bind_level_set(m);
  bind_result(m);
  bind_run(m);
  bind_sequence(m);
  bind_many(m);
  bind_stages(m);
  bind_report(m);
  bind_mesh_info(m);
}
