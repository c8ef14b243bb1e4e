// The triangles of sites on the CPU.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/sites/samples_body.h"

namespace isoshell {

/// Lists the triangles of a few leaves' sites apart, and joins the lists once their lengths are known.
struct CpuListSiteTriangles {
  static void run(CpuExecutor& exec, const SurfaceView& surface, const VoxelSetView& sites, const LeafTriangles& lists,
                  SiteSamples& out);
};

}  // namespace isoshell
