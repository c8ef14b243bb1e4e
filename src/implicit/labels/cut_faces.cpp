// cut_faces (see cut_faces.h).
#include "implicit/labels/cut_faces.h"

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

CutFaces cut_faces(const std::vector<std::array<uint32_t, 4>>& faces, const std::vector<PointQ8>& position) {
  CutFaces cut;
  cut.triangles.reserve(2 * faces.size());
  cut.face.reserve(2 * faces.size());
  for (uint32_t f = 0; f < faces.size(); ++f) {
    const auto& [a, b, c, d] = faces[f];
    if (d == kNone) {
      cut.triangles.push_back({a, b, c});
      cut.face.push_back(f);
      continue;
    }
    if (is_cut_from_first(faces[f], position)) {
      cut.triangles.push_back({a, b, c});
      cut.triangles.push_back({a, c, d});
    } else {
      cut.triangles.push_back({a, b, d});
      cut.triangles.push_back({b, c, d});
    }
    cut.face.insert(cut.face.end(), {f, f});
  }
  return cut;
}

}  // namespace isoshell
