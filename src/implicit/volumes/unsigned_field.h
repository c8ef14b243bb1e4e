// Unsigned distances: told from other fields, and given the signs of the sides of their zero set.
#pragma once

#include <memory>
#include <string>

#include "implicit/volumes/scalar_field.h"

namespace isoshell {

constexpr double kFullPart = 0.999;  ///< of the background: values from here on say only that they are beyond the band

/// What the values of a field are as distances.
struct DistanceKind {
  double voxel = 0;  ///< the distance from a lattice point to the next one, in the field's values; 0: no distances
  std::string why;   ///< what speaks against distances, for a message
};

/// For a field without negative values. Distances are in world units or in voxels: most values of more than a voxel's
/// length rise by it a voxel, and some values are smaller than it. Cost: linear in the blocks.
DistanceKind kind_of_distance(const ScalarField& field);

/// The field with signs: negative inside of the closed surface that its zero set is or nearly is.
struct SignedSides {
  std::unique_ptr<ScalarField> field;
  double enclosing_part = 0;  ///< of the zero set: what lies between inside and outside
};

/// Which side a lattice point lies on. Neighbours whose distances sum up to more than a voxel are on one side of a
/// surface without holes. Such edges are therefore taken from the largest sum down, as in a watershed, to grow regions;
/// two regions that both go deeper than the place where they meet stay apart, whether a hole or a wall is there. Then
/// every pair of regions in contact is the same side or two sides, as most of the edges between them say: sums above a
/// voxel speak for one side, others for two. The pairs with the clearest majority are believed first; later ones that
/// contradict them are passed over. So holes are closed where their surroundings agree, and hollows are outside again.
/// The one field is unique: ties go by the order of the lattice points. `field` must outlive the result.
/// Cost: a sort of the edges near the zero set, else linear in the blocks; up to 34 bytes a point of the blocks.
/// Throws: out_of_memory over the limit, where one is given.
SignedSides find_sides(const ScalarField& field, double voxel, int64_t memory_limit_bytes);

}  // namespace isoshell
