// The density of the paper's energy: edge lengths to aim at, as steps see them. For cells of a surface, a length L
// takes a density of L^-4 and L^-2 seeds an area.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "voxel/exact_int.h"

namespace isoshell {

/// Lengths per sheet vertex, or none where all are equal. Only their ratios to the least one count.
struct EdgeLengthsView {
  View<const uint32_t> at;
  uint32_t least, largest;

  ISOSHELL_HD bool vary() const { return at.size > 0; }

  /// The least length over that of a triangle, the mean of its corners', in 1/65536: at most 65536.
  ISOSHELL_HD uint64_t ratio_q16(TriangleIndices t) const {
    return (uint64_t(3 * uint64_t(least)) << 16) / (uint64_t(at[t.a]) + at[t.b] + at[t.c]);
  }

  /// A triangle's share of the seeds: its doubled area over the square of its length, the least being 1.
  ISOSHELL_HD int64_t share_of_seeds(int64_t area2, TriangleIndices t) const {
    if (!vary()) return area2;
    const int64_t r = int64_t(ratio_q16(t));
    return ((area2 * r >> 16) * r + (1 << 15)) >> 16;
  }

  /// The density where lengths are least is 4: patches of a device take no more.
  static constexpr int kDensityBits = 2;

  /// A triangle's mass: its doubled area times the density.
  ISOSHELL_HD uint32_t mass(uint32_t area2, TriangleIndices t) const {
    if (!vary()) return area2;
    constexpr int kGuardBits = 8;
    const uint64_t r = ratio_q16(t);
    uint64_t m = uint64_t(area2) << (kDensityBits + kGuardBits);
    for (int power = 0; power < 4; ++power) m = m * r >> 16;
    m = (m + (1 << (kGuardBits - 1))) >> kGuardBits;
    return m < UINT32_MAX ? uint32_t(m) : UINT32_MAX;
  }

  /// What is `at_least` where lengths are least, at a vertex.
  ISOSHELL_HD int64_t scaled(int64_t at_least, uint32_t vertex) const {
    return vary() ? at_least * at[vertex] / least : at_least;
  }
};

inline EdgeLengthsView lengths_of(const SurfaceMesh& surface) {
  return {surface.lengths.at.view(), surface.lengths.least, surface.lengths.largest};
}

}  // namespace isoshell
