// Counts and digests equal to the stored ones, on whichever backend is present.
#include <fstream>
#include <sstream>

#include "golden/golden_cases.h"
#include "support/catch.h"
#include "support/source_folder.h"
#include "support/test_context.h"

using namespace isoshell;

TEST_CASE("golden: every product of every case is the stored one", "[golden]") {
  std::ifstream file(source_folder() + "/tests/golden/golden.txt");
  REQUIRE(file.good());
  std::stringstream stored;
  stored << file.rdbuf();
  TestContext context;
  const std::string got = golden::all(context);
  // A change that is meant: run the update_golden program and say in CHANGELOG, Results, why the new value is right.
  CHECK(got == stored.str());
}
