// What a module of another language does: one function of its own in a shared library, around the whole run.
#include <string_view>

#include "isoshell/isoshell.h"

static_assert(std::string_view(ISOSHELL_VERSION) == ISOSHELL_FOUND);
static_assert(ISOSHELL_VERSION_MAJOR == ISOSHELL_FOUND_MAJOR && ISOSHELL_VERSION_MINOR == ISOSHELL_FOUND_MINOR &&
              ISOSHELL_VERSION_PATCH == ISOSHELL_FOUND_PATCH);

extern "C" int remesh_file(const char* input, const char* output) {
  try {
    isoshell::Context context;
    isoshell::write_mesh(output, isoshell::remesh(isoshell::read_mesh(input), {}, context).mesh);
    return 0;
  } catch (const isoshell::Error& e) {
    return int(e.code());
  }
}
