#include "features/mesh/remove_slivers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <unordered_set>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/mesh/editable_mesh.h"
#include "features/mesh/mesh_fans.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kThinHeight = 1e-5;             // of the largest extent: what floats round is 100 times smaller
constexpr double kThinRoundings = 16;            // a triangle as high turns by 5 degrees where its vertices are rounded
constexpr double kStrip = 1. / 32;               // of the edge length: the sides of a narrower strip become one crease
constexpr double kStripIsLonger = 4;             // than it is high
constexpr double kStripTurns = .85;              // cosine between normals across its longest edge
constexpr double kAllButLongest = .95;           // of the longest edge
constexpr double kMostOffPlane = 1. / 16;        // of the least height: what rounding may have moved from a plane
constexpr double kLeastCosine = .5;              // between normals before and after a change
constexpr double kFollows = .985;                // beside a strip: the side that it is taken into stays as it lies
constexpr double kOpposite = -.87;               // cosine between normals of sides that meet at less than 30 degrees
constexpr double kRoundedAway = 1e-9;            // sums of two angles of 180 degrees, as in grids, are not told from it
constexpr double kParallel = .999;               // cosine between normals in one plane
constexpr size_t kMostAround = 1024;             // triangles around a vertex that is changed
constexpr size_t kTrianglesBetweenLooks = 4096;  // whether the run goes on
constexpr size_t kMostChanges = 64;              // a thin triangle, far more than it takes
constexpr double kMostCells = 8;                 // that a triangle's box meets, in the mean

bool is_long(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, double high) {
  const double longest_sq = std::max({distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)});
  return longest_sq > kStripIsLonger * kStripIsLonger * high * high;
}

/// Whether the surface turns at the longest edge of a triangle, or one all but as long: at shorter ones it does in
/// planes with a round border, too. `area_beside(edge)`: of the triangle there, none where there is none.
template <class AreaBeside>
bool turns_at_longest(const std::array<WorldPoint, 3>& corner, AreaBeside area_beside) {
  const WorldPoint area = doubled_area(corner[0], corner[1], corner[2]);
  std::array<double, 3> long_sq;
  for (size_t i = 0; i < 3; ++i) long_sq[i] = distance_sq(corner[i], corner[(i + 1) % 3]);
  const double longest_sq = std::max({long_sq[0], long_sq[1], long_sq[2]});
  for (size_t i = 0; i < 3; ++i) {
    if (long_sq[i] < kAllButLongest * kAllButLongest * longest_sq) continue;
    const WorldPoint beside = area_beside(i);
    if (dot(area, beside) < kStripTurns * length(area) * length(beside)) return true;
  }
  return false;
}

/// In steps, half a step off: without fractions that is the place that the frame snaps to.
WorldPoint on_lattice(const WorldPoint& p, const LatticeFrame& frame) {
  return (kOneVoxelQ8 / frame.voxel_size) * (p - frame.origin) + WorldPoint{.5, .5, .5};
}

/// Vertices at edges that have no two sides, or are kept, are corners: they stay.
EditableMesh editable(const FeatureMesh& mesh, MeshTwins twins, const LatticeFrame& frame) {
  std::vector<RegionVertex> vertices(mesh.vertices.size());
  for (size_t v = 0; v < vertices.size(); ++v) vertices[v].position = on_lattice(mesh.vertices[v], frame);
  std::vector<RegionTriangle> triangles(mesh.triangles.size());
  std::vector<uint64_t> on_curves;
  for (uint32_t h = 0; h < twins.of.size(); ++h) {
    RegionTriangle& t = triangles[h / 3];
    const std::array<uint32_t, 3>& corner = mesh.triangles[h / 3];
    t.corner[h % 3] = corner[h % 3];
    t.curve[h % 3] = twins.of[h] == kNone ? 0 : kNone;
    if (twins.of[h] == kNone) on_curves.push_back(edge_key(corner[h % 3], corner[(h + 1) % 3]));
  }
  std::sort(on_curves.begin(), on_curves.end());
  on_curves.erase(std::unique(on_curves.begin(), on_curves.end()), on_curves.end());
  for (const uint64_t edge : on_curves)
    vertices[edge >> 32].kind = vertices[uint32_t(edge)].kind = RegionVertex::Kind::corner;
  const MeshFans fans = find_fans(mesh.triangles, int64_t(vertices.size()), on_curves, std::move(twins));
  std::vector<uint32_t> fan(vertices.size(), kNone);
  for (const uint32_t v : fans.vertex) {
    if (fan[v] != kNone) vertices[v].kind = RegionVertex::Kind::corner;
    fan[v] = v;
  }
  return {std::move(vertices), std::move(triangles), EditableMesh::Size::many};
}

