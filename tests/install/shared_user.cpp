// What a module of another language does: one function of its own in a shared library, around the whole run.
#include "isoshell/isoshell.h"

extern "C" int remesh_file(const char* input, const char* output) {
  try {
    isoshell::Context context;
    isoshell::write_mesh(output, isoshell::remesh(isoshell::read_mesh(input), {}, context).mesh);
    return 0;
  } catch (const isoshell::Error& e) {
    return int(e.code());
  }
}
