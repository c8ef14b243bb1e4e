#include "vdb_isomesh/command.h"

#include <exception>
#include <new>

#include "isoshell/advanced/own_thread.h"
#include "isoshell/error.h"
#include "vdb_isomesh/interrupt.h"
#include "vdb_isomesh/streams.h"

namespace isoshell::tool {
namespace {

Context& context = *new Context;  // without an end, as signals that cancel it may come until that of the process
Program program;

int run_command(int argc, const char* const* argv, const WriteReport& write_report) {
  const CommandLine command = parse_command_line(argc, argv, program);
  if (!command.run) {
    print(command.text);
    return 0;
  }
  const Arguments& a = *command.run;
  if (!a.run.report.empty() && !write_report)
    throw Error(ErrorCode::usage, "command line",
                "--report is made by the Python module: pip install 'isoshell[report]', then isoshell INPUT OUTPUT "
                "--report FILE.html, with the same options");
  Console console(a.progress, a.verbosity, program.name.c_str());
  context.backend = a.backend;
  context.device = a.device;
  context.threads = a.threads;
  context.memory_limit_bytes = a.max_memory_bytes;
  return run(a, context, console, write_report);
}

int report(ErrorCode code, const char* message) {
  Console(ProgressMode::never, 0, program.name.c_str()).error(message);
  return int(code);
}

}  // namespace

int command(int argc, const char* const* argv, const WriteReport& write_report, const Program& front) {
  fill_closed_streams();
  program = front;
  answer_signals(context, program.name);
  try {
    return on_own_thread([&] { return run_command(argc, argv, write_report); });
  } catch (const Error& e) {
    return report(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return report(ErrorCode::out_of_memory, "out of memory; free some, split the input, or lower --resolution");
  } catch (const std::exception& e) {
    return report(ErrorCode::internal, e.what());
  }
}

}  // namespace isoshell::tool
