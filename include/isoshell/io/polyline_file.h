// Polylines from OBJ and PLY files.
#pragma once

#include <memory>
#include <string>

#include "isoshell/polylines.h"

namespace isoshell {

/// Reads the lines of an OBJ file (`l 1 2 3`), or the edges of a PLY file (element edge, vertex1 and vertex2); faces
/// are passed over. A segment from a point to itself, and one that is there before, is left out. Throws:
/// unreadable_input (names file, line or row, value and remedy), also for a file without lines; usage for a name that
/// ends otherwise.
std::shared_ptr<const Polylines> read_polylines(const std::string& path, int64_t memory_limit_bytes = 0);

}  // namespace isoshell
