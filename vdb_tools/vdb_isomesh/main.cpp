// vdb_isomesh: the command.
#include "vdb_isomesh/command.h"
#include "vdb_isomesh/memory.h"

int main(int argc, char* argv[]) {
  isoshell::tool::give_back_linker_pages();
  return isoshell::tool::command(argc, argv);
}
