// A last word where a library cannot start its threads.
#include "vdb_isomesh/missing_threads.h"

#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <system_error>

#include "isoshell/error.h"

namespace isoshell::tool {
namespace {

const char* speaker = "";
std::terminate_handler otherwise = nullptr;

bool lacks_threads() {
  const std::exception_ptr thrown = std::current_exception();
  if (!thrown) return false;
  try {
    std::rethrow_exception(thrown);
  } catch (const std::system_error& error) {
    return error.code().value() == EAGAIN;
  } catch (...) {
    return false;
  }
}

[[noreturn]] void end() {
  if (!lacks_threads()) {
    otherwise();
    std::abort();
  }
  constexpr char kText[] = ": error: the system gives no more threads; raise the limit of processes (ulimit -u)\n";
  if (write(STDERR_FILENO, speaker, std::strlen(speaker)) < 0 ||
      write(STDERR_FILENO, kText, sizeof kText - 1) < 0) {  // nobody to tell
  }
  _exit(int(ErrorCode::out_of_memory));
}

}  // namespace

void answer_missing_threads(const char* program) {
  speaker = program;
  otherwise = std::set_terminate(end);
}

}  // namespace isoshell::tool
