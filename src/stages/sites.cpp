// voxelize: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

SiteSet voxelize(const LatticeSurface& surface, Context& context) {
  return backend_for(context).voxelize(surface, context);
}

}  // namespace isoshell
