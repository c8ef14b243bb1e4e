// The surface of a run, cut along the curves that are found on it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "features/cut_surface.h"
#include "features/find_curves.h"
#include "isoshell/error.h"
#include "isoshell/remesh.h"

namespace isoshell {

/// What a surface was cut from, to cut it along fewer curves.
struct CutSource {
  std::shared_ptr<const FeatureMesh> mesh;
  CurveOptions curves;
  CutOptions how;
  int64_t seeds = 0;                  ///< of a surface whose lengths do not decide
  std::vector<LostCurve> if_lost;     ///< all curves that were found, as a report says them
  std::vector<LostCurve> left_out;    ///< of these
  std::vector<uint64_t> curve_edges;  ///< ascending
};

/// Of a surface that the options leave open.
bool may_keep_borders(const RemeshOptions& options, const Prepared& p);

/// Cuts the surface along the curves of its mesh: p.cut, which stays empty where there are none. False where there are
/// curves that could not be kept, as the report says.
bool cut_along(std::shared_ptr<const FeatureMesh> mesh, const CurveOptions& curves, const RemeshOptions& options,
               Prepared& p, RemeshReport& report, Context& context);

/// The same without the creases that the edges of the result cannot follow: those around patches that are too small for
/// the edges, and, once these are out, those within about an edge length of `places`, where it went wrong. Null where
/// there are none left to leave out. Throws: as cut_surface.
std::shared_ptr<const CutSurface> cut_along_fewer(const CutSource& source, const std::vector<PointQ8>& places,
                                                  const LatticeFrame& frame, RemeshReport& report, Context& context);

/// What stages refuse as too coarse or too narrow for a curve or patch is no error of the user's: the sheet can do it.
/// Result: why it cannot be done, said by the work or by the stage that refuses; empty where it is done.
template <class Work>
std::string reason_against(Work work) {
  try {
    return work();
  } catch (const Error& error) {
    if (error.code() != ErrorCode::usage) throw;
    return error.what();
  }
}

}  // namespace isoshell
