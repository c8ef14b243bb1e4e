// What the steps and stages of a run are expected to take.
#pragma once

#include <optional>
#include <vector>

#include "progress/progress_meter.h"

namespace isoshell {

/// What the time that a run takes goes with, as far as it is known.
struct RunSize {
  double faces = 0;                ///< of the input
  double vertices = 0;             ///< of the result
  double surface_voxels = 0;       ///< that the surface meets
  bool has_regions = false;        ///< walls between regions are meshed
  bool are_of_voxels = false;      ///< those walls come from a volume of labels
  std::optional<bool> has_curves;  ///< creases, borders or lines of the input that the result keeps
  bool measures_distance = false;
  double speed = 1;  ///< of one thread of the processor
};

std::vector<ExpectedWork> expected_work(const RunSize& size);
/// Of a certificate of a mesh with so many faces, and their distance from so many of a reference, 0 without one.
std::vector<ExpectedWork> expected_work_of_info(double faces, double reference_faces);

}  // namespace isoshell
