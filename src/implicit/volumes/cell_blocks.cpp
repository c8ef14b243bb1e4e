#include "implicit/volumes/cell_blocks.h"

#include <tbb/parallel_sort.h>

#include "implicit/volumes/tile_borders.h"

namespace isoshell {

std::vector<std::pair<uint32_t, uint32_t>> same_at_sides(const ScalarField& field, const std::vector<Voxel>& origin,
                                                         const std::vector<CellBlock>& cell) {
  std::vector<std::pair<uint32_t, uint32_t>> same;
  if (!field.sides) return same;
  std::vector<std::pair<Voxel, uint32_t>> at_sides;
  for (size_t b = 0; b < origin.size(); ++b) {
    if (field.sides->hold_block(origin[b])) continue;
    auto vertex = uint32_t(cell[b].first_vertex);
    for (int axis = 0; axis < 3; ++axis)
      for (int word = 0; word < 8; ++word)
        for (uint64_t bits = cell[b].cut[axis][word]; bits; bits &= bits - 1, ++vertex) {
          const int offset = word * 64 + lowest_bit(bits);
          const Voxel from{origin[b].x + (offset >> 6), origin[b].y + (offset >> 3 & 7), origin[b].z + (offset & 7)};
          if (const auto at = end_at_side(field, from, axis)) at_sides.push_back({*at, vertex});
        }
  }
  tbb::parallel_sort(at_sides.begin(), at_sides.end(), [](const auto& a, const auto& b) {
    return a.first == b.first ? a.second < b.second : comes_before(a.first, b.first);
  });
  for (size_t i = 1, first = 0; i < at_sides.size(); ++i)
    if (at_sides[i].first == at_sides[first].first)
      same.push_back({at_sides[i].second, at_sides[first].second});
    else
      first = i;
  return same;
}

}  // namespace isoshell
