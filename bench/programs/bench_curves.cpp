// What is found of borders and creases, per mesh: one row each, JSON on standard output.
//   bench_curves MESH... [--vertices K] [--degrees DEG]
#include <cmath>
#include <string>
#include <vector>

#include "bench/programs/program.h"
#include "features/curves/face_normals.h"
#include "features/curves/find_curves.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/isoshell.h"

using namespace isoshell;
using nlohmann::json;

namespace {

struct Arguments {
  std::vector<std::string> meshes;
  double vertices = 10000, degrees = 0;
};

Arguments parse(int argc, char** argv) {
  Arguments a;
  a.meshes = bench::read_arguments(argc, argv, "bench_curves MESH...", 1,
                                   {{"--vertices", "K", &a.vertices}, {"--degrees", "DEG", &a.degrees}});
  return a;
}

double area_of(const FeatureMesh& mesh) {
  double area = 0;
  for (const auto& t : mesh.triangles)
    area += triangle_area(mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]]);
  return area;
}

/// Number and length of the inner edges whose triangles turn by so many degrees or more.
struct SharpEdges {
  int64_t count = 0;
  double length_world = 0;
};
SharpEdges sharp_edges(const FeatureMesh& mesh, double degrees) {
  const MeshEdges edges = find_mesh_edges(mesh);
  const Buffer<WorldPoint> normals = face_normals(mesh, edges);
  SharpEdges sharp;
  for (const FeatureEdge& e : edges.edges) {
    if (e.use != EdgeUse::inner || turn_between(normals[e.face[0]], normals[e.face[1]]) < turn_of_degrees(degrees))
      continue;
    ++sharp.count;
    sharp.length_world += length(mesh.vertices[e.end[1]] - mesh.vertices[e.end[0]]);
  }
  return sharp;
}

json row_of(const std::string& path, const Arguments& args) {
  const TriangleSoup soup = read_mesh(path);
  const bench::Watch watch;
  const FeatureMesh mesh = weld_for_features(soup);
  CurveOptions options;
  if (args.degrees > 0) {
    options.mode = CreaseMode::threshold;
    options.degrees = args.degrees;
  }
  // K vertices have 2 K equilateral triangles.
  options.edge_length_world = std::sqrt(area_of(mesh) / args.vertices * 2 / std::sqrt(3.));
  CreaseReport report;
  const CurveNetwork found = find_curves(mesh, options, &report);
  const double ms = watch.ms();

  int64_t borders = 0, creases = 0, loops = 0;
  for (const FeatureCurve& c : found.curves) {
    borders += c.kind == CurveKind::border;
    creases += c.kind == CurveKind::crease;
    loops += c.is_loop;
  }
  const double sharp_world = sharp_edges(mesh, 40).length_world;
  return {{"mesh", bench::file_name(path)},
          {"triangles", mesh.triangles.size()},
          {"edge_length", options.edge_length_world},
          {"edges_above_30", sharp_edges(mesh, 30).count},
          {"curves", found.curves.size()},
          {"borders", borders},
          {"creases", creases},
          {"loops", loops},
          {"corners", found.corners.size()},
          {"crease_length_of_40", sharp_world > 0 ? report.kept_length_world / sharp_world : 0},
          {"components_with_candidates", report.components_with_candidates},
          {"components_without_creases", report.components_without_creases},
          {"ms", ms}};
}

}  // namespace

int main(int argc, char** argv) try {
  const Arguments args = parse(argc, argv);
  json rows = json::array();
  for (const std::string& mesh : args.meshes) rows.push_back(row_of(mesh, args));
  bench::print_result({{"bench", "curves"}, {"vertices", args.vertices}, {"rows", rows}});
} catch (const std::exception& e) {
  return bench::failed(argv[0], e);
}
