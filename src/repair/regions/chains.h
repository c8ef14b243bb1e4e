// The walls of each part, and whether they close it.
#pragma once

#include <cstdint>
#include <vector>

#include "isoshell/backend.h"
#include "repair/regions/parts.h"
#include "repair/regions/walls.h"

namespace isoshell::repair {

/// A part on a wall: its faces there.
struct PartOnWall {
  uint32_t part;
  int8_t turns;  ///< 1: it faces to the wall's front, -1: to its back, 0: to both
};

/// What says where the inside of a part is.
enum class Closing : uint8_t {
  oriented,  ///< its faces, which all look to one of the sides: a crossing counts one up or down
  even,      ///< its faces, whichever way they look: a crossing changes sides; those that look both ways count twice
  present,   ///< the same, where those that look both ways count once; the first to be asked where all do
  open,      ///< nothing: some edge has one of its faces, or three
};

struct PartOutline {
  Closing closing = Closing::oriented;
  double area_world = 0;
  int64_t open_edges = 0;       ///< of an open part, with an odd number of its walls
  double open_edges_world = 0;  ///< their length
  WorldPoint at = {0, 0, 0};    ///< the middle of the first of them
};

struct Chains {
  std::vector<PartOnWall> on_wall;  ///< wall by wall, ascending by part
  std::vector<uint32_t> first;      ///< per wall its first of `on_wall`, and one more
  std::vector<PartOutline> part;

  View<const PartOnWall> parts_on(size_t wall) const {
    return {on_wall.data() + first[wall], int64_t(first[wall + 1] - first[wall])};
  }
};

/// Throws: interrupted. Cost: a sort of the edges.
Chains find_chains(const Walls& walls, const Parts& parts, const Context& context);

}  // namespace isoshell::repair
