// What a planned run will take.
#pragma once

#include "isoshell/memory_estimate.h"
#include "pipeline/grid/plan.h"

namespace isoshell {

constexpr int32_t kCoarsestGrid = 8;
constexpr double kBytesPerFinePoint = 780;  ///< patches that are cut, what relaxes on them, all of them coarsened

/// As estimate_run, of a surface that parts no regions.
RunEstimate estimate_plan(const Plan& plan, const TriangleSoup& soup, int32_t resolution);

}  // namespace isoshell
