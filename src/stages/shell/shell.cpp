// build_shell: checks its arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

Shell build_shell(const SiteSet& sites, const ShellOptions& options, Context& context) {
  if (options.band_vox < 1 || options.band_vox > kMaxBandVox)
    throw Error(ErrorCode::usage, "shell",
                "band_vox is " + std::to_string(options.band_vox) + "; it must be 1 to " + std::to_string(kMaxBandVox));
  return backend_for(context).build_shell(sites, options, context);
}

}  // namespace isoshell
