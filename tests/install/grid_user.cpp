// A program with a grid of OpenVDB in memory: its mesh, the level set of that, and both again by NanoVDB.
//   grid_user OUT.ply
#include <openvdb/tools/LevelSetSphere.h>

#include <cstdio>

#include "isoshell/isoshell.h"
#include "isoshell/nanovdb.h"
#include "isoshell/openvdb.h"

using namespace isoshell;

int main(int, char** arguments) {
  try {
    openvdb::initialize();
    const auto ball = openvdb::tools::createLevelSetSphere<openvdb::FloatGrid>(2.f, openvdb::Vec3f(0), .1f, 3.f);
    Context context;
    RemeshOptions options;
    options.vertices = 500;
    const Input input = input_of(read_grid(*ball), "ball", {}, context);
    const TriangleMesh mesh = remesh(input.soup, options, context).mesh;
    write_mesh(arguments[1], mesh);

    options.level_set_band_vox = 3;
    const LevelSet distances = level_set(prepare(mesh, options, context), 3, context);
    const openvdb::FloatGrid::Ptr grid = to_openvdb(distances);
    const auto handle = to_nanovdb(distances);
    int64_t inside = 0;
    for_each_voxel(distances.voxels, [&](Voxel, int64_t i) { inside += distances.distance_vox[i] < 0; });
    const size_t triangles = input_of(read_grid(handle), "ball", {}, context).soup.triangles.size();
    std::printf("%zu vertices, %lld of %llu voxels inside\n", mesh.vertices.size(), static_cast<long long>(inside),
                static_cast<unsigned long long>(grid->activeVoxelCount()));
    const bool is_same = triangles == input_of(read_grid(*grid), "ball", {}, context).soup.triangles.size();
    return mesh.vertices.size() == 500 && inside > 0 && is_same ? 0 : 1;
  } catch (const Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return int(error.code());
  }
}
