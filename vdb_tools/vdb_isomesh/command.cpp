#include "vdb_isomesh/command.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <exception>
#include <new>

#include "isoshell/error.h"
#include "vdb_isomesh/interrupt.h"
#include "vdb_isomesh/run.h"

namespace isoshell::tool {
namespace {

Context context;

void print(const std::string& text) {
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size() || std::fflush(stdout) != 0)
    throw Error(ErrorCode::unwritable_output, "write", std::string("standard output: ") + std::strerror(errno));
}

int run_command(int argc, const char* const* argv) {
  const CommandLine command = parse_command_line(argc, argv);
  if (!command.run) {
    print(command.text);
    return 0;
  }
  const Arguments& a = *command.run;
  Console console(a.progress, a.verbosity);
  context.backend = a.backend;
  context.device = a.device;
  context.threads = a.threads;
  context.memory_limit_bytes = a.max_memory_bytes;
  context.progress = [&](const char* stage, double fraction) { console.progress(stage, fraction); };
  return run(a, context, console);
}

int report(ErrorCode code, const char* message) {
  Console(ProgressMode::never, 0).error(message);
  return int(code);
}

}  // namespace

int command(int argc, const char* const* argv) {
  answer_signals(context);
  try {
    return run_command(argc, argv);
  } catch (const Error& e) {
    return report(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return report(ErrorCode::out_of_memory, "out of memory; lower --resolution");
  } catch (const std::exception& e) {
    return report(ErrorCode::internal, e.what());
  }
}

}  // namespace isoshell::tool
