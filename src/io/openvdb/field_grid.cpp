// See field_grid.h.
#include "io/openvdb/field_grid.h"

#include <filesystem>
#include <limits>

#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_names.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

bool is_of(const FieldKind& kind, const VdbGridSpan& span) {
  return !span.instance && (span.type == kind.tree_type || span.type == std::string(kind.tree_type) + "_HalfFloat");
}

std::string list_of(const std::vector<VdbGridSpan>& grids) {
  std::string text;
  for (const VdbGridSpan& span : grids) text += (text.empty() ? "\"" : ", \"") + span.name + "\" (" + span.type + ")";
  return text.empty() ? "none" : text;
}

const VdbGridSpan& choose_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                               const std::vector<VdbGridSpan>& grids) {
  const auto refuse = [&](const std::string& text) {
    throw_unreadable_vdb(path, text + "; " + kind.what_it_is + ". Its grids are: " + list_of(grids));
  };
  const VdbGridSpan* found = nullptr;
  int of_kind = 0;
  for (const VdbGridSpan& span : grids) {
    if (name.empty() ? !is_of(kind, span) : span.name != name) continue;
    if (!found) found = &span;
    ++of_kind;
  }
  if (!found) refuse(name.empty() ? std::string("no grid of ") + kind.type_in_words : "no grid \"" + name + "\"");
  if (!is_of(kind, *found)) refuse("grid \"" + found->name + "\" has type " + found->type);
  if (name.empty() && of_kind > 1)
    refuse(std::string("there are several grids of ") + kind.type_in_words + "; say which by FILE.vdb:NAME");
  return *found;
}

}  // namespace

openvdb::GridBase::ConstPtr read_field_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                                            int64_t max_bytes) {
  const auto check_memory = [&](int64_t bytes) {
    if (max_bytes <= 0 || bytes <= max_bytes) return;
    throw Error(ErrorCode::out_of_memory, "read",
                path + ": has " + std::to_string(bytes >> 20) + " MiB, more than the limit of " +
                    std::to_string(max_bytes >> 20) + " MiB; coarsen " + kind.name + " or raise --max-memory");
  };
  std::error_code failed;
  const auto size = std::filesystem::file_size(path, failed);
  if (!failed) check_memory(int64_t(size));
  try {
    initialize_openvdb();
    const Buffer<char> bytes = read_file_start(path, std::numeric_limits<int64_t>::max());
    const VdbLayout layout = read_vdb_layout(path, bytes.view());
    const std::vector<VdbGridSpan> grids = with_names_apart(layout.grids);
    const VdbGridSpan& chosen = choose_grid(path, name, kind, grids);
    check_memory(bytes.size() + check_vdb_tree(path, bytes.view(), chosen));
    return read_vdb_grid(path, bytes.view(), chosen);
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read", path + ": out of memory; coarsen " + kind.name);
  }
}

}  // namespace isoshell