class Slivers : private EditableMesh {
 public:
  /// Heights in steps.
  Slivers(EditableMesh mesh, double least_height, double strip_height)
      : EditableMesh(std::move(mesh)), least_(least_height), strip_(strip_height), reach_(vertices().size(), 0) {}

  /// `found`: slivers, which are not gone.
  bool remove(std::vector<uint32_t> found, const Context& context) {
    waiting_ = with_planes_of(std::move(found));
    std::reverse(waiting_.begin(), waiting_.end());
    size_t changes = 0;
    for (size_t looks = 1, most = kMostChanges * waiting_.size(); !waiting_.empty() && changes < most; ++looks) {
      const uint32_t t = waiting_.back();
      waiting_.pop_back();
      if (looks % kTrianglesBetweenLooks == 0) check_cancel(context, "features");
      if (!triangles()[t].is_gone() && change(t)) ++changes;
    }
    return changes > 0;
  }

  /// Writes what is left into the mesh that it was made from.
  void put_into(FeatureMesh& mesh) const {
    size_t kept = 0;
    for (size_t t = 0; t < triangles().size(); ++t) {
      if (triangles()[t].is_gone()) continue;
      mesh.triangles[kept] = triangles()[t].corner;
      mesh.source_face[kept++] = mesh.source_face[t];
    }
    mesh.triangles.resize(kept);
    mesh.source_face.resize(kept);
    std::vector<uint32_t> number(mesh.vertices.size(), kNone);
    uint32_t count = 0;
    for (uint32_t v = 0; v < number.size(); ++v) {
      if (around(v).empty()) continue;
      mesh.vertices[count] = mesh.vertices[v];
      number[v] = count++;
    }
    mesh.vertices.resize(count);
    for (auto& t : mesh.triangles)
      for (uint32_t& v : t) v = number[v];
  }

 private:
  /// An edge a, b between a triangle with the third corner c and one with d.
  struct Flap {
    uint32_t a, b, c, d, triangle, other;
    size_t edge;
  };

  /// Only when the first change is about to be made. On scans none is, and putting triangles into cells takes longer
  /// than all else.
  void keep_apart_from_now_on() {
    if (!std::exchange(is_apart_, true)) keep_apart(cell());
  }

