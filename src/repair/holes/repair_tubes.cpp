#include "repair/holes/repair_tubes.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

constexpr double kFacing = .8;          // cosine between the way and where a rim looks
constexpr double kRunsAlong = .4;       // mean cosine, without sign, between where rims look and the faces at them
constexpr double kWidthsApart = 2.5;    // between their radii
constexpr double kFarthest = 3;         // in sums of their radii
constexpr double kFarthestApart = 1;    // of different surfaces: a bottle's cap lies farther from it
constexpr double kLargestEnd = .2;      // of the area of the surface that it was cut off
constexpr size_t kMostRungs = 4 << 20;  // tried
constexpr size_t kMostRims = 20000;     // more are no holes in a surface

/// A loop as the end of a tube.
struct Rim {
  const Loop* loop;
  WorldPoint middle, looks;  ///< looks: of length 1, out of the surface that it ends
  double radius = 0;         ///< of a circle of its area
  double along = 1;          ///< cosine, without sign, between where it looks and the mean normal of the faces at it
  uint32_t patch = 0;
  double patch_area = 0;
};

Rim rim_of(const RepairMesh& mesh, const Loop& loop) {
  Rim rim = {&loop, {0, 0, 0}, {0, 0, 0}};
  const WorldPoint start = mesh.position[mesh.from(loop[0])];
  WorldPoint doubled_area = {0, 0, 0}, sum = {0, 0, 0};
  for (uint32_t h : loop) {
    const WorldPoint p = mesh.position[mesh.from(h)] - start, q = mesh.position[mesh.to(h)] - start;
    doubled_area = doubled_area + cross(q, p);  // the cap passes the loop the other way
    sum = sum + p;
  }
  const double size = length(doubled_area);
  if (!(size > 0)) return rim;
  rim.middle = start + 1 / double(loop.size()) * sum;
  rim.looks = 1 / size * doubled_area;
  rim.radius = std::sqrt(size / 6.283185307179586);
  rim.along = 0;
  for (uint32_t h : loop) {
    const WorldPoint n = mesh.doubled_area(h / 3);
    if (const double area = length(n); area > 0) rim.along += dot(n, rim.looks) / area / double(loop.size());
  }
  rim.along = std::abs(rim.along);
  return rim;
}

bool is_simple(const RepairMesh& mesh, const Loop& loop) {
  std::vector<uint32_t> vertex;
  for (uint32_t h : loop) vertex.push_back(mesh.from(h));
  std::sort(vertex.begin(), vertex.end());
  return std::adjacent_find(vertex.begin(), vertex.end()) == vertex.end();
}

/// Of one surface, or of a surface and an end that it lost. Two pipes in a line are two bodies.
bool may_be_one_body(const Rim& p, const Rim& q) {
  return p.patch == q.patch ||
         std::min(p.patch_area, q.patch_area) <= kLargestEnd * std::max(p.patch_area, q.patch_area);
}

/// How far apart rims of one tube are; infinity for others.
double gap_between(const Rim& p, const Rim& q) {
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const WorldPoint way = q.middle - p.middle;
  const double gap = length(way), wide = p.radius + q.radius;
  const double farthest = p.patch == q.patch ? kFarthest : kFarthestApart;
  if (!may_be_one_body(p, q) || !(gap > 0) || gap > farthest * wide ||
      std::max(p.radius, q.radius) > kWidthsApart * std::min(p.radius, q.radius))
    return kNone;
  const bool face = dot(way, p.looks) >= kFacing * gap && dot(way, q.looks) <= -kFacing * gap;
  return face && (p.along + q.along) / 2 <= kRunsAlong ? gap : kNone;
}

/// Per rim the nearest one that may be the other end of its tube; itself where there is none. Rims by x.
std::vector<size_t> nearest_ends(const std::vector<Rim>& rims) {
  std::vector<size_t> nearest(rims.size());
  std::vector<double> gap(rims.size(), std::numeric_limits<double>::infinity());
  for (size_t i = 0; i < rims.size(); ++i) nearest[i] = i;
  for (size_t i = 0; i < rims.size(); ++i) {
    const double reach = kFarthest * (1 + kWidthsApart) * rims[i].radius;
    for (size_t j = i + 1; j < rims.size() && rims[j].middle.x - rims[i].middle.x <= reach; ++j) {
      const double here = gap_between(rims[i], rims[j]);
      if (here < gap[i]) gap[i] = here, nearest[i] = j;
      if (here < gap[j]) gap[j] = here, nearest[j] = i;
    }
  }
  return nearest;
}

