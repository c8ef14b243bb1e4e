#include "vdb_meshinfo/command.h"

#include <exception>
#include <functional>
#include <new>
#include <optional>
#include <utility>

#include "isoshell/advanced/own_thread.h"
#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/io/output_files.h"
#include "vdb_isomesh/console.h"
#include "vdb_isomesh/interrupt.h"
#include "vdb_isomesh/memory.h"
#include "vdb_isomesh/streams.h"
#include "vdb_meshinfo/args.h"
#include "vdb_meshinfo/table.h"

namespace isoshell::tool {
namespace {

Context& context = *new Context;  // without an end, as signals that cancel it may come until that of the process
std::string program;

/// Before anything is read.
void check_files(const MeshInfoArguments& a) {
  const auto& reference = a.request.reference;
  const std::string table = a.statistics != "-" && !a.quiet ? "-" : "";
  check_output_files({{"--stats", a.statistics}, {"the table", table}},
                     {{"MESH", a.request.mesh.path}, {"--ref", reference ? reference->path : ""}}, a.overwrite);
}

void write_statistics(const MeshInfoArguments& a, const MeshInfo& info) {
  std::optional<WhileWriting> writing;
  if (a.statistics != "-") writing.emplace();  // standard output cannot be left in order
  write_mesh_info(a.statistics, info, a.overwrite);
}

Input read(const InputRequest& request, const ReadOther& read_other, const Tell& tell) {
  std::optional<Input> other;
  if (read_other && !find_format(request.format)) other = read_other(request, context, tell);
  return other ? std::move(*other) : read_input(request, context, tell);
}

int run_command(int argc, const char* const* argv, const ReadOther& read_other, const MeshInfoProgram& front) {
  const MeshInfoCommandLine command = parse_mesh_info(argc, argv, front);
  if (!command.arguments) {
    print(command.text);
    return 0;
  }
  const MeshInfoArguments& a = *command.arguments;
  Console console(ProgressMode::automatic, a.quiet ? 0 : 1, program.c_str());
  context.backend = Backend::cpu;
  context.threads = a.threads;
  context.memory_limit_bytes = a.max_memory_bytes > 0 ? a.max_memory_bytes : default_memory_limit_bytes();
  check_files(a);
  const Tell tell = [&](MessageKind kind, const std::string& text) {
    kind == MessageKind::warning ? console.warn(text) : console.detail(text);
  };
  const auto reader_of = [&](const InputRequest& request) { return [&] { return read(request, read_other, tell); }; };
  std::function<Input()> read_reference;
  if (a.request.reference) read_reference = reader_of(*a.request.reference);
  const MeshInfo info = mesh_info(reader_of(a.request.mesh), read_reference, a.request.gates, context,
                                  [&](const Progress& progress) { console.progress(progress); });
  if (!a.statistics.empty()) write_statistics(a, info);
  if (a.statistics != "-" && !a.quiet) print(mesh_info_table(info));
  for (const std::string& text : info.missed_gates) console.error("gate failed: " + text);
  return info.missed_gates.empty() ? 0 : int(ErrorCode::gate_failed);
}

int report(ErrorCode code, const char* message) {
  Console(ProgressMode::never, 0, program.c_str()).error(message);
  return int(code);
}

}  // namespace

int mesh_info_command(int argc, const char* const* argv, const ReadOther& read_other, const MeshInfoProgram& front) {
  fill_closed_streams();
  program = front.name;
  answer_signals(context, program);
  try {
    return on_own_thread([&] { return run_command(argc, argv, read_other, front); });
  } catch (const Error& e) {
    return report(e.code(), e.what());
  } catch (const std::bad_alloc&) {
    return report(ErrorCode::out_of_memory, "out of memory; the mesh is too large for this machine");
  } catch (const std::exception& e) {
    return report(ErrorCode::internal, e.what());
  }
}

}  // namespace isoshell::tool
