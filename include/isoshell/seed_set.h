// Seeds: the generators of the Voronoi cells, one per output vertex.
#pragma once

#include "isoshell/buffer.h"
#include "isoshell/lattice.h"

namespace isoshell {

/// Seed ids are indices and never change while relaxing. Repair may append, and drop seeds again; ids then close up.
struct SeedSet {
  Buffer<PointQ8> position;
  Buffer<Normal8> normal;  ///< side of the sheet (method sheet) or of the surface (method shell) the seed sits on
  Buffer<uint32_t> home;   ///< sheet vertex nearest to the seed (method sheet) or site of its voxel (method shell)

  int64_t size() const { return position.size(); }
};

}  // namespace isoshell
