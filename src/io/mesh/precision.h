// In which numbers a file has the positions of a mesh.
#pragma once

#include <string>

#include "isoshell/attribute.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Where a file has a mesh, which writers follow and measures go by.
struct Placement {
  NumberType type = NumberType::f64;  ///< or f32
  WorldPoint offset{0, 0, 0};         ///< subtracted from all positions, as the caller wants it
  WorldPoint origin{0, 0, 0};         ///< what the numbers are about; the file says it, and readers add it

  bool is_double() const { return type == NumberType::f64; }
  /// The numbers for a position, before they are rounded, and as they are written.
  WorldPoint about_origin(const WorldPoint& p) const {
    return {p.x - offset.x - origin.x, p.y - offset.y - origin.y, p.z - offset.z - origin.z};
  }
  WorldPoint written(const WorldPoint& p) const;
  /// Where readers have it.
  WorldPoint in_file(const WorldPoint& p) const;
};

/// The nearest 32-bit float. Kept in memory: where it is a double again at once, GCC 12 leaves out the rounding of
/// neighbouring coordinates that it puts into one vector.
inline double in_single(double number) {
  const volatile float single = float(number);
  return double(single);
}

inline bool is_origin(const WorldPoint& p) { return p.x == 0 && p.y == 0 && p.z == 0; }

/// What files with comments say of an offset: "offset 500000 0 -20"; empty where there is none.
std::string offset_note(const Placement& placement);

/// True when single precision would move a corner of a triangle, less the offset, by more than a thousandth of its
/// least height, or lose a triangle, or by more than a ten-thousandth where triangles intersect then. Triangles without
/// area count by their edges. Cost: a pass over the triangles; where needles are near to that, as
/// count_intersecting_pairs().
bool needs_double(const TriangleMesh& mesh, const WorldPoint& offset = {0, 0, 0});

/// Triangles that lose their area there, or tilt by more than 60 degrees.
int64_t count_lost_triangles(const TriangleMesh& mesh, const Placement& placement);

/// How far the farthest vertex is moved by rounding.
double largest_move_world(const TriangleMesh& mesh, const Placement& placement);

/// Of formats that hold all bits of a position.
Placement place_in_doubles(const TriangleMesh& mesh, const WorldPoint& offset);
/// Of those whose numbers are single.
Placement place_in_floats(const TriangleMesh& mesh, const WorldPoint& offset);

}  // namespace isoshell
