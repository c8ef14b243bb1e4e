// build_shell: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

Shell build_shell(const SiteSet& sites, const ShellOptions& options, Context& context) {
  return backend_for(context).build_shell(sites, options, context);
}

}  // namespace isoshell
