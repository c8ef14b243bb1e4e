// Ranges as text.
#include "vdb_isomesh/ranges.h"

#include <sstream>

namespace isoshell::tool {

std::string number_text(double value) {
  std::ostringstream text;
  text.precision(10);
  text << value;
  return text.str();
}

std::string Range::text() const {
  const std::string bound = above ? "more than " + number_text(low) : number_text(low);
  if (high == std::numeric_limits<double>::max()) return above ? bound : bound + " or more";
  return above ? bound + " and at most " + number_text(high) : bound + " to " + number_text(high);
}

}  // namespace isoshell::tool
