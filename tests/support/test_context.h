// The context of tests that run on every backend: on the CPU, or with --cuda on the device.
#pragma once

#include "isoshell/backend.h"

namespace isoshell {

/// Where the tests of this process run. Set once, by main.
inline Backend& test_backend() {
  static Backend backend = Backend::cpu;
  return backend;
}

struct TestContext : Context {
  TestContext() { backend = test_backend(); }
};

}  // namespace isoshell
