#include "features/mesh/remove_slivers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/mesh/twin_triangles.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kThinHeight = 1e-5;           // of the largest extent: what floats round is 100 times smaller
constexpr double kThinRoundings = 16;          // a triangle as high turns by 5 degrees where its vertices are rounded
constexpr double kMostOffPlane = 1. / 16;      // of the least height: what rounding may have moved from a plane
constexpr double kLeastCosine = .5;            // between normals before and after a change
constexpr double kRoundedAway = 1e-9;          // sums of two angles of 180 degrees, as in grids, are not told from it
constexpr double kParallel = .999;             // cosine between normals in one plane
constexpr uint32_t kMostAround = 1024;         // triangles around a vertex that is changed
constexpr size_t kChangesBetweenLooks = 4096;  // whether the run goes on
constexpr size_t kMostChanges = 64;  // a thin triangle, far more than it takes; rounding may not make it endless

double height_of(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double longest = std::sqrt(std::max({distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)}));
  return longest > 0 ? length(doubled_area(a, b, c)) / longest : 0;
}

class Slivers : private TwinTriangles {
 public:
  /// `twin`: between edges that are kept.
  Slivers(FeatureMesh& mesh, std::vector<uint32_t>& twin, double least_height, const std::vector<uint64_t>& kept)
      : TwinTriangles(mesh.triangles, twin),
        mesh_(mesh),
        least_(least_height),
        stays_(mesh.vertices.size(), 0),
        corners_at_(mesh.vertices.size(), 0) {
    for (const uint64_t edge : kept) stays_[edge >> 32] = stays_[uint32_t(edge)] = 1;
    for (const auto& t : mesh.triangles)
      for (const uint32_t v : t) ++corners_at_[v];
  }

  bool remove(std::vector<uint32_t> thin, const Context& context) {
    waiting_ = with_planes_of(std::move(thin));
    std::reverse(waiting_.begin(), waiting_.end());
    size_t changes = 0;
    for (const size_t most = kMostChanges * waiting_.size(); !waiting_.empty() && changes < most;) {
      const uint32_t t = waiting_.back();
      waiting_.pop_back();
      if (is_removed(t) || !change(t)) continue;
      if (++changes % kChangesBetweenLooks == 0) check_cancel(context, "features");
    }
    return changes > 0;
  }

  void drop_removed() {
    const size_t before = mesh_.triangles.size();
    size_t kept = 0;
    for (size_t t = 0; t < before; ++t) {
      if (is_removed(uint32_t(t))) continue;
      mesh_.triangles[kept] = mesh_.triangles[t];
      mesh_.source_face[kept++] = mesh_.source_face[t];
    }
    if (kept == before) return;
    mesh_.triangles.resize(kept);
    mesh_.source_face.resize(kept);
    std::vector<uint32_t> number(mesh_.vertices.size(), kNone);
    uint32_t count = 0;
    for (uint32_t v = 0; v < number.size(); ++v) {
      if (corners_at_[v] == 0) continue;
      mesh_.vertices[count] = mesh_.vertices[v];
      number[v] = count++;
    }
    mesh_.vertices.resize(count);
    for (auto& t : mesh_.triangles)
      for (uint32_t& v : t) v = number[v];
  }

 private:
  const WorldPoint& at(uint32_t v) const { return mesh_.vertices[v]; }
  double length_at(uint32_t h) const { return std::sqrt(distance_sq(at(from(h)), at(to(h)))); }
  bool is_removed(uint32_t t) const { return mesh_.triangles[t][0] == kNone; }
  double height(uint32_t t) const {
    const auto& c = mesh_.triangles[t];
    return height_of(at(c[0]), at(c[1]), at(c[2]));
  }
  bool is_thin(uint32_t t) const { return !is_removed(t) && height(t) < least_; }
  void wait_if_thin(uint32_t t) {
    if (is_thin(t)) waiting_.push_back(t);
  }

