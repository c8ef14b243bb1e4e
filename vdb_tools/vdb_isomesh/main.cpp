// vdb_isomesh: the command.
#include "vdb_isomesh/command.h"

int main(int argc, char* argv[]) { return isoshell::tool::command(argc, argv); }
