// Velocities of a surface's vertices as a field (see previous_frame.h).

#include <cmath>
#include <limits>

#include "core/parallel_ranges.h"
#include "geometry/triangle_grid.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/previous_frame.h"

namespace isoshell {
namespace {

class SurfaceVelocity final : public VelocityField {
 public:
  SurfaceVelocity(TriangleSoup surface, std::vector<WorldPoint> velocities)
      : surface_(std::move(surface)),
        velocities_(std::move(velocities)),
        grid_(surface_.vertices, surface_.triangles) {}

  std::vector<WorldPoint> velocities_at(const std::vector<WorldPoint>& points) const override {
    constexpr double kNothing = std::numeric_limits<double>::quiet_NaN();
    std::vector<WorldPoint> out(points.size());
    for_each_index(size_t(0), points.size(), [&](size_t i) {
      const MeshPoint place = grid_.nearest(points[i]);
      const std::array<uint32_t, 3>& t = surface_.triangles[place.triangle];
      const WorldPoint v = interpolate(place, velocities_[t[0]], velocities_[t[1]], velocities_[t[2]]);
      out[i] = std::isnan(v.x + v.y + v.z) ? WorldPoint{kNothing, kNothing, kNothing} : v;
    });
    return out;
  }

 private:
  const TriangleSoup surface_;
  const std::vector<WorldPoint> velocities_;
  const TriangleGrid grid_;
};

}  // namespace

std::shared_ptr<const VelocityField> velocity_on(TriangleSoup surface, std::vector<WorldPoint> velocities) {
  if (surface.triangles.empty())
    throw Error(ErrorCode::usage, "velocities", "the surface has no triangles; velocities need at least one");
  if (velocities.size() != surface.vertices.size())
    throw Error(ErrorCode::usage, "velocities",
                "there are " + std::to_string(velocities.size()) + " velocities for " +
                    std::to_string(surface.vertices.size()) + " vertices; each vertex must have one");
  for (size_t v = 0; v < velocities.size(); ++v) {
    const WorldPoint& at = velocities[v];
    if (std::isinf(at.x) || std::isinf(at.y) || std::isinf(at.z))
      throw Error(ErrorCode::unreadable_input, "velocities",
                  "velocities[" + std::to_string(v) + "] is infinite; give NaN where nothing is known");
  }
  return std::make_shared<SurfaceVelocity>(std::move(surface), std::move(velocities));
}

}  // namespace isoshell
