// Everything that is known of a run when it ends.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/borders.h"
#include "isoshell/device_info.h"
#include "isoshell/distance.h"
#include "isoshell/io/input.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/memory_estimate.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/options/requested_options.h"
#include "isoshell/quality.h"
#include "isoshell/region_census.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// Whether files of meshes have positions less an offset; what is in memory stays.
struct Recenter {
  bool is_asked = false;
  std::optional<WorldPoint> offset_world = {};  ///< without a value offset_to_origin() of the result

  WorldPoint offset() const { return offset_world.value_or(WorldPoint{0, 0, 0}); }  ///< as far as it is known
};

/// A file that a run writes.
struct OutputRequest {
  std::string path;        ///< "-" is standard output; empty: no file
  std::string format;      ///< lower case, without a dot
  Recenter recenter = {};  ///< also of the files of regions
};

/// A file of a mesh that a run has written, and what its numbers make of the mesh.
struct WrittenFile {
  std::string path, format;
  HeldPositions held;
};

/// What files have subtracted, and which numbers are coarse; `offset_world` is what could be subtracted. All have the
/// same offset.
std::vector<std::string> warnings_of_files(const std::vector<WrittenFile>& files, const WorldPoint& offset_world);

/// A grid whose values the vertices of the result have.
struct SampledGrid {
  std::string name;
  std::vector<std::string> attributes;  ///< that they are
  int64_t vertices_outside = 0;         ///< with no active voxel around them
};

/// What the input has beside its positions, by name, and what grids add to it.
struct AttributeReport {
  std::vector<std::string> kept;
  std::vector<DroppedAttribute> dropped;
  std::vector<SampledGrid> grids = {};
};

/// The result is measured as its file has it, in which positions may be rounded.
struct RunRecord {
  RunOptions options;  ///< as they were asked for
  InputFacts input;
  OutputRequest output;
  std::vector<WrittenFile> files;  ///< of meshes: that of the output, then those of regions
  RemeshReport report;
  std::optional<MeshTopology> topology;  ///< of the result, from its triangles alone
  std::optional<MeshQuality> quality;
  std::optional<RegionCensus> regions;    ///< of a result that has any
  std::optional<MeshDistance> distance;   ///< of the result and the input, as repaired
  std::optional<BorderMeasures> borders;  ///< the same, of a run that kept borders
  int64_t vertices = -1, triangles = -1;  ///< of the result; -1 when the run stopped before it
  AttributeReport attributes;
  int64_t risky_sites = -1;      ///< with two walls in one voxel; -1: not counted
  std::vector<StageTime> times;  ///< of the steps around the stages, whose own are in the report
  double total_ms = 0;
  DeviceInfo device;
  int64_t host_peak_bytes = 0, device_peak_bytes = 0;  ///< of the process, at any time
  std::vector<std::string> warnings;                   ///< all of them, in the order in which they came
};

/// What regions and walls of the input the result has not, or has beyond; nothing for one without regions.
std::optional<RegionChanges> region_changes_of(const RunRecord& record);

/// The statistics of a run as JSON, schema 1; what was not measured is null.
std::string statistics_json(const RunRecord& record);

/// The same of a dry run, under the names that the Python module has; without a limit (0) that is null.
std::string estimate_json(const RunEstimate& estimate, int64_t memory_limit_bytes);

}  // namespace isoshell
