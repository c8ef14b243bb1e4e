// Sources that are sparse: voxels with values, and grids of other packages as the bytes of a .vdb or .nvdb file.
#pragma once

#include "values/arrays.h"
#include "values/source.h"
#include "values/text.h"

namespace isoshell::python {

/// Values of single precision at (K, 3) coordinates of 32 bits. `steps` lead from a voxel to the next along each axis.
/// Without an isovalue, values of which some are negative are a level set in any case. A background that is NaN is the
/// largest magnitude of the values, or 0 with an isovalue. Borrows both arrays until the run has read them. Throws:
/// usage for arrays of another shape or type.
Source sparse_source(const AnyArray& coordinates, const AnyArray& values, double background, bool is_level_set,
                     const WorldPoint& origin, const std::array<WorldPoint, 3>& steps);

/// Values that vertices of a result get.
struct GivenGrid {
  std::shared_ptr<const GridField> field;
};

void bind_given_grid(nanobind::module_& m);

/// Borrows the bytes until the run has read them. `name` is what messages call the volume.
Source vdb_source(const std::string& name, const AnyArray& bytes);

}  // namespace isoshell::python
