// The surface on which a scalar field has one value.
#pragma once

#include <memory>
#include <optional>

#include "implicit/volumes/scalar_field.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/surface_source.h"

namespace isoshell {

struct ValueRange {
  float low, high;
  std::optional<Voxel> unknown;  ///< the first of the points whose values are no numbers
};
/// Over blocks, tiles and background.
ValueRange value_range(const ScalarField& field);

/// Throws: unreadable_input for a block or tile farther out than kFieldReach.
void check_reach(const ScalarField& field, Voxel origin);

/// Values that are not numbers, or jump.
struct UnknownValues {
  int64_t values = 0;  ///< in blocks that the surface may cross
  int64_t cells = 0;   ///< that the surface crosses, and has no triangles in, as a value of theirs is not known
  WorldPoint first_world{0, 0, 0};  ///< the middle of the first of them
  double jumping_part = 0;          ///< of the cells that the surface crosses, those in which values jump
};

/// Marching cubes over the cells of the lattice. Result: every edge of a triangle belongs to two triangles, which run
/// through it in opposite directions, but on the borders that it has where values are not known and at open sides;
/// vertices lie on lattice edges, where the trilinear field has the value, and at the middle of patches of six and more
/// corners. Closed sides are flat, with vertices at their lattice points. Outside is where the background lies. Cost:
/// linear in the blocks. Throws: nothing_to_mesh without a crossing, out_of_memory beyond 32-bit indices or the limit,
/// where one is given. Creases have vertices of their own where they are wanted and values are distances; where bodies
/// are not sharp, asking for theirs costs a look at the cut cells, and changes nothing.
TriangleSoup extract_iso_surface(const ScalarField& field, double iso, int64_t memory_limit_bytes = 0,
                                 VolumeCreases creases = VolumeCreases::none, UnknownValues* unknown = nullptr);

/// The field with values also at the points beside those that have one: the mean of the nearest of these among the 26
/// around. That tells their side, which cells of a band thinner than their diagonals need; farther out nothing is known
/// still, so that no surface ends the band. For ScalarField::is_band_alone(). Cost: a pass over the blocks and those
/// around them, and 2 KiB for each of these in which something is known. Throws: out_of_memory where that may be over
/// the limit, if one is given.
std::unique_ptr<ScalarField> with_points_beside_band(std::unique_ptr<ScalarField> band, int64_t memory_limit_bytes);

}  // namespace isoshell