  /// A triangle's box meets few of them in the mean, however large some triangles are.
  double cell() const {
    for (double side = 64;; side *= 2) {
      double cells = 0;
      for (const RegionTriangle& t : triangles()) {
        const auto box = box_of(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]));
        const WorldPoint size = (1 / side) * (box.max - box.min);
        cells += (1 + size.x) * (1 + size.y) * (1 + size.z);
      }
      if (cells <= kMostCells * double(triangles().size())) return side;
    }
  }

  /// None of an edge without two sides.
  std::optional<Flap> flap(uint32_t t, size_t edge) const {
    const RegionTriangle& triangle = triangles()[t];
    if (triangle.curve[edge] != kNone) return {};
    const uint32_t a = triangle.corner[edge], b = triangle.corner[(edge + 1) % 3], c = triangle.corner[(edge + 2) % 3];
    const uint32_t fewer = around(a).size() < around(b).size() ? a : b;
    const uint32_t other = find_around(fewer, [&](const RegionTriangle& s) { return s.edge_between(b, a) < 3; });
    const RegionTriangle& beside = triangles()[other];
    return Flap{a, b, c, beside.corner[(beside.edge_between(b, a) + 2) % 3], t, other, edge};
  }
  double length_of(uint32_t t, size_t edge) const {
    const auto& c = triangles()[t].corner;
    return length(at(c[(edge + 1) % 3]) - at(c[edge]));
  }
  double longest_of(uint32_t t) const { return std::max({length_of(t, 0), length_of(t, 1), length_of(t, 2)}); }
  WorldPoint area_of(uint32_t t) const { return normal(triangles()[t]); }
  double height(uint32_t t) const {
    const auto& [a, b, c] = triangles()[t].corner;
    return triangle_height(at(a), at(b), at(c));
  }
  bool is_thin(uint32_t t) const { return !triangles()[t].is_gone() && (height(t) < least_ || is_of_strip(t)); }
  bool is_of_strip(uint32_t t) const {
    const auto& [a, b, c] = triangles()[t].corner;
    const double high = height(t);
    return high < strip_ && is_long(at(a), at(b), at(c), high) && turns_beside(t);
  }
  bool turns_beside(uint32_t t) const {
    const auto& [a, b, c] = triangles()[t].corner;
    return turns_at_longest({at(a), at(b), at(c)}, [&](size_t edge) {
      const std::optional<Flap> beside = flap(t, edge);
      return beside ? area_of(beside->other) : WorldPoint{0, 0, 0};
    });
  }

  /// And all triangles that are in a plane with them, as far as these hang together: that of the first of them that is
  /// not thin.
  std::vector<uint32_t> with_planes_of(std::vector<uint32_t> found) const {
    std::vector<uint8_t> is_in(triangles().size(), 0);
    for (const uint32_t t : found) is_in[t] = 1;
    std::vector<WorldPoint> plane(found.size(), {0, 0, 0});
    for (size_t i = 0; i < found.size(); ++i) {
      if (length_sq(plane[i]) == 0 && !is_thin(found[i])) plane[i] = area_of(found[i]);
      for (size_t edge = 0; edge < 3; ++edge) {
        const std::optional<Flap> beside = flap(found[i], edge);
        if (!beside || is_in[beside->other] || !is_flat(*beside)) continue;
        const WorldPoint n = area_of(beside->other);
        if (dot(n, plane[i]) < kParallel * length(n) * length(plane[i]) && !is_thin(beside->other)) continue;
        is_in[beside->other] = 1;
        found.push_back(beside->other);
        plane.push_back(plane[i]);
      }
    }
    return found;
  }

  /// Whether the triangles of an edge are in a plane, and face the same way.
  bool is_flat(const Flap& f) const {
    const WorldPoint at_c = area_of(f.triangle), at_d = area_of(f.other);
    return std::abs(dot(at_c, at(f.d) - at(f.a))) <= kMostOffPlane * least_ * length(at_c + at_d) &&
           dot(at_c, at_d) >= 0;
  }

  bool change(uint32_t t) {
    std::array<size_t, 3> edge{0, 1, 2};
    std::stable_sort(edge.begin(), edge.end(), [&](size_t i, size_t j) { return length_of(t, i) > length_of(t, j); });
    const double most = is_of_strip(t) ? std::max(least_, strip_) : least_;
    if (const std::optional<Flap> shortest = flap(t, edge[2]);
        shortest && length_of(t, edge[2]) < most && collapse_either(*shortest, most))
      return true;
    for (const size_t i : edge) {
      const std::optional<Flap> f = flap(t, i);
      if (f && flip(*f, i == edge[0])) return true;
    }
    return false;
  }

  bool may_change_around(uint32_t v) const { return around(v).size() <= kMostAround; }
  void wait_if_thin(uint32_t t) {
    if (is_thin(t)) waiting_.push_back(t);
  }

  bool should_flip(const Flap& f, bool is_longest) const {
    if (is_longest && is_thin(f.triangle) && is_thin(f.other) && longest_of(f.other) <= length_of(f.triangle, f.edge))
      return length(at(f.d) - at(f.c)) < length(at(f.b) - at(f.a));
    const bool flat = is_flat(f);
    if (!(flat ? is_obtuse(f) : is_longest && is_thin(f.triangle) && is_cap(f))) return false;
    const WorldPoint side = flat ? area_of(f.triangle) + area_of(f.other) : area_of(f.other);
    const double most_turn = flat || height(f.triangle) < least_ ? kLeastCosine : kFollows;
    const auto faces_so = [&](const WorldPoint& n) { return dot(n, side) > most_turn * length(n) * length(side); };
    if (!faces_so(doubled_area(at(f.a), at(f.d), at(f.c))) || !faces_so(doubled_area(at(f.b), at(f.c), at(f.d))))
      return false;
    return flat || height(f.triangle) < least_ || !has_back_of(side, f.c);
  }

  /// Whether the angles at c and d are more than 180 degrees together.
  bool is_obtuse(const Flap& f) const {
    const WorldPoint &a = at(f.a), &b = at(f.b), &c = at(f.c), &d = at(f.d);
    const double left = dot(a - c, b - c) * length(area_of(f.other)),
                 right = dot(a - d, b - d) * length(area_of(f.triangle));
    return left + right < -kRoundedAway * (std::abs(left) + std::abs(right));
  }

  /// Of a triangle whose corner c is nearly on the edge: whether the other one is high enough, and both are higher
  /// afterwards.
  bool is_cap(const Flap& f) const {
    const WorldPoint &a = at(f.a), &b = at(f.b), &c = at(f.c), &d = at(f.d);
    return !is_thin(f.other) && std::min(triangle_height(a, d, c), triangle_height(b, c, d)) > height(f.triangle);
  }

  static bool are_opposite(const WorldPoint& m, const WorldPoint& n) {
    return dot(m, n) < kOpposite * length(m) * length(n);
  }
  /// Whether a triangle around a vertex is the other side of a thin wall.
  bool has_back_of(const WorldPoint& side, uint32_t v) const {
    return std::any_of(around(v).begin(), around(v).end(), [&](uint32_t t) { return are_opposite(side, area_of(t)); });
  }
  /// Whether surfaces beside narrow triangles around two vertices look away from each other.
  bool are_sides_of_wall(uint32_t v, uint32_t w) const {
    std::vector<WorldPoint> sides;
    for (const uint32_t at : {v, w})
      for (const uint32_t t : around(at))
        if (is_thin(t)) append_sides(t, sides);
    for (size_t i = 0; i < sides.size(); ++i)
      for (size_t j = 0; j < i; ++j)
        if (are_opposite(sides[i], sides[j])) return true;
    return false;
  }
  /// Across edges that are not short.
  void append_sides(uint32_t t, std::vector<WorldPoint>& sides) const {
    for (size_t edge = 0; edge < 3; ++edge)
      if (const std::optional<Flap> beside = flap(t, edge); beside && 2 * length_of(t, edge) > longest_of(t))
        sides.push_back(area_of(beside->other));
  }

  bool flip(const Flap& f, bool is_longest) {
    if (!may_change_around(f.c) || !may_change_around(f.d) || was_flipped_.count(edge_key(f.c, f.d)) > 0) return false;
    const auto may_flip = [&] {
      if (!should_flip(f, is_longest)) return false;
      keep_apart_from_now_on();
      return true;
    };
    if (!EditableMesh::flip(f.triangle, f.edge, change_, may_flip)) return false;
    was_flipped_.insert(edge_key(f.a, f.b));
    for (const uint32_t t : {f.triangle, f.other})
      for (size_t i = 0; i < 3; ++i)
        if (const std::optional<Flap> beside = flap(t, i);
            beside && beside->other != f.triangle && beside->other != f.other)
          wait_if_thin(beside->other);
    waiting_.insert(waiting_.end(), {f.other, f.triangle});
    return true;
  }

  bool collapse_either(const Flap& f, double most) {
    const bool starts_at_fewer = around(f.a).size() <= around(f.b).size();
    const uint32_t first = starts_at_fewer ? f.a : f.b, second = starts_at_fewer ? f.b : f.a;
    return collapse(first, second, most) || collapse(second, first, most);
  }
  /// Where nothing is taken as far as `most`.
  bool collapse(uint32_t gone, uint32_t into, double most) {
    const double way = length(at(into) - at(gone)), reach = reach_[gone] + way;
    if (reach >= most || !may_change_around(gone) || !may_change_around(into)) return false;
    if (way >= least_ && are_sides_of_wall(gone, into)) return false;
    const auto turns_little = [&] {
      for (size_t i = 0; i < change_.made.size(); ++i) {
        const WorldPoint was = area_of(change_.number[i]), now = normal(change_.made[i]);
        if (!is_thin(change_.number[i]) && !(dot(was, now) > kLeastCosine * length(was) * length(now))) return false;
      }
      keep_apart_from_now_on();
      return true;
    };
    if (!EditableMesh::collapse(gone, into, change_, turns_little)) return false;
    reach_[into] = std::max(reach_[into], reach);
    for (const uint32_t t : change_.number) wait_if_thin(t);
    return true;
  }

  double least_, strip_;
  bool is_apart_ = false;
  std::vector<double> reach_;      ///< per vertex how far what was taken into it was away, at most
  std::vector<uint32_t> waiting_;  ///< triangles
  /// Edges do not come back: where surfaces are bent, what is better differs from triangle to triangle, without an end.
  std::unordered_set<uint64_t> was_flipped_;
  MeshChange change_;
};

