// See field_grid.h.
#include "io/openvdb/field_grid.h"

#include "io/openvdb/vdb_grids.h"
#include "io/openvdb/vdb_stream.h"
#include "io/vdb/grid_names.h"
#include "io/vdb/vdb_cursor.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

const VdbGridSpan& choose_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                               const std::vector<VdbGridSpan>& grids) {
  const auto refuse = [&](const std::string& text) {
    throw_unreadable_vdb(path, text + "; " + kind.what_it_is + ". Its grids are: " + list_of(grids));
  };
  const VdbGridSpan* found = nullptr;
  int of_kind = 0;
  for (const VdbGridSpan& span : grids) {
    if (name.empty() ? !is_of_tree(span, kind.tree_type) : span.name != name) continue;
    if (!found) found = &span;
    ++of_kind;
  }
  if (!found) refuse(name.empty() ? std::string("no grid of ") + kind.type_in_words : "no grid \"" + name + "\"");
  if (!is_of_tree(*found, kind.tree_type)) refuse("grid \"" + found->name + "\" has type " + found->type);
  if (name.empty() && of_kind > 1)
    refuse(std::string("there are several grids of ") + kind.type_in_words + "; say which by FILE.vdb:NAME");
  return *found;
}

}  // namespace

bool is_of_tree(const VdbGridSpan& grid, const std::string& tree_type) {
  return !grid.instance && (grid.type == tree_type || grid.type == tree_type + "_HalfFloat");
}

std::string list_of(const std::vector<VdbGridSpan>& grids) {
  std::string text;
  for (const VdbGridSpan& span : grids) text += (text.empty() ? "\"" : ", \"") + span.name + "\" (" + span.type + ")";
  return text.empty() ? "none" : text;
}

openvdb::GridBase::Ptr read_counted_grid(const MeshSource& source, const VdbGridSpan& grid) {
  const View<const char> bytes{source.begin(), source.size()};
  source.take(check_vdb_tree(source.name(), bytes, grid));
  return read_vdb_grid(source.name(), bytes, grid);
}

openvdb::GridBase::ConstPtr read_field_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                                            int64_t max_bytes) {
  try {
    initialize_openvdb();
    ReadingBudget budget(max_bytes);
    const MeshSource source(path, budget);
    const VdbLayout layout = read_vdb_layout(path, {source.begin(), source.size()});
    const std::vector<VdbGridSpan> grids = with_names_apart(layout.grids);
    return read_counted_grid(source, choose_grid(path, name, kind, grids));
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::out_of_memory, "read", path + ": out of memory; coarsen " + kind.name);
  }
}

}  // namespace isoshell
