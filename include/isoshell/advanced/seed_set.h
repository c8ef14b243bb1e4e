// Seeds: the generators of the Voronoi cells, one per output vertex.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Seeds on the borders of a surface, which stay where they are: along every border, one after the other. A place where
/// patches meet has a fixed seed in each of them, which together become one vertex of the result.
struct FixedSeeds {
  int64_t count = 0;           ///< seeds 0 to count - 1 are fixed
  Buffer<uint32_t> of_vertex;  ///< per vertex of the surface the fixed seed whose cell it is in; kNone off borders
  Buffer<uint32_t> joined;     ///< per fixed seed the smallest fixed id at its place: they are one vertex of the result
};

/// Seed ids are indices and never change while relaxing. Repair may append, and drop seeds again; ids then close up.
struct SeedSet {
  Buffer<PointQ8> position;
  Buffer<Normal8> normal;  ///< side of the sheet (method sheet) or of the surface (method shell) the seed sits on
  Buffer<uint32_t> home;   ///< sheet vertex nearest to the seed (method sheet) or site of its voxel (method shell)
  FixedSeeds fixed;        ///< none on a closed surface

  int64_t size() const { return position.size(); }
};

}  // namespace isoshell
