// Edge lengths: checks arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {

void set_edge_lengths(SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16, Context& context) {
  if (raw.size() != surface.vertex_count())
    throw Error(ErrorCode::usage, "lengths",
                std::to_string(raw.size()) + " lengths for a surface of " + std::to_string(surface.vertex_count()) +
                    " vertices; there must be one for each");
  if (slope_q16 < 0 || slope_q16 > kMostLengthSlopeQ16)
    throw Error(
        ErrorCode::usage, "lengths",
        "slope_q16 is " + std::to_string(slope_q16) + "; it must be 0 to " + std::to_string(kMostLengthSlopeQ16));
  require_blocks(surface, "lengths");
  backend_for(context).set_edge_lengths(surface, std::move(raw), slope_q16, context);
}

void smooth_edge_lengths(SurfaceMesh& surface, int32_t rounds, Context& context) {
  if (surface.lengths.at.empty() || rounds < 0)
    throw Error(ErrorCode::usage, "lengths",
                surface.lengths.at.empty() ? "the surface has no lengths to smooth; set_edge_lengths gives it some"
                                           : std::to_string(rounds) + " rounds of smoothing; use 0 or more");
  backend_for(context).smooth_edge_lengths(surface, rounds, context);
}

int64_t seed_shares_q16(const SurfaceMesh& surface, Context& context) {
  return backend_for(context).seed_shares(surface, context);
}

void copy_edge_lengths(const SurfaceMesh& from, int halvings, SurfaceMesh& to, Context& context) {
  backend_for(context).copy_edge_lengths(from, halvings, to, context);
}

Buffer<uint32_t> measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) {
  return backend_for(context).measure_curvature(surface, rounds, context);
}

}  // namespace isoshell
