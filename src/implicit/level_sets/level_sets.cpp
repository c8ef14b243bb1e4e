// See level_sets.h.
#include "implicit/level_sets/level_sets.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

void check_lattice(const ScalarField& field, const LevelSets& sets) {
  const auto refuse = [](const std::string& text) { throw Error(ErrorCode::usage, "read", text); };
  const double edge_world = cube_edge(field.to_world);
  if (!(edge_world > 0))
    refuse(field.title() + " has voxels that are no cubes; level sets that are regions together have cubes");
  if (!(field.background > 0))
    refuse(field.title() +
           " has a background of 0 or less, which says nothing of what lies beyond its band; give it the width of "
           "the band");
  if (sets.blocks.empty()) return;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 4; ++j) {
      const double one = sets.to_world.at[i][j], other = field.to_world.at[i][j];
      if (std::abs(one - other) <= 1e-6 * edge_world) continue;
      std::ostringstream text;
      text << field.title() << " has another transform than " << sets.title << ": ";
      if (j == 3)
        text << "its voxel (0, 0, 0) lies at "
             << "xyz"[i] << " = " << other << ", not at " << one;
      else
        text << "its steps from voxel to voxel differ, " << other << " from " << one << " along "
             << "xyz"[i];
      text << "; resample one on the lattice of the other, as OpenVDB's resampleToMatch does";
      refuse(text.str());
    }
}

std::string beside(int64_t reference_bytes) {
  return reference_bytes > 0 ? ", the reference " + readable_bytes(reference_bytes) : "";
}

}  // namespace

int64_t LevelSets::bytes() const {
  int64_t bytes = 0;
  for (const DistanceBlocks& set : blocks) bytes += set.bytes();
  return bytes;
}

int64_t left_beside(const LevelSets& sets, int64_t memory_limit_bytes) {
  if (memory_limit_bytes <= 0) return 0;
  const int64_t left = memory_limit_bytes - sets.bytes() - sets.reference_bytes;
  if (left <= 0)
    throw Error(ErrorCode::out_of_memory, "read",
                sets.file + ": " + counted(int64_t(sets.blocks.size()), "level set") + " of those to be read take " +
                    readable_bytes(sets.bytes()) + beside(sets.reference_bytes) +
                    ", and nothing is left of the limit of " + readable_bytes(memory_limit_bytes) +
                    "; raise --max-memory, or resample them coarser");
  return left;
}

void add_level_set(const ScalarField& field, const std::string& name, int64_t memory_limit_bytes, LevelSets& sets) {
  check_lattice(field, sets);
  const int64_t left_bytes = left_beside(sets, memory_limit_bytes);
  if (sets.blocks.empty()) {
    sets.file = field.file;
    sets.title = field.title();
    sets.grid_class = field.grid_class;
    sets.to_world = field.to_world;
  }
  sets.blocks.emplace_back(field, cube_edge(sets.to_world), left_bytes);
  sets.names.push_back(name);
  sets.background = std::min(sets.background, field.background);
}

}  // namespace isoshell
