// The faces of an input as walls: triangles that are there once, whatever faces of the input lie on them.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "isoshell/advanced/buffer.h"
#include "repair/arrangement/arrange_faces.h"

namespace isoshell::repair {

/// A face of the input that lies on a wall.
struct FaceOnWall {
  uint32_t source;  ///< its number in the input
  bool is_turned;   ///< it faces to the back of the wall
};

/// Any two walls meet in corners and edges that they share, or not at all: on the lattice that they were arranged on.
struct Walls {
  WorldBox box;                                   ///< of this lattice
  std::vector<WorldPoint> point;                  ///< ascending
  std::vector<std::array<uint32_t, 3>> triangle;  ///< corners ascending: their order says where the front is
  std::vector<FaceOnWall> on_wall;                ///< wall by wall, ascending by source
  std::vector<uint32_t> first;                    ///< per wall its first of `on_wall`, and one more

  View<const FaceOnWall> faces_on(size_t wall) const {
    return {on_wall.data() + first[wall], int64_t(first[wall + 1] - first[wall])};
  }
};

/// Cost: sorts of vertices and faces.
Walls find_walls(const ArrangedFaces& faces);

}  // namespace isoshell::repair