/// What is less high than triangles are to be.
struct Heights {
  double least, strip;
};

/// Triangles that are less high, those of strips by their shape alone.
std::vector<uint32_t> narrow_triangles(const FeatureMesh& mesh, const Heights& heights) {
  std::vector<uint8_t> is_narrow(mesh.triangles.size());
  for_each_index(size_t(0), mesh.triangles.size(), [&](size_t t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const WorldPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double high = triangle_height(p, q, r);
    is_narrow[t] = high < heights.least || (high < heights.strip && is_long(p, q, r, high));
  });
  std::vector<uint32_t> found;
  for (uint32_t t = 0; t < is_narrow.size(); ++t)
    if (is_narrow[t]) found.push_back(t);
  return found;
}

bool is_sliver(const FeatureMesh& mesh, const MeshTwins& twins, uint32_t t, double least_height_world) {
  const auto corners = [&](uint32_t of) {
    const auto& [a, b, c] = mesh.triangles[of];
    return std::array<WorldPoint, 3>{mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]};
  };
  const std::array<WorldPoint, 3> c = corners(t);
  return triangle_height(c[0], c[1], c[2]) < least_height_world || turns_at_longest(c, [&](size_t edge) {
           const uint32_t twin = twins.of[3 * t + edge];
           if (twin == kNone) return WorldPoint{0, 0, 0};
           const std::array<WorldPoint, 3> beside = corners(twin / 3);
           return doubled_area(beside[0], beside[1], beside[2]);
         });
}

}  // namespace

