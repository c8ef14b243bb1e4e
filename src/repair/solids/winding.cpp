#include "repair/solids/winding.h"

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr int64_t kMostCells = 1024;    // an axis
constexpr int64_t kListedPerFace = 32;  // more, and columns are too thin for faces that lie across many

/// On which side of the line through two points of the plane (y, z) the third lies, as if it were moved by a little in
/// y and by much less in z. Both orders of the two give opposite answers.
int side_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& p) {
  if (b.z < a.z || (b.z == a.z && b.y < a.y)) return -side_of(b, a, p);
  const double turn = (b.y - a.y) * (p.z - a.z) - (b.z - a.z) * (p.y - a.y);
  if (turn != 0) return turn > 0 ? 1 : -1;
  return b.z > a.z ? -1 : 1;
}

}  // namespace

RayColumns::RayColumns(const std::vector<WorldPoint>& points, const std::vector<std::array<uint32_t, 3>>& faces)
    : points_(points), faces_(faces) {
  const WorldPoint start = faces.empty() ? WorldPoint{0, 0, 0} : points[faces[0][0]];
  double most[2] = {start.y, start.z};
  least_[0] = start.y, least_[1] = start.z;
  for (const auto& f : faces)
    for (const uint32_t v : f)
      for (int axis = 0; axis < 2; ++axis) {
        const double at = axis == 0 ? points[v].y : points[v].z;
        least_[axis] = std::min(least_[axis], at);
        most[axis] = std::max(most[axis], at);
      }
  int64_t cells = std::clamp(int64_t(std::sqrt(double(faces.size()))), int64_t(1), kMostCells);
  for (;; cells = (cells + 1) / 2) {
    for (int axis = 0; axis < 2; ++axis) {
      const double length = most[axis] - least_[axis];
      cells_[axis] = length > 0 ? cells : 1;
      cell_[axis] = length > 0 ? length / double(cells) : 1;
    }
    int64_t listed = 0;
    for (const auto& f : faces) listed += columns_of(f).count();
    if (cells == 1 || listed <= kListedPerFace * int64_t(faces.size())) break;
  }
  in_column_ = sort_into_buckets<uint32_t>(cells_[0] * cells_[1], int64_t(faces.size()), [&](int64_t f, auto put) {
    for_each_column(faces[size_t(f)], [&](int64_t column) { put(column, uint32_t(f)); });
  });
}

int64_t RayColumns::column_of(double at, int axis) const {
  return std::clamp(int64_t((at - least_[axis]) / cell_[axis]), int64_t(0), cells_[axis] - 1);
}

RayColumns::Columns RayColumns::columns_of(const std::array<uint32_t, 3>& face) const {
  const WorldPoint &a = points_[face[0]], &b = points_[face[1]], &c = points_[face[2]];
  return {column_of(std::min({a.y, b.y, c.y}), 0), column_of(std::max({a.y, b.y, c.y}), 0),
          column_of(std::min({a.z, b.z, c.z}), 1), column_of(std::max({a.z, b.z, c.z}), 1)};
}

template <class Each>
void RayColumns::for_each_column(const std::array<uint32_t, 3>& face, Each each) const {
  const Columns at = columns_of(face);
  for (int64_t y = at.y0; y <= at.y1; ++y)
    for (int64_t z = at.z0; z <= at.z1; ++z) each(y * cells_[1] + z);
}

int RayColumns::crossing(const WorldPoint& p, uint32_t own, uint32_t face) const {
  const WorldPoint &a = points_[faces_[face][0]], &b = points_[faces_[face][1]], &c = points_[faces_[face][2]];
  if (a.x < p.x && b.x < p.x && c.x < p.x) return 0;
  const int turn = side_of(a, b, p);
  if (side_of(b, c, p) != turn || side_of(c, a, p) != turn) return 0;
  // turn is the sign of the normal's x; the face lies beyond where (a - p) and the normal agree with it.
  const double ahead = dot(a - p, doubled_area(a, b, c));
  const bool beyond = ahead != 0 ? (ahead > 0) == (turn > 0) : face > own;
  return beyond ? turn : 0;
}

}  // namespace isoshell
