// The one file that knows the source folder's name, so that the others compile to the same bytes anywhere.
#include "support/source_folder.h"

#include <cstdlib>

namespace isoshell {

std::string source_folder() {
  const char* folder = std::getenv("ISOSHELL_SOURCE");
  return folder ? folder : ISOSHELL_SOURCE;
}

}  // namespace isoshell
