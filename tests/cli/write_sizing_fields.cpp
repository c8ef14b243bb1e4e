// Writes what bench/results/sizing_cpu.md measures with into a folder: a ball, ball.off, and edge lengths on it that
// vary 8 : 1, ball.vdb.
#include "cli/command.h"
#include "support/sizing_fields.h"

int main(int argc, char* argv[]) {
  if (argc != 2) return 2;
  const std::string folder = argv[1];
  isoshell::write_grids(folder + "/ball.vdb", {isoshell::ball_sizing(0.02, 8)});
  isoshell::cli::write_off(folder + "/ball.off", isoshell::shapes::sphere({0, 0, 0}, 1, 300));
}
