// The union of a file's components alone: JSON with its CPU time, faces, volume, genus, and what it reports.
// Usage: bench_unions MESH [OUT.ply [GAP]]
#include <algorithm>
#include <cstdlib>
#include <ctime>
#include <iostream>
#include <nlohmann/json.hpp>

#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/io/mesh_file.h"

int main(int argc, char** argv) {
  using namespace isoshell;
  if (argc < 2) {
    std::cerr << "usage: bench_unions MESH [OUT.ply [GAP]]\n";
    return 2;
  }
  const TriangleSoup soup = read_mesh(argv[1]);
  Context context;
  context.threads = 1;
  UnionReport report;
  UnionOptions options;
  options.sheet_gap_world = argc > 3 ? std::atof(argv[3]) : 0;
  UnitedSoup united;
  std::clock_t least = 0;
  for (int run = 0; run < 5; ++run) {  // others on the machine only make it longer
    const std::clock_t begin = std::clock();
    united = boolean_union(soup, options, report, context);
    const std::clock_t taken = std::clock() - begin;
    least = run == 0 ? taken : std::min(least, taken);
  }
  const InputTopology topology = measure_topology(united.soup, context).topology;
  double volume6 = 0;
  for (const auto& t : united.soup.triangles) {
    const WorldPoint &a = united.soup.vertices[t[0]], &b = united.soup.vertices[t[1]], &c = united.soup.vertices[t[2]];
    volume6 += a.x * (b.y * c.z - b.z * c.y) + a.y * (b.z * c.x - b.x * c.z) + a.z * (b.x * c.y - b.y * c.x);
  }
  if (argc > 2) write_mesh(argv[2], {united.soup.vertices, united.soup.triangles});
  std::cout << nlohmann::json{{"cpu_seconds", double(least) / CLOCKS_PER_SEC},
                              {"faces_before", soup.triangles.size()},
                              {"faces", united.soup.triangles.size()},
                              {"volume", volume6 / 6},
                              {"closed", topology.closed},
                              {"components", topology.components},
                              {"genus", topology.genus},
                              {"turned", report.turned_components},
                              {"separated_edges", report.separated_edges},
                              {"given_up", report.given_up}}
                   .dump()
            << '\n';
}
