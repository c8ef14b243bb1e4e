// triangulate_dual: checks its arguments, then runs on the backend that the context asks for.
#include <string>

#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

Triangulation triangulate_dual(const SurfaceMesh& surface, SeedSet&& seeds, const DualOptions& options,
                               Context& context) {
  require_closed_or_fixed(surface, seeds, "dual");
  require_blocks(surface, "dual");
  const int64_t seed_count = seeds.size(), vertex_count = surface.vertex_count();
  if (seed_count < 1 || seed_count > vertex_count)
    throw NoRoom("dual",
                 std::to_string(seed_count) + " seeds for a surface of " + std::to_string(vertex_count) +
                     " vertices; there must be 1 to as many as vertices: use a higher resolution or fewer seeds");
  if (options.max_repair_rounds < 0)
    throw Error(ErrorCode::usage, "dual",
                "max_repair_rounds is " + std::to_string(options.max_repair_rounds) + "; it must be 0 or more");
  return backend_for(context).triangulate_dual(surface, std::move(seeds), options, context);
}

}  // namespace isoshell