/// Faces between two rims: of all strips from the shortest rung on the one whose rungs have the least sum of squares.
class Strip {
 public:
  Strip(const RepairMesh& mesh, const Loop& p, const Loop& q) : mesh_(mesh) {
    // Faces pass the rims the other way; seen along the tube the two then run in opposite directions.
    for (size_t i = p.size(); i-- > 0;) p_.push_back(mesh.from(p[i]));
    for (uint32_t h : q) q_.push_back(mesh.from(h));
    start_at_shortest_rung();
  }

  /// None where a rung is an edge already, or the rims meet.
  std::vector<Corners> faces() const {
    const size_t n = p_.size(), m = q_.size(), row = m + 1;
    std::vector<double> cost((n + 1) * row, 0);
    for (size_t i = 0; i <= n; ++i)
      for (size_t j = 0; j <= m; ++j)
        if (i + j > 0) {
          const double before =
              std::min(i > 0 ? cost[(i - 1) * row + j] : kNever, j > 0 ? cost[i * row + j - 1] : kNever);
          cost[i * row + j] = before + rung_sq(i, j);
        }
    std::vector<Corners> faces;
    for (size_t i = n, j = m; i + j > 0;) {
      const uint32_t p = p_[i % n], q = q_[j % m];
      if (p == q || mesh_.has_edge(p, q)) return {};
      const bool along_p = j == 0 || (i > 0 && cost[(i - 1) * row + j] <= cost[i * row + j - 1]);
      if (along_p)
        faces.push_back({p_[--i], p, q});
      else
        faces.push_back({q, q_[--j], p});
    }
    return faces;
  }

 private:
  static constexpr double kNever = std::numeric_limits<double>::infinity();

  double rung_sq(size_t i, size_t j) const {
    const WorldPoint d = mesh_.position[p_[i % p_.size()]] - mesh_.position[q_[j % q_.size()]];
    return dot(d, d);
  }
  void start_at_shortest_rung() {
    size_t first = 0, second = 0;
    for (size_t i = 0; i < p_.size(); ++i)
      for (size_t j = 0; j < q_.size(); ++j)
        if (rung_sq(i, j) < rung_sq(first, second)) first = i, second = j;
    std::rotate(p_.begin(), p_.begin() + int64_t(first), p_.end());
    std::rotate(q_.begin(), q_.begin() + int64_t(second), q_.end());
  }

  const RepairMesh& mesh_;
  std::vector<uint32_t> p_, q_;
};

}  // namespace

std::vector<Cap> find_tubes(const RepairMesh& mesh, const std::vector<Loop>& loops) {
  const Patches patches = find_patches(mesh);
  const std::vector<double> area = patch_areas(mesh, patches);
  std::vector<Rim> rims;
  for (const Loop& loop : loops) {
    Rim rim = rim_of(mesh, loop);
    rim.patch = patches.of[loop[0] / 3];
    rim.patch_area = area[rim.patch];
    if (rim.radius > 0 && rim.along <= 2 * kRunsAlong && is_simple(mesh, loop)) rims.push_back(rim);
  }
  std::stable_sort(rims.begin(), rims.end(), [](const Rim& p, const Rim& q) { return p.middle.x < q.middle.x; });
  if (rims.size() > kMostRims) return {};
  const std::vector<size_t> nearest = nearest_ends(rims);
  std::vector<Cap> tubes;
  for (size_t i = 0; i < rims.size(); ++i) {
    const size_t j = nearest[i];
    if (j <= i || nearest[j] != i) continue;
    const Loop &p = *rims[i].loop, &q = *rims[j].loop;
    if (p.size() * q.size() > kMostRungs) continue;
    Cap tube = {p, Strip(mesh, p, q).faces(), 2};
    if (tube.face.empty()) continue;
    tube.loop.insert(tube.loop.end(), q.begin(), q.end());
    tubes.push_back(std::move(tube));
  }
  return tubes;
}

}  // namespace isoshell::repair
