// The call most people need: a surface in, an isotropic closed mesh out.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "isoshell/stages.h"

namespace isoshell {

enum class Method { sheet, shell };

struct RemeshOptions {
  int64_t vertices = 10000;      ///< exact target; ignored when edge_length_world is set
  double edge_length_world = 0;  ///< 0 means by vertices
  int32_t resolution = 0;        ///< voxels along the longest side, 0 chooses
  double voxel_size_world = 0;   ///< 0 means by resolution
  int32_t band_vox = 2;          ///< d
  int32_t closing_vox = -1;      ///< r; -1 chooses (0 for a closed surface)
  double closing_world = -1;     ///< gap width in world units; -1 means by closing_vox
  Method method = Method::sheet;
  int32_t max_passes = 0;        ///< 0 means the method's own
  double tolerance = -1;         ///< relative fall of the energy a pass; negative means the method's own
  double max_step_vox = 0;       ///< u; 0 means the method's own
  uint64_t seed = 0;
};

/// One step of the run, in order, for the stats.
struct StageTime {
  std::string stage;
  double ms;
};

struct RemeshReport {
  InputTopology input;
  DirtCounts dirt;
  LatticeFrame frame;
  int32_t band_vox = 0, closing_vox = 0;
  int64_t sites = 0, active_voxels = 0, leaves = 0, sheet_vertices = 0, seeds = 0;
  SheetTopology sheet;
  bool topology_agrees = false;      ///< components and genus of the sheet equal the closed, oriented input's
  RelaxReport relax;
  DualReport dual;
  int64_t components = 0, genus = 0; ///< of the result
  std::vector<StageTime> times;
  std::map<std::string, std::string> digests;
  std::vector<std::string> warnings;
};

struct RemeshResult {
  TriangleMesh mesh;
  RemeshReport report;
};

/// Algorithm 1 of the paper. Throws Error as the stages do.
RemeshResult remesh(const TriangleSoup& surface, const RemeshOptions& options, Context& context);

}  // namespace isoshell
