// Numbers for the vertices of a mesh that has not kept those of the frame before (see previous_frame.h).
#include <algorithm>

#include "geometry/point_cells.h"
#include "geometry/world_vector.h"
#include "isoshell/previous_frame.h"
#include "sequence/mean_edge_length.h"

namespace isoshell {
namespace {

using Triangle = std::array<uint32_t, 3>;

constexpr uint32_t kNoNumber = 0xffffffff;
constexpr double kFarthest = 0.5;  ///< mean edge lengths from where a vertex went

/// Per vertex the number of a vertex of the frame before; the nearest pairs choose first.
std::vector<uint32_t> nearest_numbers(const PreviousFrame& previous, const TriangleMesh& mesh) {
  struct Pair {
    double distance_sq;
    uint32_t before, vertex;
    bool operator<(const Pair& o) const {
      return distance_sq != o.distance_sq ? distance_sq < o.distance_sq
             : before != o.before         ? before < o.before
                                          : vertex < o.vertex;
    }
  };
  std::vector<uint32_t> number(mesh.vertices.size(), kNoNumber);
  const double reach = kFarthest * mean_edge_length(mesh);
  if (!(reach > 0)) return number;
  const PointCells cells(previous.carried, reach);
  std::vector<Pair> pairs;
  for (size_t v = 0; v < mesh.vertices.size(); ++v)
    cells.for_each_in(widened(WorldBox{mesh.vertices[v], mesh.vertices[v]}, reach), [&](size_t before) {
      const double d = distance_sq(previous.carried[before], mesh.vertices[v]);
      if (d < reach * reach && before < mesh.vertices.size()) pairs.push_back({d, uint32_t(before), uint32_t(v)});
    });
  std::sort(pairs.begin(), pairs.end());
  std::vector<uint8_t> is_taken(mesh.vertices.size(), 0);
  for (const Pair& pair : pairs) {
    if (number[pair.vertex] != kNoNumber || is_taken[pair.before]) continue;
    number[pair.vertex] = pair.before;
    is_taken[pair.before] = 1;
  }
  uint32_t free_number = 0;
  for (uint32_t& n : number) {
    if (n != kNoNumber) continue;
    while (is_taken[free_number]) ++free_number;
    n = free_number++;
  }
  return number;
}

template <class T>
void reorder(const std::vector<uint32_t>& to, std::vector<T>& values) {
  if (values.empty()) return;
  std::vector<T> moved(values.size());
  for (size_t i = 0; i < values.size(); ++i) moved[to[i]] = values[i];
  values = std::move(moved);
}

Triangle smallest_first(Triangle t) {
  std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
  return t;
}

void renumber_features(const std::vector<uint32_t>& number, MeshFeatures& features) {
  for (MeshCurveEdge& edge : features.curve_edges) {
    for (uint32_t& v : edge.vertex) v = number[v];
    if (edge.vertex[0] > edge.vertex[1]) std::swap(edge.vertex[0], edge.vertex[1]);
  }
  std::sort(features.curve_edges.begin(), features.curve_edges.end(),
            [](const MeshCurveEdge& a, const MeshCurveEdge& b) {
              return a.vertex != b.vertex ? a.vertex < b.vertex : a.curve < b.curve;
            });
  for (uint32_t& v : features.corners) v = number[v];
  std::sort(features.corners.begin(), features.corners.end());
}

}  // namespace

void number_as_before(const PreviousFrame& previous, TriangleMesh& mesh) {
  const std::vector<uint32_t> number = nearest_numbers(previous, mesh);
  if (std::find(number.begin(), number.end(), kNoNumber) != number.end()) return;  // a mesh without extent
  reorder(number, mesh.vertices);
  reorder(number, mesh.gap);
  renumber_features(number, mesh.features);
  std::vector<std::pair<Triangle, uint32_t>> triangles(mesh.triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    const Triangle& from = mesh.triangles[t];
    triangles[t] = {smallest_first({number[from[0]], number[from[1]], number[from[2]]}), uint32_t(t)};
  }
  std::sort(triangles.begin(), triangles.end());
  std::vector<uint32_t> place(triangles.size());
  for (size_t t = 0; t < triangles.size(); ++t) {
    mesh.triangles[t] = triangles[t].first;
    place[triangles[t].second] = uint32_t(t);
  }
  reorder(place, mesh.features.patch);
  reorder(place, mesh.regions.labels);
}

}  // namespace isoshell
