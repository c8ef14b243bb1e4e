// Which of a file's grids is read.
#include "io/vdb/grid_names.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

constexpr char kLevelSet[] = "level set";

std::string list_of(const std::vector<VolumeGrid>& grids) {
  std::string list;
  for (const VolumeGrid& grid : grids) list += (list.empty() ? "" : ", ") + grid.text();
  return list;
}

}  // namespace

std::string VolumeGrid::text() const { return "\"" + name + "\" (" + type + ", " + grid_class + ")"; }

size_t choose_grid(const std::string& path, const std::vector<VolumeGrid>& named, const VolumeReadOptions& options,
                   const char* wanted) {
  const std::vector<VolumeGrid> grids = with_names_apart(named);
  std::vector<size_t> fit, level_sets;
  for (size_t i = 0; i < grids.size(); ++i) {
    if (!options.grid.empty() && grids[i].name != options.grid && named[i].name != options.grid) continue;
    if (!options.grid.empty() && !grids[i].flaw.empty())
      throw Error(ErrorCode::nothing_to_mesh, "read", path + ": grid " + grids[i].text() + " " + grids[i].flaw);
    if (!grids[i].flaw.empty()) continue;
    fit.push_back(i);
    if (grids[i].grid_class == kLevelSet) level_sets.push_back(i);
  }
  if (fit.size() == 1) return fit[0];
  if (level_sets.size() == 1) return level_sets[0];
  if (!options.grid.empty() && fit.empty())
    throw Error(ErrorCode::usage, "read", path + ": has no grid \"" + options.grid + "\"; it holds " + list_of(grids));
  if (!fit.empty())
    throw Error(ErrorCode::usage, "read",
                path + ": holds several grids, name one as " + path + ":" + grids[fit[0]].name +
                    (level_sets.size() > 1 ? ", or all level sets, as regions, by " + path + ":*" : "") +
                    "; they are " + list_of(grids));
  std::string why;
  for (const VolumeGrid& grid : grids) why += (why.empty() ? "; " : ", ") + grid.text() + " " + grid.flaw;
  throw Error(ErrorCode::nothing_to_mesh, "read", path + ": holds no grid " + wanted + why);
}

void check_volume_memory(const MeshSource& source, const VolumeGrid& grid, int64_t grid_bytes,
                         const VolumeReadOptions& options) {
  const int64_t bytes = grid_bytes + source.budget().held_bytes();
  if (options.memory_limit_bytes <= 0 || bytes <= options.memory_limit_bytes) return;
  throw Error(ErrorCode::out_of_memory, "memory",
              source.name() + ": grid " + grid.text() + " takes with its file " + std::to_string(bytes >> 20) +
                  " MiB, more than the limit of " + std::to_string(options.memory_limit_bytes >> 20) +
                  " MiB; resample it coarser or raise --max-memory");
}

}  // namespace isoshell
