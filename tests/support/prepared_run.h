// A surface prepared where the tests run, and what is said of it.
#pragma once

#include "isoshell/remesh.h"
#include "support/test_context.h"

namespace isoshell {

struct PreparedRun {
  RemeshReport report;
  Prepared prepared;
};

inline PreparedRun prepare_with(const TriangleSoup& soup, const RemeshOptions& options) {
  TestContext context;
  PreparedRun run;
  run.prepared = prepare(soup, options, run.report, context);
  return run;
}

}  // namespace isoshell
