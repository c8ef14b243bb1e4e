// Some patches of a cut surface on their own.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "features/cutting/cut_fine_mesh.h"
#include "features/cutting/cut_piece.h"
#include "isoshell/mesh_topology.h"
#include "pipeline/defects/flat_patches.h"
#include "support/catch.h"
#include "support/feature_shapes.h"
#include "support/made_patches.h"
#include "support/open_surfaces.h"

using namespace isoshell;

namespace {

using Made = MadePatches;

Made made_of(const FeatureShape& shape, Context& context) {
  Made made = made_patches(shape, 20, context);
  REQUIRE(made.mesh.report.failed_cells == 0);
  return made;
}

/// Triangles by the positions of their corners: what does not depend on how seeds are numbered.
using Corners = std::array<std::array<int32_t, 3>, 3>;
std::vector<Corners> corners_of(const DualMesh& mesh) {
  std::vector<Corners> out;
  for (const TriangleIndices& t : mesh.triangles) {
    Corners corners;
    for (size_t i = 0; i < 3; ++i) {
      const PointQ8 p = mesh.position[i == 0 ? t.a : i == 1 ? t.b : t.c];
      corners[i] = {p.x, p.y, p.z};
    }
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::vector<char> every_second(size_t count) {
  std::vector<char> flags(count);
  for (size_t i = 0; i < count; ++i) flags[i] = i % 2 == 0;
  return flags;
}
std::vector<char> inverse(std::vector<char> flags) {
  for (char& flag : flags) flag = !flag;
  return flags;
}

MeshTopology joined_topology(const Made& made) {
  return check_mesh(to_world(join_patches(made.mesh.mesh, made.mesh.seeds.fixed).mesh, made.cut.frame));
}

}  // namespace

TEST_CASE("pieces: a mesh of every second patch goes to a piece and back", "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : {feature_cube(), feature_cylinder(40)}) {
    INFO(shape.name);
    const Made made = made_of(shape, context);
    const std::vector<char> chosen = every_second(patch_count(made.cut));
    const CutPiece piece = piece_of(made.cut, chosen, context);
    CHECK(patch_count(piece.cut) == size_t(std::count(chosen.begin(), chosen.end(), 1)));
    for (size_t v = 0; v < piece.in_whole.size(); ++v) {
      const PointQ8 p = piece.cut.surface.position[int64_t(v)], q = made.cut.surface.position[piece.in_whole[v]];
      CHECK((p.x == q.x && p.y == q.y && p.z == q.z));
      CHECK(chosen[made.cut.surface.patch[piece.in_whole[v]]]);
    }
    const SeededMesh part = gather_patches(piece.cut, {{made.mesh, in_piece(piece, made.cut)}});
    CHECK(part.mesh.triangles.size() < made.mesh.mesh.triangles.size());
    const SeededMesh back =
        gather_patches(made.cut, {{part, piece.in_whole}, {made.mesh, vertices_in(made.cut, inverse(chosen))}});
    CHECK(back.seeds.size() == made.mesh.seeds.size());
    CHECK(corners_of(back.mesh) == corners_of(made.mesh.mesh));
  }
}

TEST_CASE("pieces: patches in a plane have triangles there, and others are left as they are", "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : {feature_cube(), feature_cylinder(40), feature_plate()}) {
    INFO(shape.name);
    Made made = made_of(shape, context);
    const MeshTopology before = joined_topology(made);
    const std::vector<char> all(patch_count(made.cut), 1);
    const std::vector<char> done = triangulate_flat(made.cut, all, made.mesh);
    const auto flat = size_t(std::count(done.begin(), done.end(), 1));
    CHECK(flat == (shape.name == feature_cylinder(40).name ? all.size() - 1 : all.size()));
    const MeshTopology after = joined_topology(made);
    CHECK(after.is_closed_manifold() == before.is_closed_manifold());
    CHECK(after.genus == before.genus);
  }
}