  /// And all triangles that are in a plane with them, as far as these hang together: that of the first of them that is
  /// not thin.
  std::vector<uint32_t> with_planes_of(std::vector<uint32_t> triangles) const {
    std::vector<uint8_t> is_in(mesh_.triangles.size(), 0);
    for (const uint32_t t : triangles) is_in[t] = 1;
    std::vector<WorldPoint> plane(triangles.size(), {0, 0, 0});
    for (size_t i = 0; i < triangles.size(); ++i) {
      if (length_sq(plane[i]) == 0 && !is_thin(triangles[i])) plane[i] = area_of(triangles[i]);
      for (const uint32_t h : {3 * triangles[i], 3 * triangles[i] + 1, 3 * triangles[i] + 2}) {
        if (twin_[h] == kNone || is_in[twin_[h] / 3] || !is_flat(h)) continue;
        const WorldPoint n = area_of(twin_[h] / 3);
        if (dot(n, plane[i]) < kParallel * length(n) * length(plane[i]) && !is_thin(twin_[h] / 3)) continue;
        is_in[twin_[h] / 3] = 1;
        triangles.push_back(twin_[h] / 3);
        plane.push_back(plane[i]);
      }
    }
    return triangles;
  }

  WorldPoint area_of(uint32_t t) const {
    const auto& c = mesh_.triangles[t];
    return doubled_area(at(c[0]), at(c[1]), at(c[2]));
  }

