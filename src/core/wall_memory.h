// What walls between labels take while they are made.
#pragma once

#include <cstdint>

namespace isoshell {

/// At the peak of making them, which is the search for intersections once they are faired, the labels themselves left
/// out: what was measured of grains, noise and checkerboards.
inline int64_t bytes_to_make_walls(int64_t triangles, int64_t vertices) {
  constexpr int64_t kBytesPerTriangle = 72, kBytesPerVertex = 66;
  return kBytesPerTriangle * triangles + kBytesPerVertex * vertices;
}

}  // namespace isoshell
