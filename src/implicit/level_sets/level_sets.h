// Level sets of one lattice, each held as blocks of values in voxels.
#pragma once

#include <string>
#include <vector>

#include "implicit/level_sets/distance_blocks.h"
#include "implicit/volumes/scalar_field.h"

namespace isoshell {

struct LevelSets {
  std::vector<DistanceBlocks> blocks;
  std::vector<std::string> names;       ///< that their regions get
  std::vector<std::string> warnings;    ///< of what was read
  std::string file, title, grid_class;  ///< of the first one
  AffineMap to_world;
  double background = INFINITY;  ///< the least
  int64_t reference_bytes = 0;   ///< of the surface that is held beside them

  int64_t bytes() const;  ///< without those of the reference
};

/// What is left of a limit in bytes beside these; 0 where there is no limit. Throws: out_of_memory where nothing is.
int64_t left_beside(const LevelSets& sets, int64_t memory_limit_bytes);

/// Adds its blocks. Throws: usage for another transform than the first one's, voxels that are no cubes, or a background
/// that says nothing of what lies beyond the band; and as DistanceBlocks does, which takes what is left of the limit.
void add_level_set(const ScalarField& field, const std::string& name, int64_t memory_limit_bytes, LevelSets& sets);

}  // namespace isoshell
