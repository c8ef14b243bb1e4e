// Inputs by their names.
#include "isoshell/io/input.h"

#include <algorithm>
#include <utility>

#include "core/file_format.h"
#include "io/input_reader.h"
#include "io/vdb/stage_reader.h"
#include "isoshell/error.h"
#include "isoshell/io/vdb_file.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse_use(const std::string& message) { throw Error(ErrorCode::usage, "read", message); }

}  // namespace

const char* kind_name(InputKind kind) {
  switch (kind) {
    case InputKind::mesh:
      return "mesh";
    case InputKind::points:
      return "points";
    case InputKind::volume:
      return "volume";
    case InputKind::labels:
      return "labels";
    case InputKind::stage:
      return "stage";
  }
  return "";
}

InputRequest named_input(const std::string& name, const std::string& format) {
  InputRequest request;
  request.format = format;
  return named_input(name, std::move(request));
}

InputRequest named_input(const std::string& name, InputRequest request) {
  request.path = name;
  request.format = format_name(request.format);
  request.grid.clear();
  const size_t slash = name.find_last_of('/'), start = slash == std::string::npos ? 0 : slash;
  const size_t colon = name.find(".vdb:", start), nano_colon = name.find(".nvdb:", start);
  const size_t at = std::min(colon == std::string::npos ? colon : colon + 4,
                             nano_colon == std::string::npos ? nano_colon : nano_colon + 5);
  if (at != std::string::npos) {
    request.grid = name.substr(at + 1);
    request.path.resize(at);
    if (request.grid.empty()) refuse_use("INPUT names no grid behind its colon");
  }
  if (request.path == "-" && request.format.empty())
    refuse_use("INPUT is standard input; say what it holds by --input-format");
  if (request.format.empty()) request.format = format_of_path(request.path);
  return request;
}

StageFile read_stage(const std::string& path) {
  ReadingBudget no_limit;
  return read_stage(MeshSource(path, no_limit));
}

Input read_input(const InputRequest& request, const Context& context, const Tell& tell) {
  InputReader reader(request.path, context, tell);
  reader.read(request);
  return reader.taken();
}

Input read_input(const InputRequest& request, int64_t memory_limit_bytes, const Tell& tell) {
  Context context;
  context.memory_limit_bytes = memory_limit_bytes;
  return read_input(request, context, tell);
}

}  // namespace isoshell
