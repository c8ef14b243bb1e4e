// A certificate for any mesh, whoever made it: what vdb_meshinfo says.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/distance.h"
#include "isoshell/io/input.h"
#include "isoshell/mesh_census.h"
#include "isoshell/message.h"
#include "isoshell/region_census.h"
#include "isoshell/run/gates.h"

namespace isoshell {

struct MeshInfoRequest {
  InputRequest mesh;
  std::optional<InputRequest> reference;  ///< a surface or points; without it no distance is measured
  Gates gates;
};

struct MeshInfo {
  InputFacts mesh;
  std::optional<InputFacts> reference;
  DirtCounts dirt;  ///< of the mesh's file; what a reader left out is in no other count but repeated corners
  MeshCensus census;
  std::optional<RegionCensus> regions;  ///< of a mesh that has any; edges of more than two faces are no flaw of it then
  std::optional<MeshDistance> distance;  ///< of the mesh and the reference
  std::vector<std::string> missed_gates;
};

/// Reads, counts and measures; nothing is repaired or snapped, and points of a reference stay points. Its stages are
/// "read", "census", "regions", "distance". Result: the same for every number of threads. Throws: usage for a gate of
/// curves, a gate of distances without a reference or of normals from points, a mesh that is no mesh and a reference
/// that is a stage file; and as read_input, take_census, take_region_census and measure_distance do.
MeshInfo mesh_info(const MeshInfoRequest& request, Context& context, const Tell& tell = {},
                   const TellProgress& progress = {});
/// The same, with other ways of reading; the reference's is empty where there is none, and keeps points as points where
/// they are to be measured from.
MeshInfo mesh_info(const std::function<Input()>& read_mesh, const std::function<Input()>& read_reference,
                   const Gates& gates, Context& context, const TellProgress& progress = {});

/// As JSON, schema 1; what was not measured is null.
std::string mesh_info_json(const MeshInfo& info);
/// To a file, or "-". Throws: unwritable_output.
void write_mesh_info(const std::string& path, const MeshInfo& info, bool overwrite);

}  // namespace isoshell
