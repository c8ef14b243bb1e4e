// The triangles around the sheet's vertices, in buckets of the host.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/halfedge/triangles_around.h"

namespace isoshell {

struct CpuListTrianglesAround {
  static void run(CpuExecutor&, SurfaceMesh& sheet) { list_triangles_around(sheet); }
};

}  // namespace isoshell
