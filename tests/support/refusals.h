// What is refused, as values: the error that a call throws, and what its message says.
#pragma once

#include <string>

#include "isoshell/error.h"
#include "support/catch.h"

namespace isoshell {

[[nodiscard]] inline bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}
[[nodiscard]] inline bool says(const Error& error, const std::string& part) { return contains(error.what(), part); }

/// What `work` throws; fails the test when it throws nothing.
template <class Work>
Error error_of(Work work) {
  try {
    work();
  } catch (const Error& error) {
    return error;
  }
  FAIL("nothing was thrown");
  return Error(ErrorCode::internal, "", "");
}

/// The message of the error that `work` throws, whose code must be this one; empty when it throws nothing.
template <class Work>
std::string message_of(ErrorCode code, Work work) {
  try {
    work();
  } catch (const Error& error) {
    CHECK(int(error.code()) == int(code));
    return error.what();
  }
  return "";
}

}  // namespace isoshell
