// Bounds of the options of a run.
#include "check_options.h"

#include <limits>
#include <sstream>

#include "isoshell/error.h"

namespace isoshell {
namespace {

/// NaN lies outside of every range.
void check_range(const char* option, double value, double least, double most) {
  if (value >= least && value <= most) return;
  std::ostringstream text;
  text << option << " is " << value << "; it must be " << least << " to " << most;
  throw Error(ErrorCode::usage, "options", text.str());
}

}  // namespace

void check_options(const RemeshOptions& o) {
  const double finite = std::numeric_limits<double>::max();
  check_range("vertices", double(o.vertices), 0, std::numeric_limits<int32_t>::max());
  check_range("edge_length_world", o.edge_length_world, 0, finite);
  if (o.resolution != 0) check_range("resolution", o.resolution, 8, kMaxResolution);
  check_range("voxel_size_world", o.voxel_size_world, 0, finite);
  check_range("band_vox", o.band_vox, 1, kMaxBandVox);
  check_range("closing_vox", o.closing_vox, -1, kMaxClosingVox);
  check_range("closing_world", o.closing_world, -finite, finite);
  check_range("max_passes", o.max_passes, 0, 1000000);
  check_range("tolerance", o.tolerance, -finite, 1);
  check_range("max_step_vox", o.max_step_vox, 0, 1000);
  check_range("adaptivity", o.adaptivity, 0, 1);
  check_range("gradation", o.gradation, 1, 10);
  if (o.gradation == 1)
    throw Error(ErrorCode::usage, "options",
                "gradation is 1; it must be above 1: at 1 all edges would have one length");
  if (o.method == Method::shell && (o.sizing || o.adaptivity > 0))
    throw Error(ErrorCode::usage, "options",
                "a sizing field and adaptivity need the method sheet: the paper's loop on the shell has even cells");
}

}  // namespace isoshell
