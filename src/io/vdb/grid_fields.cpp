// Names of grids that are sampled.
#include "io/vdb/grid_fields.h"

namespace isoshell {

// A name may hold colons; what follows the last ".vdb:" is the grid's.
GridName grid_name_of(const std::string& text) {
  const size_t at = text.rfind(".vdb:");
  if (at == std::string::npos) return {"", text};
  return {text.substr(0, at + 4), text.substr(at + 5)};
}

}  // namespace isoshell
