// Volumes of labels: what one run starts from, and files of them.
#pragma once

#include <nanobind/nanobind.h>

#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "isoshell/regions.h"
#include "values/arrays.h"

namespace isoshell::python {

/// Three numbers of Python.
using Triple = std::array<double, 3>;

inline WorldPoint point_of(const Triple& numbers) { return {numbers[0], numbers[1], numbers[2]}; }

/// What Python says of a volume beside its labels.
struct LabelLattice {
  Triple origin;                ///< the centre of the first voxel, world units
  std::array<Triple, 3> steps;  ///< from a voxel to the next, along each axis of the array
  int32_t background = 0;
  std::map<int32_t, std::string> names;
  int64_t smallest_island_vox = 8;
  double smoothing_vox = 0.5;
  std::array<bool, 3> is_periodic{false, false, false};
};

/// Throws: usage, as labels_of() does.
LabelVolume label_volume_of(const AnyArray& labels, const LabelLattice& lattice);

/// LabelLattice and write_labels.
void bind_labels(nanobind::module_& m);

}  // namespace isoshell::python