double least_height_world(const FeatureMesh& mesh) {
  const double extent = mesh.vertices.empty() ? 0 : longest_side(box_of(mesh.vertices));
  return std::max(kThinHeight * extent, kThinRoundings * mesh.rounding_world);
}

bool remove_slivers(FeatureMesh& mesh, const LatticeFrame& frame, const std::vector<uint64_t>& kept,
                    double edge_length_world, const Context& context) {
  const Heights heights{least_height_world(mesh), kStrip * edge_length_world};
  std::vector<uint32_t> found = narrow_triangles(mesh, heights);
  if (found.empty()) return false;
  MeshTwins twins = find_twins(mesh.triangles, find_edge_sides(mesh.triangles, mesh.vertices.size()), kept);
  const auto is_none = [&](uint32_t t) { return !is_sliver(mesh, twins, t, heights.least); };
  found.erase(std::remove_if(found.begin(), found.end(), is_none), found.end());
  if (found.empty()) return false;
  const double steps_of_world = kOneVoxelQ8 / frame.voxel_size;
  Slivers slivers(editable(mesh, std::move(twins), frame), steps_of_world * heights.least,
                  steps_of_world * heights.strip);
  const bool has_changed = slivers.remove(std::move(found), context);
  if (has_changed) slivers.put_into(mesh);
  return has_changed;
}

}  // namespace isoshell
