// main() of every test executable, for Catch2 2 and 3. With --cuda the stages of the same tests run on the device, and
// without one the tests report skipped.
#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif

#include <cstdio>
#include <cstring>
#include <vector>

#include "isoshell/error.h"
#include "support/test_context.h"

namespace {

constexpr int kSkipped = 77;

bool device_is_there() {
  try {
    isoshell::backend_name(isoshell::TestContext());
    return true;
  } catch (const isoshell::Error& e) {
    std::printf("skipped: %s\n", e.what());
    return false;
  }
}

}  // namespace

int main(int argc, char* argv[]) {
  std::vector<const char*> arguments;
  for (int i = 0; i < argc; ++i) {
    if (std::strcmp(argv[i], "--cuda") == 0)
      isoshell::test_backend() = isoshell::Backend::cuda;
    else
      arguments.push_back(argv[i]);
  }
  if (!device_is_there()) return kSkipped;
  return Catch::Session().run(int(arguments.size()), arguments.data()) == 0 ? 0 : 1;
}
