// What the blocks of cells own of a field's surface.
#pragma once

#include <optional>
#include <utility>
#include <vector>

#include "implicit/volumes/scalar_field.h"
#include "voxel/leaf.h"

namespace isoshell {

/// What a block of cells owns: lattice edges that begin in it, by axis and corner, and the middles of patches.
struct CellBlock {
  uint64_t cut[3][8] = {};
  uint32_t cuts = 0, middles = 0, triangles = 0, cells = 0, unknown_values = 0, unknown_cells = 0, jumps = 0;
  int first_unknown = 0;  ///< of the cells
  int64_t first_vertex = 0, first_triangle = 0;

  /// Which of the block's vertices lies on an edge.
  uint32_t rank(int axis, int offset) const {
    uint32_t count = 0;
    for (int a = 0; a <= axis; ++a)
      for (int w = 0; w < (a < axis ? 8 : offset >> 6); ++w) count += uint32_t(popcount64(cut[a][w]));
    return count + uint32_t(popcount64(cut[axis][offset >> 6] & ((uint64_t(1) << (offset & 63)) - 1)));
  }
};

/// The end on the field's sides of an edge that leaves them.
inline std::optional<Voxel> end_at_side(const ScalarField& field, Voxel from, int axis) {
  if (!field.sides) return {};
  const Voxel to{from.x + (axis == 0), from.y + (axis == 1), from.z + (axis == 2)};
  if (field.sides->hold(from) == field.sides->hold(to)) return {};
  return field.sides->hold(from) ? from : to;
}

/// Pairs of vertices on edges that leave the field's sides at the same point; of each point the first one is the second
/// of its pairs. `origin`: of the blocks. Cost: a sort of those vertices.
std::vector<std::pair<uint32_t, uint32_t>> same_at_sides(const ScalarField& field, const std::vector<Voxel>& origin,
                                                         const std::vector<CellBlock>& cell);

}  // namespace isoshell
