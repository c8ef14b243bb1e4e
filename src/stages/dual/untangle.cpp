// untangle_sheet: runs on the backend that the context asks for.
#include "stages/backend_table.h"

namespace isoshell {

UntangledSheet untangle_sheet(Sheet&& sheet, SeedSet&& seeds, Context& context) {
  const int64_t pairs = backend_for(context).untangle_sheet(sheet, seeds, context);
  return {std::move(sheet), std::move(seeds), pairs};
}

}  // namespace isoshell
