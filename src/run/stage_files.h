// What a run writes into .vdb files, and takes from stage files again: products, and level sets of its input or result.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isoshell/io/input.h"
#include "isoshell/io/vdb_file.h"
#include "isoshell/remesh.h"
#include "isoshell/run/run.h"

namespace isoshell {

/// The attributes of an input, among those that are asked for, which stage files of its run do not hold; of a stage
/// file what that has left out. Empty: none.
std::string left_out_of_stage_files(const Input& input, const std::optional<std::vector<std::string>>& requested);

/// Files that keep this stage: one on the way, and the output of a run that stops there.
std::vector<std::string> stage_files(const RunRequest& request, const std::string& saved, StopAfter stage);

std::vector<std::string> level_set_files(const RunRequest& request);
/// Whether a run makes a level set.
bool makes_level_set(const RunRequest& request);
/// Whether it makes one of this.
bool makes_level_set_of(const RunRequest& request, LevelSetOf of);

/// Throws: usage where a level set is asked for that the other options leave no solid, or no mesh, for.
void check_level_set(const RunRequest& request);
/// Throws: usage for options of a level set where none is asked for.
void check_level_set_is_asked(const RunRequest& request);
/// Throws: usage where a level set is asked for, of an input that parts regions.
void refuse_level_set_of_regions(const RunRequest& request);

/// What the request asks for: level_set() of the prepared surface; or the same of the solid that the mesh bounds, exact
/// to its triangles. On the host. Throws: as level_set(), prepare() and, where it is written, check_level_set_write();
/// usage for a mesh that is not closed.
LevelSet level_set_of_run(const RunRequest& request, const Prepared& prepared, const TriangleMesh& mesh,
                          Context& context);

LevelSetWriteOptions level_set_write_options(const RunRequest& request);

/// Throws: usage where seeds are in patches, which a Voronoi stage file does not hold.
void refuse_seeds_of_patches(const Prepared& prepared);

StageWriteOptions stage_write_options(const Prepared& prepared, const std::string& options_json,
                                      const std::string& left_out, bool overwrite);

/// The Voronoi stage file, and its preview where that has a path of its own.
void save_with_preview(const std::string& path, const Prepared& prepared, const SeedSet& seeds,
                       const VoronoiLabels& labels, const StageWriteOptions& options);

/// The seeds that a stage file holds, on the sheet that was made of its surface; it has none afterwards. Throws:
/// unreadable_input where they do not belong there.
Relaxed seeds_of_stage(Input& input, const Prepared& prepared);

}  // namespace isoshell
