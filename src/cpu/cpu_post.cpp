// The CPU's improve_mesh.
#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/label_lanes.h"
#include "cpu/post_work.h"
#include "cpu/walk_ahead.h"
#include "stages/post_body.h"

namespace isoshell {

PostReport CpuBackend::improve_mesh(const Sheet& sheet, const PostOptions& options, SeedSet& seeds, DualMesh& mesh,
                                    Context& context) const {
  CpuExecutor exec(context, "post");
  return run_with_threads(
      context, [&] { return improve_mesh_body(exec, *OnHost(sheet), options, on_host(seeds), on_host(mesh)); });
}

}  // namespace isoshell
