// vdb_isomesh: the command.
#include "isoshell/isoshell.h"

int main() { return 0; }
