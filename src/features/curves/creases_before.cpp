// See creases_before.h.
#include "features/curves/creases_before.h"

#include <cmath>

#include "features/curves/creases.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kReach = 0.5;        ///< edges
constexpr double kSharpDegrees = 40;  ///< as creases begin

/// On the sharp edges of the mesh, where their ends have gone to.
std::vector<WorldPoint> points_on_sharp_edges(const PreviousFrame& previous, double most_apart) {
  FeatureMesh mesh;
  mesh.vertices = previous.vertices;
  mesh.triangles = previous.triangles;
  const MeshEdges edges = find_mesh_edges(mesh);
  std::vector<WorldPoint> places;
  for (const CurveEdge& sharp : with_creases_above(mesh, edges, {}, kSharpDegrees)) {
    const auto& [u, v] = edges.edges[sharp.edge].end;
    const WorldPoint from = previous.carried[u], along = previous.carried[v] - from;
    const auto steps = std::max<int64_t>(1, int64_t(std::ceil(length(along) / most_apart)));
    for (int64_t i = 0; i <= steps; ++i) places.push_back(from + double(i) / double(steps) * along);
  }
  return places;
}

}  // namespace

CreasesBefore::CreasesBefore(const PreviousFrame& previous, double edge_length_world)
    : reach_world_(kReach * edge_length_world),
      places_(points_on_sharp_edges(previous, reach_world_)),
      cells_(places_, reach_world_) {}

bool CreasesBefore::are_near(const WorldPoint& place) const {
  bool found = false;
  cells_.for_each_in(widened(WorldBox{place, place}, reach_world_),
                     [&](size_t i) { found = found || distance_sq(places_[i], place) < reach_world_ * reach_world_; });
  return found;
}

bool CreasesBefore::hold(const FeatureMesh& mesh, const EdgeChain& chain) const {
  double all = 0, near = 0;
  for (size_t i = 0; i < chain.edge.size(); ++i) {
    const WorldPoint &a = mesh.vertices[chain.vertex[i]], &b = mesh.vertices[chain.vertex[i + 1]];
    const double size = length(b - a);
    all += size;
    near += are_near(0.5 * (a + b)) ? size : 0;
  }
  return 2 * near >= all;
}

}  // namespace isoshell
