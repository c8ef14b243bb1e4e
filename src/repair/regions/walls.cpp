// See walls.h.
#include "repair/regions/walls.h"

#include <tbb/parallel_sort.h>

#include <cstddef>
#include <tuple>
#include <utility>

#include "geometry/weld.h"

namespace isoshell::repair {
namespace {

using Corners = std::array<uint32_t, 3>;

struct PlacedFace {
  Corners corners;  ///< ascending
  FaceOnWall face;

  bool operator<(const PlacedFace& o) const {
    return std::tie(corners, face.source, face.is_turned) < std::tie(o.corners, o.face.source, o.face.is_turned);
  }
};

/// Three corners in ascending order, and whether that turns the triangle.
PlacedFace placed(Corners corners, uint32_t source) {
  bool is_turned = false;
  const auto order = [&](size_t i, size_t j) {
    if (corners[i] <= corners[j]) return;
    std::swap(corners[i], corners[j]);
    is_turned = !is_turned;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return {corners, {source, is_turned}};
}

}  // namespace

Walls find_walls(const ArrangedFaces& arranged) {
  const WeldedVertices welded = weld_vertices(arranged.point, arranged.face);
  std::vector<PlacedFace> faces;
  faces.reserve(arranged.face.size());
  for (size_t f = 0; f < arranged.face.size(); ++f) {
    Corners corners = arranged.face[f];
    for (uint32_t& v : corners) v = welded.place[v];
    faces.push_back(placed(corners, arranged.source[f]));
  }
  tbb::parallel_sort(faces.begin(), faces.end());
  Walls walls;
  walls.box = arranged.box;
  walls.point = welded.position;
  for (const PlacedFace& f : faces) {
    if (walls.triangle.empty() || walls.triangle.back() != f.corners) {
      walls.triangle.push_back(f.corners);
      walls.first.push_back(uint32_t(walls.on_wall.size()));
    }
    walls.on_wall.push_back(f.face);
  }
  walls.first.push_back(uint32_t(walls.on_wall.size()));
  return walls;
}

}  // namespace isoshell::repair
