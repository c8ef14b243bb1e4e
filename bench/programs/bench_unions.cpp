// The union of a file's components alone: JSON with its time, faces, volume, genus, and what it reports.
// Usage: bench_unions MESH [OUT.ply]
#include <chrono>
#include <iostream>
#include <nlohmann/json.hpp>

#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "isoshell/io/mesh_file.h"

int main(int argc, char** argv) {
  using namespace isoshell;
  if (argc < 2) {
    std::cerr << "usage: bench_unions MESH [OUT.ply]\n";
    return 2;
  }
  const TriangleSoup soup = read_mesh(argv[1]);
  Context context;
  context.threads = 1;
  UnionReport report;
  const auto begin = std::chrono::steady_clock::now();
  const UnitedSoup united = boolean_union(soup, {}, report, context);
  const std::chrono::duration<double> taken = std::chrono::steady_clock::now() - begin;
  const InputTopology topology = measure_topology(united.soup, context).topology;
  double volume6 = 0;
  for (const auto& [a, b, c] : united.soup.triangles)
    volume6 += dot(united.soup.vertices[a], cross(united.soup.vertices[b], united.soup.vertices[c]));
  if (argc > 2) write_mesh(argv[2], {united.soup.vertices, united.soup.triangles});
  std::cout << nlohmann::json{{"seconds", taken.count()},
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
