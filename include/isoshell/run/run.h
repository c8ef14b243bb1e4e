// A whole run, from what is read to what is written: the call behind the command, and behind every other front. steps.h
// has it step by step.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/advanced/level_set.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/message.h"
#include "isoshell/options/options_json.h"
#include "isoshell/run/gates.h"
#include "isoshell/run/record.h"

namespace isoshell {

enum class StopAfter { mesh, shell, voronoi, level_set };

/// What is measured of the result. Gates have measured what they ask for, statistics that are written everything.
enum class Measures {
  none,
  mesh,  ///< its topology and quality
  all,   ///< also its distance from the input, sites with two walls, digests of all products
};

/// Calls `write`, which writes that file; for who must know while one is being written.
using AroundWrite = std::function<void(const std::string& path, const std::function<void()>& write)>;

/// What distances are measured to.
enum class LevelSetOf {
  input,   ///< the surface that is meshed
  result,  ///< the mesh, on the lattice of the input's
};

/// A level set that is made on the way; see LevelSet.
struct LevelSetRequest {
  std::string path;                   ///< its file; empty: none
  double band_vox = 3;                ///< how far it reaches on both sides
  LevelSetOf of = LevelSetOf::input;  ///< the result must be closed
  bool as_half = false;               ///< values of 16 bits in the file, as in the output of a run that stops there
  bool keep = false;                  ///< in the result, beside a file or without one
};

struct RunRequest {
  InputRequest input;
  RequestedOptions options;  ///< a sizing field without "vertices" among the given ones decides their number
  OutputRequest output;      ///< the mesh, or the stage file when the run stops before it
  StopAfter stop_after = StopAfter::mesh;
  std::string save_shell, save_voronoi;  ///< stage files to write on the way, a preview beside the second; empty: none
  LevelSetRequest level_set;
  std::string split_regions;  ///< folder for a file of each region; empty: none
  std::string statistics;     ///< file, or "-"; empty: none
  std::string report;  ///< page that the front writes of the result afterwards, from all that is measured; empty: none
  Gates gates;
  Measures measures = Measures::mesh;
  bool overwrite = false;
  std::string made_of;         ///< of a frame of a sequence: MeshWriteOptions::made_of of its mesh
  std::string written_before;  ///< what an interruption names beside the run's own files; empty: nothing

  Tell tell;
  AroundWrite around_write;  ///< empty: files are just written
  TellProgress progress;     ///< of the whole run, whose steps are its stages; empty: nobody waits
};

/// The output that a person's words mean: its format is the path's unless one is given. Throws: usage when nothing says
/// it, and when the run does not end with such a file.
OutputRequest named_output(const std::string& path, const std::string& format, StopAfter stop_after);

/// From "auto" or "X,Y,Z". Throws: usage.
Recenter parse_recenter(const std::string& text);

/// What can be told of a request before any file is looked at: the format of its output, too, for a request that was
/// filled in by hand. Throws: usage; unreadable_input for a sizing field when the build has no OpenVDB.
void check_request(const RunRequest& request);

struct RunResult {
  TriangleMesh mesh;  ///< empty when the run stopped before it
  RunRecord record;
  std::vector<std::string> gates;  ///< as they were asked for
  std::vector<std::string> missed_gates;
  std::string made_of = {};                        ///< of a frame: what its PLY file says of that
  std::shared_ptr<const LevelSet> level_set = {};  ///< where it was kept, in host memory
};

/// Checks that every file can be written, reads, and goes on from there as the second form. Its steps are "read",
/// "grids", "sizing", "prepare", "risks", "relax", "flood", "triangulate", "measure", "distance", "sample", "write",
/// .... The context's progress hears of them, too, beside the stages' own. Result: the same bytes for the same input
/// and options. Throws: as every part does; an interruption says which files were written before.
RunResult run(const RunRequest& request, Context& context);
/// From what was read already, or came from memory: prepares, relaxes, triangulates, measures, writes.
RunResult run(Input input, const RunRequest& request, Context& context);

/// What the run would take, from what is read alone; nothing is written. Throws: usage for a stage file, and as reading
/// does.
RunEstimate dry_run(const RunRequest& request, Context& context);
/// The same of what is in memory already.
RunEstimate dry_run(Input input, const RunRequest& request, Context& context);

/// How a run with these features has a volume or points read.
VolumeCreases volume_creases(const Features& features);

/// What a run of the request reads its input by, of a file or in memory: with the creases and borders that it keeps.
InputRequest input_request_of(const RunRequest& request);

/// Reads the input as a run of the request does. Throws: as read_input().
Input read_input_of(const RunRequest& request, const Context& context, const Tell& tell);

}  // namespace isoshell
