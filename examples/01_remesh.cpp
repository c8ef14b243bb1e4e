// A mesh file in, an isotropic mesh file out.
#include <iostream>

#include "isoshell/isoshell.h"

int main(int argc, char* argv[]) {
  if (argc < 3) return 2;
  try {
    isoshell::Context context;  // threads, device, memory limit, progress, cancel
    isoshell::RemeshOptions options;
    options.vertices = 4000;
    const isoshell::TriangleSoup scan = isoshell::read_mesh(argv[1]);
    const isoshell::RemeshResult result = isoshell::remesh(scan, options, context);
    isoshell::write_mesh(argv[2] + std::string(".ply"), result.mesh, {"ply", true});
    std::cout << "mean quality " << isoshell::measure_quality(result.mesh).q_avg << "\n";
  } catch (const isoshell::Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
