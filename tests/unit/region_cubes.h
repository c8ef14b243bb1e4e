// Complexes of regions that can be counted by hand: cubes with labels, side by side, which share their walls.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <utility>
#include <vector>

#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Unit cubes, i fastest; what lies beside them is background, as label 0 is.
struct LabelledCubes {
  std::array<int, 3> size;
  std::vector<int32_t> labels;

  int32_t at(const std::array<int, 3>& p) const {
    for (size_t a = 0; a < 3; ++a)
      if (p[a] < 0 || p[a] >= size[a]) return 0;
    return labels[size_t((p[2] * size[1] + p[1]) * size[0] + p[0])];
  }
};

/// The walls between cubes of different labels, two triangles each.
inline TriangleMesh mesh_of(const LabelledCubes& cubes) {
  TriangleMesh mesh;
  std::map<std::array<int, 3>, uint32_t> vertices;
  const auto vertex = [&](const std::array<int, 3>& p) {
    const auto [found, is_new] = vertices.insert({p, uint32_t(mesh.vertices.size())});
    if (is_new) mesh.vertices.push_back({double(p[0]), double(p[1]), double(p[2])});
    return found->second;
  };
  const auto add_wall = [&](const std::array<int, 3>& p, size_t axis) {  // between the cube p and the one behind it
    std::array<int, 3> behind_p = p;
    --behind_p[axis];
    int32_t behind = cubes.at(behind_p), front = cubes.at(p);
    if (behind == front) return;
    const bool is_turned = behind == 0 || (front != 0 && front < behind);
    std::array<uint32_t, 4> quad{};
    for (size_t i = 0; i < 4; ++i) {
      std::array<int, 3> corner = p;
      corner[(axis + 1) % 3] += i == 1 || i == 2;
      corner[(axis + 2) % 3] += i >= 2;
      quad[i] = vertex(corner);
    }
    if (is_turned) std::swap(behind, front), std::swap(quad[1], quad[3]);
    mesh.triangles.insert(mesh.triangles.end(), {{quad[0], quad[1], quad[2]}, {quad[0], quad[2], quad[3]}});
    mesh.regions.labels.insert(mesh.regions.labels.end(), 2, {behind, front});
  };
  for (int k = 0; k <= cubes.size[2]; ++k)
    for (int j = 0; j <= cubes.size[1]; ++j)
      for (int i = 0; i <= cubes.size[0]; ++i)
        for (size_t axis = 0; axis < 3; ++axis) add_wall({i, j, k}, axis);
  return mesh;
}

inline TriangleMesh two_cubes() { return mesh_of(LabelledCubes{{2, 1, 1}, {1, 2}}); }

/// The same with a wall for each of the two, on the same vertices.
inline TriangleMesh two_cubes_of_two_walls() {
  TriangleMesh mesh = two_cubes();
  for (size_t t = 0, count = mesh.triangles.size(); t < count; ++t) {
    auto& labels = mesh.regions.labels[t];
    if (labels[1] == 0) continue;
    const auto [a, b, c] = mesh.triangles[t];
    const int32_t front = std::exchange(labels[1], 0);
    mesh.triangles.push_back({a, c, b});
    mesh.regions.labels.push_back({front, 0});
  }
  return mesh;
}

inline void remove_face(TriangleMesh& mesh, size_t face) {
  mesh.triangles.erase(mesh.triangles.begin() + int64_t(face));
  mesh.regions.labels.erase(mesh.regions.labels.begin() + int64_t(face));
}

/// The first face between two regions, given as the face has them.
inline size_t face_between(const TriangleMesh& mesh, const std::array<int32_t, 2>& labels) {
  size_t face = 0;
  while (mesh.regions.labels[face] != labels) ++face;
  return face;
}

}  // namespace isoshell
