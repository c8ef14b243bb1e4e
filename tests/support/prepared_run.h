// A surface prepared where the tests run, and what is said of it.
#pragma once

#include "isoshell/remesh.h"
#include "support/test_context.h"

namespace isoshell {

struct PreparedRun {
  Prepared prepared;
  RemeshReport report = prepared.report();
};

inline PreparedRun prepare_with(const TriangleSoup& soup, const RemeshOptions& options) {
  TestContext context;
  return {prepare(soup, options, context)};
}

}  // namespace isoshell
