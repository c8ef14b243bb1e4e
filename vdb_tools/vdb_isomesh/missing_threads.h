// A last word where a library cannot start its threads.
#pragma once

namespace isoshell::tool {

/// From now on a process that ends because the system gives it no more threads says so and ends with status 7.
/// `program` is what the word begins with; it lives as long.
void answer_missing_threads(const char* program);

}  // namespace isoshell::tool

/// Has an executable do so before the libraries that it is linked with begin: some start threads then, before main.
#define ISOSHELL_ANSWERS_MISSING_THREADS(PROGRAM)                                            \
  static void answer_before_libraries() { isoshell::tool::answer_missing_threads(PROGRAM); } \
  __attribute__((section(".preinit_array"), used)) static void (*before_libraries)() = answer_before_libraries
