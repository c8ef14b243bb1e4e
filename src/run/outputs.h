// Where results go: checks before the run, so that hours of work do not end at a locked door.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "isoshell/io/output_files.h"
#include "isoshell/run/run.h"

namespace isoshell {

/// The picture of a Voronoi file for programs that open float grids only: mesh.voronoi.vdb has
/// mesh.voronoi.preview.vdb; empty for standard output, which holds one file.
std::string preview_path(const std::string& path);

/// The files that a run writes and reads, as far as they are known before it.
std::vector<NamedFile> outputs_of(const RunRequest& request);
std::vector<NamedFile> inputs_of(const RunRequest& request);

/// The file of a sizing field, FIELD.vdb or FIELD.vdb:GRID; empty where it is an attribute of the input.
std::string file_of_sizing(const std::string& sizing);

/// check_request() of a request of which all is known: also where it reads from, and whether its level set is kept.
/// Throws: as that does, and check_several(); usage for options of a level set that nothing asks for.
void check_whole_request(const RunRequest& request);

/// Every file that the run would write can be (see check_output_files). Throws: also unwritable_output when this build
/// cannot write its format.
void check_outputs(const RunRequest& request);

/// A region's own file.
struct RegionFile {
  int32_t label;
  std::string path;
};

/// One for each region that faces have, ascending by label: the folder's file of its name, or else of its label. What
/// file systems and shells may not take in a name becomes an underscore, and the label follows where names would be the
/// same, in upper or lower case.
std::vector<RegionFile> region_files(const FaceRegions& regions, const std::string& folder, const std::string& format);

/// Those that the request wants, of the format of its output, each of which can be written; it may want none. Throws:
/// usage for a surface without regions; as check_outputs().
std::vector<RegionFile> checked_region_files(const RunRequest& request, const FaceRegions& regions);

/// Those whose regions the mesh still has; warns of others.
std::vector<RegionFile> files_of_kept(const std::vector<RegionFile>& files, const TriangleMesh& mesh,
                                      const std::function<void(const std::string&)>& warn);

/// To the output, in the numbers that the record says of its file. Throws: as write_mesh().
void write_output(const TriangleMesh& mesh, const RunRequest& request, bool curve_edges, const WrittenFile& output);

/// The region's closed mesh, less the offset of the output, in its folder, which is made where it is not there, and its
/// file in the record. Throws: as write_mesh().
void write_region(const RegionFile& file, const TriangleMesh& mesh, bool overwrite, RunRecord& record);

/// What a run can keep of the features that are asked for, or that the stage file has that it resumes: a Voronoi stage
/// file holds none. Throws: usage where a threshold, or that borders are kept, is asked for and such a file.
Features possible_features(const RunOptions& options, const RunRequest& request);

}  // namespace isoshell
