// main() of every test executable, for Catch2 2 and 3. With --cuda the stages of the same tests run on the device, and
// without one the tests report skipped, or with ISOSHELL_NEED_DEVICE=1 in the environment fail. A filter that matches
// no test fails, too: Catch2 3 sees to it, Catch2 2 is asked to.
#if __has_include(<catch2/catch_session.hpp>)
#include <catch2/catch_session.hpp>
#else
#define CATCH_CONFIG_RUNNER
#include <catch2/catch.hpp>
#endif

#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <vector>

#include "isoshell/error.h"
#include "support/test_context.h"

namespace {

constexpr int kSkipped = 77;

/// What to end with at once where there is no device, or 0. Throws whatever else is wrong with it.
int without_device() {
  try {
    isoshell::backend_name(isoshell::TestContext());
    return 0;
  } catch (const isoshell::Error& e) {
    if (e.code() != isoshell::ErrorCode::no_device) throw;
    const char* const needed = std::getenv("ISOSHELL_NEED_DEVICE");
    const bool skipped = !needed || std::strcmp(needed, "1") != 0;
    std::printf("%s: %s\n", skipped ? "skipped" : "failed", e.what());
    return skipped ? kSkipped : 1;
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
#ifdef CATCH_CONFIG_RUNNER
  arguments.insert(arguments.end(), {"--warn", "NoTests"});
#endif
  if (isoshell::test_backend() == isoshell::Backend::cuda) {
    if (const int status = without_device()) return status;
  }
  return Catch::Session().run(int(arguments.size()), arguments.data()) == 0 ? 0 : 1;
}
