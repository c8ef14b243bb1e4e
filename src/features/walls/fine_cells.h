// A relaxed mesh in which some cells are replaced by the fine triangles that they were made from.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "features/angles/patch_mesh.h"
#include "features/cutting/curve_edges.h"
#include "features/walls/wall_mesh.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// The dual mesh is the fine mesh with every cell contracted into its seed. Where some cells are left as they are, the
/// mesh is the fine one there, and the relaxed one elsewhere, but for a fan of triangles from each contracted seed to
/// the fine vertices beside it. Vertices of the relaxed mesh, copies of a fixed seed joined, are called seeds here, and
/// have the numbers that they have in its PatchMesh. In host memory.
class FineCells {
 public:
  /// `relaxed`: the mesh of `made`, in which edges of `dual` were flipped and vertices moved. `cell`: per vertex of the
  /// surface the vertex of `made` whose cell it is in. `is_optimized`: per patch whether its vertices were moved.
  /// `cut`, `relaxed` and `is_optimized` must outlive it. Cost: sorts of the triangles.
  FineCells(const CutSurface& cut, const SeededMesh& made, const PatchMesh& relaxed,
            const std::vector<TriangleIndices>& dual, const std::vector<uint32_t>& cell,
            const std::vector<char>& is_optimized);

  /// Of a vertex of `made`.
  uint32_t seed_of(uint32_t vertex) const { return joined_[vertex]; }
  /// From now on the cells of these seeds are left as they are, and those beside them. Cost: O(fine triangles).
  void add(const std::vector<uint32_t>& seeds);
  /// How many cells are left as they are.
  int64_t count() const { return fine_count_; }

  struct Mesh {
    WallMesh mesh;
    std::vector<uint32_t> seed;  ///< per vertex the one that it is, kNone for a fine one
  };
  /// Seeds that were optimised, or are on curves, are settled. Cost: O(fine triangles), and a sort of the edges of
  /// curves.
  Mesh mesh() const;

 private:
  using Corners = std::array<uint32_t, 3>;
  /// A triangle that only one of the relaxed mesh and the dual has. Those of a group fill the same hole in either way.
  struct Changed {
    Corners corner;
    uint32_t group = 0, patch = 0;
    bool is_relaxed = false;
  };
  struct Vertices {
    std::vector<RegionVertex> vertex;
    std::vector<uint32_t> seed, becomes;
  };

  uint32_t seed_at(size_t fine_corner) const { return seed_[cut_.corner[fine_corner]]; }
  void list_changed(const SeededMesh& made, const std::vector<TriangleIndices>& dual);
  void group_changed();
  std::vector<char> active_groups() const;
  Vertices vertices() const;
  std::vector<RegionTriangle> relaxed_triangles(const CurveEdges& edges) const;

  const CutSurface& cut_;
  const PatchMesh& relaxed_;
  const std::vector<char>& is_optimized_;
  std::vector<uint32_t> joined_;  ///< per vertex of the open mesh
  std::vector<uint32_t> seed_;    ///< per vertex of the surface whose cell it is in
  std::vector<char> is_fine_;     ///< per seed
  int64_t fine_count_ = 0;
  std::vector<Changed> changed_;  ///< ascending by corners
};

}  // namespace isoshell
