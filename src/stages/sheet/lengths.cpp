// Edge lengths: checks arguments, then runs on the backend that the context asks for.
#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {

void set_edge_lengths(Sheet& sheet, Buffer<uint32_t> raw, int64_t slope_q16, Context& context) {
  if (raw.size() != sheet.vertex_count())
    throw Error(ErrorCode::usage, "lengths",
                std::to_string(raw.size()) + " lengths for a sheet of " + std::to_string(sheet.vertex_count()) +
                    " vertices; there must be one for each");
  if (slope_q16 < 0 || slope_q16 > kMostLengthSlopeQ16)
    throw Error(
        ErrorCode::usage, "lengths",
        "slope_q16 is " + std::to_string(slope_q16) + "; it must be 0 to " + std::to_string(kMostLengthSlopeQ16));
  backend_for(context).set_edge_lengths(sheet, std::move(raw), slope_q16, context);
}

void smooth_edge_lengths(Sheet& sheet, int32_t rounds, Context& context) {
  if (sheet.lengths.at.empty() || rounds < 0)
    throw Error(ErrorCode::usage, "lengths",
                sheet.lengths.at.empty() ? "the sheet has no lengths to smooth; set_edge_lengths gives it some"
                                         : std::to_string(rounds) + " rounds of smoothing; use 0 or more");
  backend_for(context).smooth_edge_lengths(sheet, rounds, context);
}

int64_t seed_shares_q16(const Sheet& sheet, Context& context) {
  return backend_for(context).seed_shares(sheet, context);
}

void copy_edge_lengths(const Sheet& from, int halvings, Sheet& to, Context& context) {
  backend_for(context).copy_edge_lengths(from, halvings, to, context);
}

Buffer<uint32_t> measure_curvature(const Sheet& sheet, int32_t rounds, Context& context) {
  return backend_for(context).measure_curvature(sheet, rounds, context);
}

}  // namespace isoshell