  /// Whether the triangles of an edge are in a plane, and face the same way.
  bool is_flat(uint32_t h) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    const WorldPoint at_c = doubled_area(a, b, c), at_d = doubled_area(b, a, d);
    return std::abs(dot(at_c, d - a)) <= kMostOffPlane * least_ * length(at_c + at_d) && dot(at_c, at_d) >= 0;
  }

  bool change(uint32_t t) {
    std::array<uint32_t, 3> edge{3 * t, 3 * t + 1, 3 * t + 2};
    std::stable_sort(edge.begin(), edge.end(), [&](uint32_t g, uint32_t h) { return length_at(g) > length_at(h); });
    if (const uint32_t h = edge[2]; twin_[h] != kNone && length_at(h) < least_) {
      const bool starts_at_fewer = corners_at_[from(h)] <= corners_at_[to(h)];
      for (const uint32_t along : {starts_at_fewer ? h : twin_[h], starts_at_fewer ? twin_[h] : h}) {
        if (!may_collapse(along)) continue;
        collapse(along);
        return true;
      }
    }
    for (const uint32_t h : edge) {
      if (twin_[h] == kNone || !should_flip(h, h == edge[0])) continue;
      flip_edge(h);
      return true;
    }
    return false;
  }

  bool should_flip(uint32_t h, bool is_longest) const {
    const uint32_t g = twin_[h];
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(g));
    const WorldPoint at_c = doubled_area(a, b, c), at_d = doubled_area(b, a, d);
    if (is_longest && is_thin(h / 3) && is_thin(g / 3) && is_longest_of(g))
      return length(d - c) < length(b - a) && !may_be_beside(before(h), opposite(g));
    const bool flat = is_flat(h);
    if (!(flat ? is_obtuse(h, at_c, at_d) : is_longest && is_thin(h / 3) && is_cap_beside(h))) return false;
    const WorldPoint side = flat ? at_c + at_d : at_d, at_a = doubled_area(a, d, c), at_b = doubled_area(b, c, d);
    const auto faces_so = [&](const WorldPoint& n) { return dot(n, side) > kLeastCosine * length(n) * length(side); };
    return faces_so(at_a) && faces_so(at_b) && !may_be_beside(before(h), opposite(g));
  }

  bool is_longest_of(uint32_t h) const { return length_at(h) >= std::max(length_at(next(h)), length_at(before(h))); }

  /// Whether the angles at c and d are more than 180 degrees together.
  bool is_obtuse(uint32_t h, const WorldPoint& at_c, const WorldPoint& at_d) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    const double left = dot(a - c, b - c) * length(at_d), right = dot(a - d, b - d) * length(at_c);
    return left + right < -kRoundedAway * (std::abs(left) + std::abs(right));
  }

  /// Of a triangle whose corner c is nearly on the edge: whether the other one is high enough, and both are higher
  /// afterwards.
  bool is_cap_beside(uint32_t h) const {
    const WorldPoint &a = at(from(h)), &b = at(to(h)), &c = at(opposite(h)), &d = at(opposite(twin_[h]));
    return !is_thin(twin_[h] / 3) && std::min(height_of(a, d, c), height_of(b, c, d)) > height(h / 3);
  }

  /// Whether an edge joins the vertex that a half-edge begins at to another one, or may: there are other fans at it, or
  /// too many triangles.
  bool may_be_beside(uint32_t begin, uint32_t other) const {
    if (corners_at_[from(begin)] > kMostAround) return true;
    uint32_t count = 0;
    bool is_found = false;
    visit_fan(begin, [&](uint32_t h) {
      ++count;
      is_found = to(h) == other || opposite(h) == other;
      return !is_found;
    });
    return is_found || count != corners_at_[from(begin)];
  }

  void flip_edge(uint32_t h) {
    const uint32_t t = h / 3, u = twin_[h] / 3;
    --corners_at_[from(h)], --corners_at_[to(h)], ++corners_at_[opposite(h)], ++corners_at_[opposite(twin_[h])];
    flip(h);
    // Edges t + 1 and u + 1 are the one that was made.
    for (const uint32_t outer : {3 * t, 3 * t + 2, 3 * u, 3 * u + 2})
      if (twin_[outer] != kNone) wait_if_thin(twin_[outer] / 3);
    waiting_.insert(waiting_.end(), {u, t});
  }

  /// Whether the vertex that a half-edge begins at may go to its end: around it is one closed fan, no other vertex than
  /// c and d is beside both, and no triangle of it turns far.
  bool may_collapse(uint32_t h) const {
    const uint32_t a = from(h), b = to(h), c = opposite(h), d = opposite(twin_[h]);
    if (stays_[a] || c == d || corners_at_[a] > kMostAround || corners_at_[c] < 4 || corners_at_[d] < 4) return false;
    uint32_t count = 0;
    bool may = true;
    const bool is_closed = visit_fan(h, [&](uint32_t out) {
      ++count;
      const uint32_t x = to(out), y = opposite(out);
      if (x == b || y == b) return true;
      const WorldPoint was = doubled_area(at(a), at(x), at(y)), now = doubled_area(at(b), at(x), at(y));
      may = (is_thin(out / 3) || dot(was, now) > kLeastCosine * length(was) * length(now)) &&
            (x == c || x == d || !may_be_beside(next(h), x));
      return may;
    });
    return may && is_closed && count == corners_at_[a];
  }

  /// The edges a, c and b, c become one, so do a, d and b, d.
  void collapse(uint32_t h) {
    const uint32_t g = twin_[h], a = from(h), b = to(h);
    std::vector<uint32_t> around;
    visit_fan(h, [&](uint32_t out) {
      around.push_back(out);
      return true;
    });
    for (const uint32_t out : around) mesh_.triangles[out / 3][out % 3] = b;
    --corners_at_[opposite(h)], --corners_at_[opposite(g)];
    corners_at_[b] += corners_at_[a] - 4;
    corners_at_[a] = 0;
    stays_[b] = 1;  // what was taken into it would go farther with it
    for (const uint32_t edge : {h, g}) {
      connect(twin_[next(edge)], twin_[before(edge)]);
      for (const uint32_t e : {edge, next(edge), before(edge)}) twin_[e] = kNone;
      mesh_.triangles[edge / 3] = {kNone, kNone, kNone};
    }
    for (const uint32_t out : around) wait_if_thin(out / 3);
  }

  FeatureMesh& mesh_;
  double least_;
  std::vector<uint8_t> stays_;        ///< per vertex
  std::vector<uint32_t> corners_at_;  ///< per vertex
  std::vector<uint32_t> waiting_;     ///< triangles
};

}  // namespace

double least_height_world(const FeatureMesh& mesh) {
  const double extent = mesh.vertices.empty() ? 0 : longest_side(box_of(mesh.vertices));
  return std::max(kThinHeight * extent, kThinRoundings * mesh.rounding_world);
}

bool remove_slivers(FeatureMesh& mesh, const std::vector<uint64_t>& kept, const Context& context) {
  const double least = least_height_world(mesh);
  std::vector<uint8_t> is_thin(mesh.triangles.size());
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    is_thin[t] = height_of(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) < least;
  });
  std::vector<uint32_t> thin;
  for (uint32_t t = 0; t < is_thin.size(); ++t)
    if (is_thin[t]) thin.push_back(t);
  if (thin.empty()) return false;
  MeshTwins twins = find_twins(mesh.triangles, find_edge_sides(mesh.triangles, mesh.vertices.size()), kept);
  Slivers slivers(mesh, twins.of, least, kept);
  const bool has_changed = slivers.remove(std::move(thin), context);
  slivers.drop_removed();
  return has_changed;
}

}  // namespace isoshell
