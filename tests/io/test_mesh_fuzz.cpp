// Damaged files either give a sound soup or an Error: every truncation, and thousands of changed bytes.
#include "io/file_formats.h"
#include "isoshell/error.h"
#include "support/mesh_files.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

struct Sample {
  const char* name;
  TriangleSoup (*read)(const MeshSource&);
  std::string bytes;
};

std::vector<Sample> samples() {
  const TemporaryFolder folder;
  const TriangleSoup box = shapes::box({0, 0, 0}, {1, 2.5, 1e-3});
  const TriangleMesh mesh = {box.vertices, box.triangles};
  for (const char* name : {"a.obj", "a.off", "a.stl", "a.ply", "a.glb"}) write_mesh(folder / name, mesh);
  const std::string text_ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty double y\nproperty int z\nproperty uchar c\n"
      "element grid 2\nproperty list uchar int i\nelement face 2\nproperty list uchar int vertex_indices\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0 1\n1 0 0 1\n1 1 0 1\n0 1 0 1\n0\n"
      "1 5\n4 0 1 2 3\n3 0 1 2\n6 0 1 2 3 -1 1\n";
  std::string mixed_ply =
      "ply\nformat binary_big_endian 1.0\nelement vertex 3\nproperty short x\nproperty short y\nproperty short z\n"
      "property list uchar uchar t\nelement face 2\nproperty list ushort uchar vertex_index\nend_header\n";
  for (int i = 0; i < 3; ++i)
    mixed_ply += std::string("\0\1\1\0\0", 5) + char(i) + char(i) + std::string(size_t(i), 'x');
  mixed_ply += std::string("\0\3\0\1\2\0\4\0\1\2\1", 11);
  const std::string text_stl =
      "solid s\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid "
      "s\n";
  const std::string polygons =
      "v 0 0 0\nv 4 0 0 # c\nv 4 4 0\nv 2 1 \\\n0\nv 0 4 nan\nv 0 3 1e0\nf 1/1 2//3 3/4/5 4 6\nf -1 -2 -3\nf 1 2 3 4\n";
  return {{"obj", find_row("obj")->read, get_file(folder / "a.obj")},
          {"off", find_row("off")->read, get_file(folder / "a.off")},
          {"glb", find_row("gltf")->read, get_file(folder / "a.glb")},
          {"stl", find_row("stl")->read, get_file(folder / "a.stl")},
          {"ply", find_row("ply")->read, get_file(folder / "a.ply")},
          {"text ply", find_row("ply")->read, text_ply},
          {"mixed ply", find_row("ply")->read, mixed_ply},
          {"text stl", find_row("stl")->read, text_stl},
          {"polygons", find_row("obj")->read, polygons}};
}

// True when a soup came back; a soup that breaks its promises fails the test.
bool survives(const Sample& sample, const std::string& bytes) {
  try {
    // An allocation of exactly this size, so that a look beyond it is seen by a memory checker.
    const std::vector<char> exact(bytes.begin(), bytes.end());
    const MeshSource source("memory", {exact.data(), int64_t(exact.size())});
    const TriangleSoup soup = sample.read(source);
    bool sound = !soup.triangles.empty() && soup.dirt.unreferenced_vertices >= 0;
    for (const auto& t : soup.triangles)
      for (const uint32_t corner : t)
        sound = sound && corner < soup.vertices.size() && std::isfinite(soup.vertices[corner].x) &&
                std::isfinite(soup.vertices[corner].y) && std::isfinite(soup.vertices[corner].z);
    CHECK(sound);
    return true;
  } catch (const Error& error) {
    if (error.code() != ErrorCode::nothing_to_mesh && error.code() != ErrorCode::unreadable_input) FAIL(error.what());
    return false;
  }
}

}  // namespace

TEST_CASE("damaged files: the samples themselves are sound", "[mesh_file][unit]") {
  for (const Sample& sample : samples()) {
    INFO(sample.name);
    CHECK(survives(sample, sample.bytes));
  }
}

TEST_CASE("damaged files: every truncation is refused or gives a sound soup", "[mesh_file][unit]") {
  for (const Sample& sample : samples()) {
    INFO(sample.name);
    for (size_t length = 0; length < sample.bytes.size(); ++length) {
      const bool survived = survives(sample, sample.bytes.substr(0, length));
      // Whatever counts its rows or has an end mark notices the loss of a whole one.
      if (sample.read != find_row("obj")->read && length + 12 < sample.bytes.size()) CHECK_FALSE(survived);
    }
  }
}

TEST_CASE("damaged files: changed, lost and repeated bytes are refused or give a sound soup", "[mesh_file][unit]") {
  uint64_t draw = 0;
  for (const Sample& sample : samples()) {
    INFO(sample.name);
    for (int round = 0; round < 1000; ++round) {
      std::string bytes = sample.bytes;
      for (uint64_t damage = random_bits(7, draw++) % 4 + 1; damage > 0; --damage) {
        const uint64_t r = random_bits(7, draw++);
        const size_t at = size_t(r >> 8) % bytes.size();
        switch (r % 5) {
          case 0:
            bytes[at] = char(r >> 40);
            break;
          case 1:
            bytes[at] = char(bytes[at] ^ 1 << (r >> 40) % 8);
            break;
          case 2:
            bytes[at] = "0123456789-+.e \n/#\\"[(r >> 40) % 19];
            break;
          case 3:
            bytes.erase(at, 1 + (r >> 40) % 4);
            break;
          default:
            bytes.insert(at, bytes.substr(at, 1 + (r >> 40) % 8));
            break;
        }
        if (bytes.empty()) bytes = "x";
      }
      survives(sample, bytes);
    }
  }
}
