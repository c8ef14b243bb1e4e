// See swell_solids.h.
#include "repair/solids/swell_solids.h"

#include <cmath>

#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "repair/holes/plane_triangulation.h"
#include "voxel/random.h"

namespace isoshell::repair {
namespace {

constexpr double kMarginSteps = 1 << 12;
constexpr uint64_t kSwellSteps = 192, kSwellMoreSteps = 256;  // at least, and less than that more
constexpr int kJitterSteps = 3;

/// By what a point is moved so that planes with these normals, of length 1, all move outward by 1, as far as they can.
/// The sums are of n n and of n.
WorldPoint outward(const std::array<double, 6>& nn, const WorldPoint& n) {
  constexpr double kKeep = 1e-3;  // of those along which no plane looks
  const double xx = nn[0] + kKeep, yy = nn[1] + kKeep, zz = nn[2] + kKeep, xy = nn[3], yz = nn[4], zx = nn[5];
  const WorldPoint a{xx, xy, zx}, b{xy, yy, yz}, c{zx, yz, zz};
  const double volume = dot(a, cross(b, c));
  WorldPoint d = (1 / volume) * WorldPoint{dot(n, cross(b, c)), dot(a, cross(n, c)), dot(a, cross(b, n))};
  const double farthest = 4, far = length(d);
  return far > farthest ? (farthest / far) * d : d;
}

}  // namespace

Steps::Steps(const RepairMesh& mesh) {
  const WorldBox box = box_of(mesh.position, mesh.face);
  least = box.min;
  a_step = longest_side(box) / (double(kLargestInPlane) - 2 * kMarginSteps);
}

WorldPoint Steps::from(const WorldPoint& p) const {
  const WorldPoint s = (1 / a_step) * (p - least);
  return {s.x + kMarginSteps, s.y + kMarginSteps, s.z + kMarginSteps};
}

WorldPoint Steps::to_world(const WorldPoint& s) const {
  return least + a_step * WorldPoint{s.x - kMarginSteps, s.y - kMarginSteps, s.z - kMarginSteps};
}

void swell(Solid& solid, const std::vector<WorldPoint>& position, const Steps& steps, uint64_t seed) {
  const uint64_t by = kSwellSteps + random_bits(seed, kNoFace) % kSwellMoreSteps;
  std::vector<std::array<double, 6>> nn(solid.origin.size());
  std::vector<WorldPoint> n(solid.origin.size(), WorldPoint{0, 0, 0});
  for (const Corners& f : solid.face) {
    const WorldPoint &a = position[solid.origin[f[0]]], &b = position[solid.origin[f[1]]],
                     &c = position[solid.origin[f[2]]];
    const WorldPoint doubled = doubled_area(a, b, c);
    const double area = length(doubled);
    if (!(area > 0)) continue;
    const WorldPoint u = (1 / area) * doubled;
    for (const uint32_t v : f) {
      nn[v] = {nn[v][0] + u.x * u.x, nn[v][1] + u.y * u.y, nn[v][2] + u.z * u.z,
               nn[v][3] + u.x * u.y, nn[v][4] + u.y * u.z, nn[v][5] + u.z * u.x};
      n[v] = n[v] + u;
    }
  }
  solid.point.resize(solid.origin.size());
  for (size_t v = 0; v < solid.point.size(); ++v) {
    const uint64_t bits = random_bits(seed, v);
    const auto jitter = [&](int shift) {
      return double(int((bits >> shift) & 0xffff) % (2 * kJitterSteps + 1) - kJitterSteps);
    };
    const WorldPoint p = steps.from(position[solid.origin[v]]) + double(by) * outward(nn[v], n[v]);
    solid.point[v] = {std::floor(p.x + .5) + jitter(0), std::floor(p.y + .5) + jitter(16),
                      std::floor(p.z + .5) + jitter(32)};
  }
}

}  // namespace isoshell::repair
