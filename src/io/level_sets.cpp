// See level_sets.h.
#include "io/level_sets.h"

#include <algorithm>
#include <filesystem>
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

/// What a file that is no .vdb file needs to be one.
void check_is_vdb(const MeshSource& source) {
  const auto refuse = [&](const std::string& remedy) {
    throw Error(ErrorCode::usage, "read", source.name() + ": several level sets are read of .vdb files; " + remedy);
  };
  if (is_nano_file(source)) refuse("convert it by OpenVDB's nanovdb_convert FILE.nvdb FILE.vdb");
  const FileFormat* const format = find_format(format_of_path(source.name()));
  if (format && !format->reads_volume)
    refuse("this is none by its name; parts of one mesh become regions by --regions, and one mesh is meshed alone");
}

/// Names apart from all others of the grids that a file is asked for.
std::vector<std::string> grids_of(const LevelSetFile& file, std::vector<std::string>& warnings) {
  const MeshSource& source = *file.source;
  check_is_vdb(source);
  if (!is_pattern(file.grid)) return {meshed_grid(source, file.grid)};
  const VdbLayout layout = read_vdb_layout(source.name(), {source.begin(), source.size()});
  std::vector<VolumeGrid> grids;
  for (const VdbGridSpan& span : layout.grids) grids.push_back(as_volume(span));
  std::vector<std::string> found;
  std::string all, left_out;
  for (const VolumeGrid& grid : with_names_apart(grids)) {
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
  std::unique_ptr<ScalarField> field = read_vdb_volume(source, {grid, {}, limit_bytes});
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

LevelSets read_level_sets(const std::vector<LevelSetFile>& files, int64_t memory_limit_bytes) {
  LevelSets sets;
  std::vector<std::string> stems;
  for (const LevelSetFile& file : files)
    for (const std::string& grid : grids_of(file, sets.warnings)) {
      add_grid(*file.source, grid, memory_limit_bytes, sets);
      stems.push_back(std::filesystem::path(file.source->name()).stem().string());
    }
  const std::vector<std::string> names = sets.names;
  for (size_t i = 0; i < names.size(); ++i)
    if (std::count(names.begin(), names.end(), names[i]) > 1) sets.names[i] = stems[i] + ":" + names[i];
  return sets;
}

}  // namespace isoshell
