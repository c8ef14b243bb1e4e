// A mesh in the program's own arrays is remeshed, and the result once more, coarser.
#include <iostream>
#include <vector>

#include "isoshell/isoshell.h"

namespace {

/// As a program for graphics has its vertices.
struct Vertex {
  float position[3], normal[3];
};

}  // namespace

int main(int argc, char* argv[]) {
  if (argc < 3) return 2;
  try {
    const isoshell::TriangleSoup scan = isoshell::read_mesh(argv[1]);
    std::vector<Vertex> vertices;
    for (const isoshell::WorldPoint& p : scan.vertices)
      vertices.push_back({{float(p.x), float(p.y), float(p.z)}, {0, 0, 1}});
    std::vector<int> corners;
    for (const auto& triangle : scan.triangles) corners.insert(corners.end(), triangle.begin(), triangle.end());

    // Nothing is copied yet: the view says where positions and corners are, and how many bytes apart.
    const isoshell::MeshView view{
        isoshell::rows_of_three(vertices[0].position, int64_t(vertices.size()), sizeof(Vertex)),
        isoshell::rows_of_three(corners.data(), int64_t(corners.size()) / 3)};

    isoshell::Context context;
    isoshell::RemeshOptions options;
    options.vertices = 4000;
    const isoshell::TriangleMesh fine = isoshell::remesh(isoshell::soup_of(view, "scan"), options, context).mesh;
    options.vertices = 1000;
    const isoshell::TriangleMesh coarse = isoshell::remesh(fine, options, context).mesh;
    isoshell::write_mesh(argv[2] + std::string(".ply"), coarse, {"ply", true});
    std::cout << "isoshell " << ISOSHELL_VERSION << ": " << fine.vertices.size() << " vertices, then "
              << coarse.vertices.size() << "\n";
  } catch (const isoshell::Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
