// relax_on_sheet: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

RelaxReport relax_on_sheet(const Sheet& sheet, SeedSet& seeds, const RelaxOptions& options, Context& context) {
  return backend_for(context).relax_on_sheet(sheet, seeds, options, context);
}

}  // namespace isoshell
