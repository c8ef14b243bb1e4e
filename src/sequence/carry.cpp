// Where vertices go from frame to frame (see previous_frame.h).

#include <cmath>

#include "attributes/facing_point.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/outward_normals.h"
#include "geometry/triangle_grid.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/previous_frame.h"
#include "sequence/mean_edge_length.h"

namespace isoshell {
namespace {

using Triangle = std::array<uint32_t, 3>;

constexpr size_t kPointsPerLook = 4096;  ///< between two looks at whether to stop

void require_triangles(const TriangleSoup& soup) {
  if (soup.triangles.empty())
    throw Error(ErrorCode::usage, "carry", "the surface has no triangles; vertices need at least one to go with");
}

WorldPoint unit_normal(const std::vector<WorldPoint>& at, const Triangle& t) {
  return normalised(doubled_area(at[t[0]], at[t[1]], at[t[2]]));
}

WorldPoint place_in(const std::vector<WorldPoint>& at, const Triangle& t, const MeshPoint& place) {
  return interpolate(place, at[t[0]], at[t[1]], at[t[2]]);
}

/// of(i) of each, at once for all.
template <class Of>
auto of_all(size_t count, Context& context, Of of) {
  std::vector<decltype(of(size_t(0)))> all(count);
  run_with_threads(context, [&] {
    for (size_t from = 0; from < count; from += kPointsPerLook) {
      check_cancel(context, "carry");
      for_each_index(from, std::min(count, from + kPointsPerLook), [&](size_t i) { all[i] = of(i); });
    }
  });
  return all;
}

/// Whether p lies beside the triangle rather than over it: farther along it than from it.
bool is_beside(WorldPoint p, const std::vector<WorldPoint>& at, const Triangle& t, const MeshPoint& place) {
  const double over = dot(p - place_in(at, t, place), unit_normal(at, t));
  return 2 * over * over < place.distance_sq;
}

/// Per vertex the place that it lies on. All faces of a file may be turned inside out, or a few: a vertex over one of
/// those few stays with it, since with a face beside it, it would move to that one's edge.
std::vector<MeshPoint> places_on(const TriangleMesh& mesh, const TriangleSoup& surface, Context& context) {
  const TriangleGrid grid(surface.vertices, surface.triangles);
  const size_t count = mesh.vertices.size();
  std::vector<MeshPoint> nearest = of_all(count, context, [&](size_t i) { return grid.nearest(mesh.vertices[i]); });
  const std::vector<WorldPoint> normals = outward_normals(mesh.vertices, mesh.triangles);
  size_t facing = 0;
  for (size_t i = 0; i < count; ++i) facing += grid.is_facing(nearest[i].triangle, normals[i]);
  const double outward = 2 * facing < count ? -1 : 1, edge_length = mean_edge_length(mesh);
  return of_all(count, context, [&](size_t i) {
    const MeshPoint place = facing_point(grid, mesh.vertices[i], nearest[i], outward * normals[i], edge_length);
    const Triangle& t = surface.triangles[place.triangle];
    return is_beside(mesh.vertices[i], surface.vertices, t, place) ? nearest[i] : place;
  });
}

}  // namespace

bool have_same_triangles(const TriangleSoup& a, const TriangleSoup& b) {
  return a.vertices.size() == b.vertices.size() && a.triangles == b.triangles;
}

std::vector<WorldPoint> carry_with_triangles(const TriangleMesh& mesh, const TriangleSoup& before,
                                             const TriangleSoup& now, Context& context) {
  require_triangles(before);
  if (!have_same_triangles(before, now))
    throw Error(ErrorCode::usage, "carry", "the surface of this frame has other triangles than that of the one before");
  const std::vector<MeshPoint> places = places_on(mesh, before, context);
  return of_all(places.size(), context, [&](size_t i) {
    const Triangle& t = before.triangles[places[i].triangle];
    const WorldPoint offset = mesh.vertices[i] - place_in(before.vertices, t, places[i]);
    return place_in(now.vertices, t, places[i]) +
           dot(offset, unit_normal(before.vertices, t)) * unit_normal(now.vertices, t);
  });
}

std::vector<WorldPoint> carry_with_velocity(const std::vector<WorldPoint>& points, const VelocityField& field) {
  std::vector<WorldPoint> velocity = field.velocities_at(points);
  std::vector<WorldPoint> middle(points.size()), carried(points.size());
  for (size_t i = 0; i < points.size(); ++i) {
    if (std::isnan(velocity[i].x)) velocity[i] = {0, 0, 0};
    middle[i] = points[i] + 0.5 * velocity[i];
  }
  const std::vector<WorldPoint> there = field.velocities_at(middle);
  for (size_t i = 0; i < points.size(); ++i) carried[i] = points[i] + (std::isnan(there[i].x) ? velocity[i] : there[i]);
  return carried;
}

std::vector<WorldPoint> carry_onto(const TriangleMesh& mesh, const TriangleSoup& now, Context& context) {
  require_triangles(now);
  const TriangleGrid grid(now.vertices, now.triangles);
  const std::vector<WorldPoint> normals = outward_normals(mesh.vertices, mesh.triangles);
  const double farther = 2 * mean_edge_length(mesh);
  return of_all(mesh.vertices.size(), context, [&](size_t i) {
    const MeshPoint place = facing_point(grid, mesh.vertices[i], normals[i], farther);
    return place_in(now.vertices, now.triangles[place.triangle], place);
  });
}

}  // namespace isoshell
