// Sequences of files for tests: frames that twist, and what running them says.
#pragma once

#include <cmath>
#include <filesystem>

#include "isoshell/error.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/run/sequence.h"
#include "support/catch.h"
#include "support/mesh_files.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/test_context.h"

namespace isoshell {

/// A torus that is twisted about its axis, more from frame to frame.
inline TriangleSoup twisted(int frame) {
  TriangleSoup soup = shapes::torus(2, 0.7, 96, 48);
  for (WorldPoint& p : soup.vertices) {
    const double angle = 0.06 * frame * p.x;
    p = {p.x, p.y * std::cos(angle) - p.z * std::sin(angle), p.y * std::sin(angle) + p.z * std::cos(angle)};
  }
  return soup;
}

inline TriangleSoup turned(TriangleSoup soup, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  for (WorldPoint& p : soup.vertices) p = {c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  return soup;
}

inline void write_frames(const TemporaryFolder& folder, int frames, TriangleSoup (*frame)(int)) {
  for (int f = 0; f < frames; ++f) write_mesh(path_of_frame(folder / "in.##.ply", f), mesh_of(frame(f)));
}

inline SequenceRequest request_in(const TemporaryFolder& folder, int frames, const std::string& output) {
  SequenceRequest request;
  RemeshOptions options;
  options.vertices = 600;
  request.frame.options = requested_options(options);
  request.frame.input = named_input(folder / "in.##.ply");
  request.frame.output = named_output(folder / output, "", StopAfter::mesh);
  request.frames = {0, frames - 1, 1};
  return request;
}

/// Writes the frames, and asks for out.##.ply of them.
inline SequenceRequest frames_in(const TemporaryFolder& folder, int frames, TriangleSoup (*frame)(int)) {
  write_frames(folder, frames, frame);
  return request_in(folder, frames, "out.##.ply");
}

inline std::vector<std::string> files_of(const SequenceRequest& request) {
  std::vector<std::string> bytes;
  for (int64_t f = request.frames.first; f <= request.frames.last; ++f)
    bytes.push_back(get_file(path_of_frame(request.frame.output.path, f)));
  return bytes;
}

inline std::string refusal_in(const SequenceRequest& request, ErrorCode code, Context& context) {
  return message_of(code, [&] { run_sequence(request, context); });
}

inline std::string refusal(const SequenceRequest& request, ErrorCode code) {
  TestContext context;
  return refusal_in(request, code, context);
}

}  // namespace isoshell
