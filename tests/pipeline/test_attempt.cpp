#include "pipeline/grid/attempt.h"
#include "support/catch.h"

using namespace isoshell;

TEST_CASE("attempt: want of room is a reason to try another way", "[attempt]") {
  CHECK(failure_reason([]() -> std::string { throw NoRoom("seeds", "too many seeds"); }) == "too many seeds");
  CHECK(failure_reason([] { return std::string("too narrow"); }) == "too narrow");
  CHECK(failure_reason([] { return std::string(); }).empty());
}

TEST_CASE("attempt: a caller's mistake stays an error", "[attempt]") {
  const auto mistake = []() -> std::string { throw Error(ErrorCode::usage, "dual", "a border is not fixed"); };
  CHECK_THROWS_AS(failure_reason(mistake), Error);
}
