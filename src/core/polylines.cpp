#include "isoshell/polylines.h"

namespace isoshell {

std::string Polylines::name_of(size_t segment) const {
  const std::string number =
      segment < lines.size() ? "line " + std::to_string(lines[segment]) : "segment " + std::to_string(segment);
  return source.empty() ? number : source + ", " + number;
}

}  // namespace isoshell
