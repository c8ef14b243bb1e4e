// vdb_isomesh: the command.
#include "vdb_isomesh/command.h"
#include "vdb_isomesh/missing_threads.h"

ISOSHELL_ANSWERS_MISSING_THREADS("vdb_isomesh");

int main(int argc, char* argv[]) { return isoshell::tool::command(argc, argv); }
