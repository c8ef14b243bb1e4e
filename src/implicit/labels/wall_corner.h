// How the walls between voxels of different labels meet at a corner of the lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace isoshell {

/// The eight voxels around a corner are its octants: octant o lies on the far side along x, y and z by its bits 0, 1
/// and
/// 2. The twelve faces between them are its arcs: arc 4 a + k is the face between the two octants that differ along
/// axis a, and k has the bits of the other axes in their order.
constexpr int kArcs = 12;

constexpr int arc_of(int octant, int axis) {
  const int low = octant & ((1 << axis) - 1), high = octant >> (axis + 1);
  return 4 * axis + (low | high << axis);
}

/// Four labels around an edge of the lattice, in turn. Where all four faces are walls and two voxels across from each
/// other have one label, walls of both of the other two voxels would touch in the edge. They are parted: the voxels of
/// one diagonal stay connected, and each of the other two has walls of its own. Connected are those of one label, and
/// of two pairs those of the smaller one.
struct WallEdge {
  bool is_wall[4];            ///< between label i and the next one
  bool is_parted = false;     ///< the walls are two pairs
  bool is_odd_alone = false;  ///< of parted ones: those around labels 1 and 3, else those around 0 and 2
  int walls = 0;

  explicit WallEdge(const std::array<int32_t, 4>& label) {
    for (std::size_t i = 0; i < 4; ++i) walls += is_wall[i] = label[i] != label[(i + 1) % 4];
    const bool is_even_pair = label[0] == label[2], is_odd_pair = label[1] == label[3];
    is_parted = walls == 4 && (is_even_pair || is_odd_pair);
    is_odd_alone = is_even_pair && (!is_odd_pair || label[0] < label[1]);
  }

  /// The pair that a wall belongs to: 0 around label 0 or 1, 1 around the one across; 0 where they are not parted.
  int pair_of(int wall) const { return is_parted && (is_odd_alone ? wall >= 2 : wall == 1 || wall == 2); }
};

/// The sheets of walls that meet at a corner, each of which gets a vertex of its own there: walls are of one sheet
/// where they share a lattice edge at the corner, and are not parted along it.
struct WallCorner {
  std::array<uint8_t, kArcs> sheet_of_arc;  ///< kNoSheet where the face is no wall
  int sheets = 0;

  static constexpr uint8_t kNoSheet = 255;
  explicit WallCorner(const std::array<int32_t, 8>& label);
};

}  // namespace isoshell
