// See level_sets.h.
#include "io/level_sets.h"

#include <algorithm>
#include <filesystem>
#include <map>
#include <utility>

#include "core/file_format.h"
#include "io/vdb/grid_kinds.h"
#include "io/vdb/grid_names.h"
#include "io/vdb/volume_readers.h"
#include "isoshell/error.h"
#include "isoshell/io/file_format.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr char kLevelSet[] = "level set";

bool is_pattern(const std::string& name) { return name.find_first_of("*?") != std::string::npos; }

void check_is_volume(const MeshSource& source) {
  const FileFormat* const format = find_format(format_of_path(source.name()));
  if (format && !format->reads_volume)
    throw Error(ErrorCode::usage, "read",
                source.name() +
                    ": several level sets are read of .vdb and .nvdb files; this is none by its name; parts of one "
                    "mesh become regions by --regions, and one mesh is meshed alone");
}

std::vector<VolumeGrid> grids_in(const MeshSource& source) {
  if (is_nano_file(source)) return nano_grids(source);
  std::vector<VolumeGrid> grids;
  const VdbLayout layout = read_vdb_layout(source.name(), {source.begin(), source.size()});
  for (const VdbGridSpan& span : layout.grids) grids.push_back(as_volume(span));
  return grids;
}

/// The name, apart from all others, of the one that is named, or of the only one.
std::string one_of(const MeshSource& source, const std::string& grid) {
  if (!is_nano_file(source)) return meshed_grid(source, grid);
  const std::vector<VolumeGrid> grids = nano_grids(source);
  VolumeReadOptions options;
  options.grid = grid;
  return with_names_apart(grids)[choose_grid(source.name(), grids, options)].name;
}

/// Names apart from all others of the grids that a file is asked for.
std::vector<std::string> grids_of(const LevelSetFile& file, std::vector<std::string>& warnings) {
  const MeshSource& source = *file.source;
  check_is_volume(source);
  if (!is_pattern(file.grid)) return {one_of(source, file.grid)};
  std::vector<std::string> found;
  std::string all, left_out;
  for (const VolumeGrid& grid : with_names_apart(grids_in(source))) {
    all += (all.empty() ? "" : ", ") + grid.text();
    if (!fits(grid.name, file.grid)) continue;
    if (grid.grid_class == kLevelSet && !grid.flaw.empty())
      throw Error(ErrorCode::usage, "read",
                  source.name() + ": level set " + grid.text() + " has a name like \"" + file.grid + "\", but " +
                      grid.flaw + "; take another pattern, or mend it");
    if (grid.grid_class == kLevelSet)
      found.push_back(grid.name);
    else if (grid.flaw.empty())
      left_out += (left_out.empty() ? "" : ", ") + grid.text();
  }
  if (found.empty())
    throw Error(ErrorCode::usage, "read",
                source.name() + ": no level set has a name like \"" + file.grid + "\"; it holds " + all);
  if (!left_out.empty())
    warnings.push_back("grids left out, as their class is not level set though their names are like \"" + file.grid +
                       "\": " + left_out);
  std::sort(found.begin(), found.end());  // so that labels do not depend on who wrote the file
  return found;
}

std::unique_ptr<ScalarField> read_level_set(const MeshSource& source, const std::string& grid, int64_t limit_bytes) {
  const VolumeReadOptions options{grid, {}, limit_bytes};
  std::unique_ptr<ScalarField> field =
      is_nano_file(source) ? read_nano_volume(source, options) : read_vdb_volume(source, options);
  field->file = source.name();
  if (field->grid_class != kLevelSet)
    throw Error(ErrorCode::usage, "read",
                field->title() + " has the class " + field->grid_class +
                    "; several volumes are meshed together where all of them are level sets");
  return field;
}

void add_grid(const MeshSource& source, const std::string& grid, int64_t memory_limit_bytes, LevelSets& sets) {
  const int64_t left_bytes = left_beside(sets, memory_limit_bytes);
  try {
    add_level_set(*read_level_set(source, grid, left_bytes), grid, memory_limit_bytes, sets);
  } catch (const Error& error) {
    if (error.code() != ErrorCode::out_of_memory || sets.blocks.empty()) throw;
    throw Error(error.code(), error.stage(),
                error.what() + ("; this is what is left beside " + counted(int64_t(sets.blocks.size()), "level set")) +
                    " read before it, which take " + readable_bytes(sets.bytes()));
  }
}

struct NamedGrid {
  const MeshSource* source;
  std::string name;
};

/// The same for two paths of one file.
std::string place_of(const NamedGrid& grid) {
  std::error_code failed;
  const std::filesystem::path path = std::filesystem::weakly_canonical(grid.source->name(), failed);
  return (failed ? grid.source->name() : path.string()) + ":" + grid.name;
}

void refuse_twice(const std::vector<NamedGrid>& grids) {
  std::map<std::string, const NamedGrid*> first;
  for (const NamedGrid& grid : grids)
    if (const auto [at, is_new] = first.try_emplace(place_of(grid), &grid); !is_new) {
      const std::string once = at->second->source->name() + ":" + grid.name,
                        again = grid.source->name() + ":" + grid.name;
      throw Error(ErrorCode::usage, "read",
                  again + " is given twice" + (once == again ? "" : ", also as " + once) + "; leave one of them out");
    }
}

/// The names of grids; where those are the same FILE:GRID, and where files have one name in two folders their paths.
std::vector<std::string> names_apart(const std::vector<NamedGrid>& grids) {
  const auto named = [&](size_t length, const NamedGrid& grid) {
    if (length == 0) return grid.name;
    const std::string& path = grid.source->name();
    return (length == 1 ? std::filesystem::path(path).stem().string() : path) + ":" + grid.name;
  };
  std::vector<size_t> length(grids.size(), 0);
  std::vector<std::string> names(grids.size());
  for (int round = 0; round < 3; ++round) {
    std::map<std::string, int> uses;
    for (size_t i = 0; i < grids.size(); ++i) ++uses[names[i] = named(length[i], grids[i])];
    for (size_t i = 0; i < grids.size(); ++i) length[i] += uses[names[i]] > 1 ? 1 : 0;
  }
  return names;
}

}  // namespace

bool is_for_level_sets(const InputRequest& request) { return !request.also.empty() || is_pattern(request.grid); }

bool fits(const std::string& name, const std::string& pattern) {
  size_t n = 0, p = 0, star = std::string::npos, from = 0;  // where the last * is, and what it stands for begins after
  while (n < name.size()) {
    if (p < pattern.size() && pattern[p] == '*') {
      star = p++;
      from = n;
    } else if (p < pattern.size() && (pattern[p] == '?' || pattern[p] == name[n])) {
      ++p, ++n;
    } else if (star != std::string::npos) {
      p = star + 1;
      n = ++from;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', p) == std::string::npos;
}

LevelSets read_level_sets(const std::vector<LevelSetFile>& files, int64_t memory_limit_bytes, int64_t reference_bytes) {
  LevelSets sets;
  sets.reference_bytes = reference_bytes;
  std::vector<NamedGrid> grids;
  for (const LevelSetFile& file : files)
    for (const std::string& grid : grids_of(file, sets.warnings)) grids.push_back({file.source, grid});
  refuse_twice(grids);
  const std::vector<std::string> names = names_apart(grids);
  for (const NamedGrid& grid : grids) add_grid(*grid.source, grid.name, memory_limit_bytes, sets);
  sets.names = names;
  return sets;
}

}  // namespace isoshell
