// untangle_sheet: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

int64_t untangle_sheet(Sheet& sheet, SeedSet& seeds, Context& context) {
  return backend_for(context).untangle_sheet(sheet, seeds, context);
}

}  // namespace isoshell
