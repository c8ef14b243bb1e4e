// Everything measured in a run, as JSON (schema 1).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "isoshell/device_info.h"
#include "isoshell/distance.h"
#include "isoshell/mesh_topology.h"
#include "isoshell/quality.h"
#include "isoshell/remesh.h"
#include "vdb_isomesh/args.h"
#include "vdb_isomesh/input.h"

namespace isoshell::tool {

/// What is known of the input before the first stage; counts are -1 where they are not known.
struct InputFacts {
  InputKind kind = InputKind::mesh;
  int64_t vertices = -1, faces = -1;
  std::optional<WorldPoint> box_min, box_max;
};

struct RunRecord {
  InputFacts input;
  RemeshReport report;
  std::optional<MeshTopology> topology;  ///< of the result, from its triangles alone
  std::optional<MeshQuality> quality;
  std::optional<MeshDistance> distance;  ///< of the result and the input, as repaired
  int64_t vertices = -1, triangles = -1;
  int64_t risky_sites = -1;      ///< with two walls in one voxel
  std::vector<StageTime> times;  ///< of the command; the library's are in the report
  double total_ms = 0;
  DeviceInfo device;
  int64_t host_peak_bytes = 0, device_peak_bytes = 0;
  std::vector<std::string> warnings;
};

/// What was not measured is null.
std::string stats_json(const Arguments& arguments, const RunRecord& record);

}  // namespace isoshell::tool
