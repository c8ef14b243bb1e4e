// Where results go: checks before the run, so that hours of work do not end at a locked door.
#pragma once

#include <string>

#include "isoshell/run/run.h"

namespace isoshell {

/// The picture of a Voronoi file for programs that open float grids only: mesh.voronoi.vdb has
/// mesh.voronoi.preview.vdb.
std::string preview_path(const std::string& path);

/// Every file that the run would write can be: its folder exists and is writable, and it does not exist yet unless it
/// may be replaced. Throws: unwritable_output, also when this build cannot write its format; usage when two results
/// would share one file.
void check_outputs(const RunRequest& request);

/// What a run can keep of the features that are asked for, or that the stage file has that it resumes: a Voronoi stage
/// file holds none. Throws: usage where a threshold, or that borders are kept, is asked for and such a file.
Features possible_features(const RemeshOptions& options, const RunRequest& request);

}  // namespace isoshell
