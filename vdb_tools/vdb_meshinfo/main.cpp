// vdb_meshinfo: the certificate of any mesh.
#include "vdb_isomesh/missing_threads.h"
#include "vdb_meshinfo/command.h"

ISOSHELL_ANSWERS_MISSING_THREADS("vdb_meshinfo");

int main(int argc, char* argv[]) { return isoshell::tool::mesh_info_command(argc, argv); }
