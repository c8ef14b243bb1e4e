// The surface on which a scalar field has one value.
#pragma once

#include "implicit/volumes/scalar_field.h"
#include "isoshell/io/volume_file.h"
#include "isoshell/surface_source.h"

namespace isoshell {

struct ValueRange {
  float low, high;
};
/// Over blocks, tiles and background; NaN is passed over.
ValueRange value_range(const ScalarField& field);

/// Marching cubes over the cells of the lattice. Result: every edge of a triangle belongs to two triangles, which run
/// through it in opposite directions; vertices lie on lattice edges, where the trilinear field has the value, and at
/// the middle of patches of six and more corners. Outside is where the background lies. Cost: linear in the blocks.
/// Throws: unreadable_input for a NaN, nothing_to_mesh without a crossing, out_of_memory beyond 32-bit indices
/// or the limit, where one is given. Creases have vertices of their own where they are wanted and values are distances;
/// where bodies are not sharp, asking for theirs costs a look at the cut cells, and changes nothing.
TriangleSoup extract_iso_surface(const ScalarField& field, double iso, int64_t memory_limit_bytes = 0,
                                 VolumeCreases creases = VolumeCreases::none);

}  // namespace isoshell
