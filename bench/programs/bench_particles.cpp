// The part of the points of clouds that have no flat neighbourhood: one row of a table each.
//   bench_particles CLOUD...
#include <cstdio>

#include "bench/programs/program.h"
#include "implicit/points/unflat_points.h"
#include "isoshell/io/point_file.h"

int main(int argc, char** argv) {
  using namespace isoshell;
  for (const std::string& path : bench::read_arguments(argc, argv, "bench_particles CLOUD...", 1, {})) {
    const PointCloud cloud = read_points(path);
    const double part = unflat_part(cloud.position, PointTree(cloud.position));
    std::printf("| %s | %zu | %.1f |\n", path.substr(path.rfind('/') + 1).c_str(), cloud.position.size(), 100 * part);
  }
}
