// The same digests whatever the threads, the order of the faces or the backend.
#include "golden/golden_cases.h"
#include "support/catch.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

template <class Case>
std::string run_with_threads(const Case& c, int threads) {
  TestContext context;
  context.threads = threads;
  return golden::run(c, context);
}

}  // namespace

TEST_CASE("parity: one thread and several give the same products", "[parity]") {
  for (const golden::Case& c : golden::cases()) {
    const std::string one = run_with_threads(c, 1);
    CHECK(run_with_threads(c, 2) == one);
    CHECK(run_with_threads(c, 5) == one);
  }
}

TEST_CASE("parity: one thread and several give the same files of whole runs with default options", "[parity]") {
  for (const golden::RunCase& c : golden::run_cases()) CHECK(run_with_threads(c, 1) == run_with_threads(c, 3));
}

TEST_CASE("parity: the order of faces and vertices in the input does not matter", "[parity]") {
  for (golden::Case c : golden::cases()) {
    const std::string as_given = run_with_threads(c, 2);
    const TriangleSoup other = shapes::shuffled(c.shape(), 5);
    c.shape = [&] { return other; };
    CHECK(run_with_threads(c, 2) == as_given);
  }
}
