// The surface of a run, cut along the curves that are found on it.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "features/curves/find_curves.h"
#include "features/cutting/cut_surface.h"
#include "pipeline/grid/prepared_surface.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// Along which curves a surface was cut.
struct CutSource {
  std::vector<LostCurve> if_lost;   ///< all curves of the mesh, as a report says them
  std::vector<LostCurve> found;     ///< those that it was cut along
  std::vector<LostCurve> left_out;  ///< those that it was not
  bool is_sheet = false;            ///< the curves were laid onto the sheet: the input's own triangles cannot be it
};

using SharedCut = std::shared_ptr<const CutSurface>;

/// A surface that was cut, if it could be, and what is said of its curves.
struct CutAlongCurves {
  SharedCut surface;
  FeatureReport features;
};

/// Of a surface that the options leave open.
bool may_keep_borders(const PreparedSurface& p);

/// Cuts the surface along the curves of its mesh: p.cut, which stays empty where there are none. False where there are
/// curves that could not be kept, as p.report says. `known` are the mesh's creases, where those were found.
bool cut_along(const FeatureMesh& mesh, const CurveOptions& curves, std::optional<FoundCreases> known,
               PreparedSurface& p, Run& run);

}  // namespace isoshell
