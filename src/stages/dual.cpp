// triangulate_dual: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

DualMesh triangulate_dual(const Sheet& sheet, SeedSet& seeds, const DualOptions& options, DualReport& report, Context& context) {
  return backend_for(context).triangulate_dual(sheet, seeds, options, report, context);
}

}  // namespace isoshell
