// The compiled part of the package isoshell: what its Python files, which people see, stand on.
#include <nanobind/nanobind.h>

#include "context.h"
#include "device_arrays.h"
#include "errors.h"
#include "keywords.h"
#include "many.h"
#include "mesh_info.h"
#include "report.h"
#include "result.h"
#include "run.h"
#include "sequence.h"
#include "source.h"
#include "stages.h"

namespace nb = nanobind;

NB_MODULE(_isoshell, m) {
  using namespace isoshell::python;
  m.attr("VERSION") = ISOSHELL_VERSION;
  bind_errors(m);
  bind_keywords(m);
  bind_device_arrays(m);
  bind_source(m);
  bind_context(m);
  bind_result(m);
  bind_run(m);
  bind_sequence(m);
  bind_many(m);
  bind_stages(m);
  bind_report(m);
  bind_mesh_info(m);
}
