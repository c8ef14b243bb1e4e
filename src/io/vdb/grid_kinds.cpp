// See grid_kinds.h.
#include "io/vdb/grid_kinds.h"

#include <cstring>

#include "io/vdb/grid_names.h"

namespace isoshell {
namespace {

constexpr char kClass[] = "class";  // OpenVDB's name of this metadata
constexpr char kNanoStart[] = "NanoVDB";
constexpr char kNumberMark = '\x1e';  // behind it OpenVDB numbers grids of the same name

std::string plain_name(const VdbGridSpan& span) { return span.name.substr(0, span.name.find(kNumberMark)); }

/// "Tree_float_5_4_3_HalfFloat" as users know it.
std::string short_type(const std::string& type) {
  const size_t begin = type.find('_') + 1, end = type.find("_5_4_3");
  return end == std::string::npos || begin > end ? type : type.substr(begin, end - begin);
}

VolumeGrid describe(const VdbGridSpan& span) {
  VolumeGrid grid;
  grid.name = plain_name(span);
  grid.type = short_type(span.type);
  const auto found = span.texts.find(kClass);
  grid.grid_class = found == span.texts.end() ? "unknown" : found->second;
  if (span.instance) grid.flaw = "shares the values of another grid; name that one";
  return grid;
}

bool is_integer(const std::string& type) { return type == "int32" || type == "int64"; }

}  // namespace

VolumeGrid as_volume(const VdbGridSpan& span) {
  VolumeGrid grid = describe(span);
  if (!grid.flaw.empty()) return grid;
  if (grid.type == "bool" || grid.type == "mask")
    grid.flaw = "holds no distances or densities, only which voxels are set";
  else if (grid.type.compare(0, 3, "vec") == 0)
    grid.flaw = "holds vectors, which have no surface";
  else if (grid.type.compare(0, 6, "ptdata") == 0)
    grid.flaw = "holds points; export them as .ply, .xyz or .pcd";
  else if (is_integer(grid.type))
    grid.flaw = "holds integers, which are labels of regions; if they are distances or densities, save them as float";
  else if (grid.type != "float" && grid.type != "double")
    grid.flaw = "holds values of a type that is not meshed; save it as float";
  return grid;
}

VolumeGrid as_labels(const VdbGridSpan& span) {
  VolumeGrid grid = describe(span);
  if (grid.flaw.empty() && !is_integer(grid.type)) grid.flaw = "holds no labels; these are integers of 32 or 64 bits";
  return grid;
}

bool is_nano_file(const MeshSource& source) {
  const size_t start_bytes = sizeof kNanoStart - 1;
  return source.size() >= int64_t(start_bytes) && std::memcmp(source.begin(), kNanoStart, start_bytes) == 0;
}

std::string meshed_grid(const MeshSource& source, const std::string& grid) {
  const bool is_of_labels = holds_labels(source, grid);
  const VdbLayout layout = read_vdb_layout(source.name(), {source.begin(), source.size()});
  std::vector<VolumeGrid> grids;
  for (const VdbGridSpan& span : layout.grids) grids.push_back(is_of_labels ? as_labels(span) : as_volume(span));
  VolumeReadOptions options;
  options.grid = grid;
  return with_names_apart(layout.grids)[choose_grid(source.name(), grids, options)].name;
}

bool holds_labels(const MeshSource& source, const std::string& grid) {
  if (source.size() == 0 || is_nano_file(source)) return false;
  const VdbLayout layout = read_vdb_layout(source.name(), {source.begin(), source.size()});
  const std::vector<VdbGridSpan> named = with_names_apart(layout.grids);
  bool has_labels = false;
  for (size_t i = 0; i < named.size(); ++i) {
    if (!grid.empty() && named[i].name != grid && plain_name(layout.grids[i]) != grid) continue;
    if (as_volume(layout.grids[i]).flaw.empty()) return false;
    has_labels |= as_labels(layout.grids[i]).flaw.empty();
  }
  return has_labels;
}

}  // namespace isoshell
