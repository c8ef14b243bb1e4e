// Edge lengths: checks arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"
#include "stages/require_surface.h"

namespace isoshell {
namespace {

constexpr int kMostHalvings = 30;  ///< what a coordinate can be shifted by

}  // namespace

EdgeLengths limit_edge_lengths(const SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16, Context& context) {
  if (raw.size() != surface.vertex_count())
    throw Error(ErrorCode::usage, "lengths",
                std::to_string(raw.size()) + " lengths for a surface of " + std::to_string(surface.vertex_count()) +
                    " vertices; there must be one for each");
  if (slope_q16 < 0 || slope_q16 > kMostLengthSlopeQ16)
    throw Error(
        ErrorCode::usage, "lengths",
        "slope_q16 is " + std::to_string(slope_q16) + "; it must be 0 to " + std::to_string(kMostLengthSlopeQ16));
  require_blocks(surface, "lengths");
  return backend_for(context).limit_edge_lengths(surface, std::move(raw), slope_q16, context);
}

EdgeLengths smooth_edge_lengths(const SurfaceMesh& surface, EdgeLengths&& lengths, int32_t rounds, Context& context) {
  if (lengths.at.size() != surface.vertex_count() || rounds < 0)
    throw Error(ErrorCode::usage, "lengths",
                rounds < 0
                    ? std::to_string(rounds) + " rounds of smoothing; use 0 or more"
                    : std::to_string(lengths.at.size()) + " lengths to smooth on a surface of " +
                          std::to_string(surface.vertex_count()) + " vertices; limit_edge_lengths gives one for each");
  return backend_for(context).smooth_edge_lengths(surface, lengths, rounds, context);
}

int64_t seed_shares_q16(const SurfaceMesh& surface, Context& context) {
  return backend_for(context).seed_shares(surface, context);
}

EdgeLengths transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to, Context& context) {
  if (from.lengths.at.size() != from.vertex_count())
    throw Error(ErrorCode::usage, "lengths",
                "the surface to transfer from has " + std::to_string(from.lengths.at.size()) + " lengths for " +
                    std::to_string(from.vertex_count()) + " vertices; limit_edge_lengths gives one for each");
  if (from.vertex_count() == 0)
    throw Error(ErrorCode::usage, "lengths", "the surface to transfer from has 0 vertices; it must have 1 or more");
  if (halvings < 0 || halvings > kMostHalvings)
    throw Error(ErrorCode::usage, "lengths",
                "halvings is " + std::to_string(halvings) + "; it must be 0 to " + std::to_string(kMostHalvings));
  return backend_for(context).transfer_edge_lengths(from, halvings, to, context);
}

Buffer<uint32_t> measure_curvature(const SurfaceMesh& surface, int32_t rounds, Context& context) {
  return backend_for(context).measure_curvature(surface, rounds, context);
}

}  // namespace isoshell
