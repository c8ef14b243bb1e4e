// Attributes of one surface at the vertices of another: by each vertex's nearest point, among triangles that look its
// way if one is about as near.
#include "isoshell/transfer_attributes.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cmath>

#include "core/number_type.h"
#include "core/watched.h"
#include "core/world_vector.h"
#include "measure/triangle_grid.h"

namespace isoshell {
namespace {

constexpr const char* kStage = "attributes";
constexpr int64_t kGrain = 256;
constexpr double kFarther = 0.5;  // in lengths of a vertex's edges, that a triangle which looks its way may be

void check(const TriangleSoup& source, const std::vector<VertexAttribute>& attributes) {
  if (source.triangles.empty()) throw Error(ErrorCode::usage, kStage, "the source has no triangle to take values from");
  for (const VertexAttribute& a : attributes)
    if (a.components < 1 || a.values.size() != source.vertices.size() * size_t(a.components))
      throw Error(ErrorCode::usage, kStage,
                  "the attribute '" + a.name + "' has " + std::to_string(a.values.size()) + " values; " +
                      std::to_string(source.vertices.size()) + " vertices need " + std::to_string(a.components) +
                      " each");
}

/// What of its triangles a vertex must know.
struct Surroundings {
  WorldPoint normal{0, 0, 0};  ///< by area, of any length
  double edges = 0;            ///< sum of lengths, each as often as triangles of the vertex have it
  int32_t count = 0;           ///< of those edges

  double edge_length() const { return count > 0 ? edges / count : 0; }
};

/// In the order of the triangles, so sums do not depend on threads.
std::vector<Surroundings> surroundings_of(const TriangleMesh& mesh) {
  std::vector<Surroundings> at(mesh.vertices.size());
  for (const auto& t : mesh.triangles) {
    const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const WorldPoint normal = doubled_area(a, b, c);
    const double ab = length(b - a), bc = length(c - b), ca = length(a - c);
    const double edges[3] = {ca + ab, ab + bc, bc + ca};
    for (size_t corner = 0; corner < 3; ++corner) {
      Surroundings& s = at[t[corner]];
      s.normal = s.normal + normal;
      s.edges += edges[corner];
      s.count += 2;
    }
  }
  return at;
}

MeshPoint place_of(WorldPoint p, const Surroundings& s, const TriangleGrid& grid) {
  const MeshPoint nearest = grid.nearest(p);
  if (grid.is_facing(nearest.triangle, s.normal)) return nearest;
  const double farthest = std::sqrt(nearest.distance_sq) + kFarther * s.edge_length();
  const MeshPoint facing = grid.nearest_facing(p, s.normal, farthest);
  return facing.triangle == MeshPoint::kNoTriangle ? nearest : facing;
}

/// Of one vertex. Where all corners have the same value, exactly that.
void interpolate(const VertexAttribute& from, const std::array<uint32_t, 3>& corners, const MeshPoint& place,
                 double* to) {
  const auto value = [&](uint32_t vertex, int32_t component) {
    return from.values[size_t(vertex) * size_t(from.components) + size_t(component)];
  };
  for (int32_t i = 0; i < from.components; ++i) {
    const double a = value(corners[0], i), b = value(corners[1], i), c = value(corners[2], i);
    to[i] = nearest_of(from.type, a + place.b_part * (b - a) + place.c_part * (c - a));
  }
}

}  // namespace

std::vector<VertexAttribute> transfer_attributes(const TriangleSoup& source,
                                                 const std::vector<VertexAttribute>& attributes,
                                                 const TriangleMesh& mesh, Context& context) {
  if (attributes.empty()) return {};
  check(source, attributes);
  const size_t count = mesh.vertices.size();
  std::vector<VertexAttribute> result;
  for (const VertexAttribute& a : attributes)
    result.push_back({a.name, a.type, a.components, std::vector<double>(count * size_t(a.components))});
  run_with_threads(context, [&] {
    const TriangleGrid grid(source.vertices, source.triangles);
    const std::vector<Surroundings> surroundings = surroundings_of(mesh);
    tbb::parallel_for(tbb::blocked_range<size_t>(0, count, kGrain), [&](const tbb::blocked_range<size_t>& r) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      for (size_t v = r.begin(); v < r.end(); ++v) {
        const MeshPoint place = place_of(mesh.vertices[v], surroundings[v], grid);
        for (size_t a = 0; a < attributes.size(); ++a)
          interpolate(attributes[a], source.triangles[place.triangle], place,
                      &result[a].values[v * size_t(result[a].components)]);
      }
    });
  });
  check_cancel(context, kStage);
  return result;
}

}  // namespace isoshell
