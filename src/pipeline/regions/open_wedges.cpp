// See open_wedges.h.
#include "pipeline/regions/open_wedges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "core/watched.h"
#include "features/mesh/editable_mesh.h"
#include "geometry/dihedral.h"
#include "geometry/half_edges.h"
#include "measure/triangle_space.h"

namespace isoshell {
namespace {

constexpr double kLeastCosine = 0.984807753;     ///< of 10 degrees
constexpr double kOpened[] = {0.97437, 0.2250};  ///< cosine and sine of 13 degrees, so that rounding leaves 10
constexpr double kFarthestOfEdge = 1. / 3;
constexpr int kMostRounds = 8;

WorldPoint point(const PointQ8& p) { return {double(p.x), double(p.y), double(p.z)}; }
PointQ8 nearest(const WorldPoint& p) {
  const auto whole = [](double x) { return int32_t(std::floor(x + .5)); };
  return {whole(p.x), whole(p.y), whole(p.z)};
}

/// Two triangles, by the corners of each that the other has not.
struct Wedge {
  double cosine;
  uint32_t u, v, p, q;

  bool operator<(const Wedge& o) const {  // the sharpest first
    if (cosine != o.cosine) return cosine > o.cosine;
    return std::array{u, v, p, q} < std::array{o.u, o.v, o.p, o.q};
  }
};

class Wedges {
 public:
  Wedges(const RegionWalls& walls, const CutSurface& cut, JoinedPatches& joined) : at_(joined.mesh.position) {
    for (const TriangleIndices& t : joined.mesh.triangles) triangles_.push_back({t.a, t.b, t.c});
    sides_ = find_edge_sides(triangles_, size_t(at_.size()));
    around_ = sort_into_buckets<uint32_t>(at_.size(), int64_t(triangles_.size()), [&](int64_t t, auto put) {
      for (const uint32_t v : triangles_[size_t(t)]) put(v, uint32_t(t));
    });
    stays_.assign(size_t(at_.size()), 0);
    const std::vector<char> is_side = patches_with_sides(walls, cut);
    for (size_t t = 0; t < triangles_.size(); ++t)
      if (is_side[joined.features.patch[t]])
        for (const uint32_t v : triangles_[t]) stays_[v] = 1;
  }

  /// Ascending, those that are too narrow.
  std::vector<Wedge> find() const {
    std::vector<Wedge> found;
    for_each_edge(sides_, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
      for_each_pair(u, v, on_edge, [&](double cosine, uint32_t p, uint32_t q) {
        if (cosine > kLeastCosine) found.push_back({cosine, u, v, p, q});
      });
    });
    std::sort(found.begin(), found.end());
    return found;
  }

  void keep_apart() {
    double edges = 0;
    for (const auto& [a, b, c] : triangles_) edges += length(point(at_[b]) - point(at_[a]));
    space_ = std::make_unique<TriangleSpace>(2 * edges / double(triangles_.size()), triangles_.size());
    for (uint32_t t = 0; t < triangles_.size(); ++t) space_->put(t, corners(t));
  }

  /// Whether one of the ways to open it was taken.
  bool open(const Wedge& w) {
    if (cosine_at_edge(point(at_[w.u]), point(at_[w.v]), point(at_[w.p]), point(at_[w.q])) <= kLeastCosine)
      return false;
    return turn(w.u, w.v, w.p, w.q) || turn(w.u, w.v, w.q, w.p);
  }

 private:
  static std::vector<char> patches_with_sides(const RegionWalls& walls, const CutSurface& cut) {
    std::vector<char> is_side(patch_count(cut), 0);
    const std::vector<uint8_t>& side = walls.regions.side;
    for (size_t t = 0; t < cut.fine->triangles.size() && !side.empty(); ++t)
      if (side[cut.fine->source_face[t]] != 0) is_side[cut.surface.patch[cut.corner[3 * t]]] = 1;
    return is_side;
  }

  /// Calls visit(cosine, p, q) for each two triangles at an edge, by their corners beside it.
  template <class Visit>
  void for_each_pair(uint32_t u, uint32_t v, View<const EdgeSide> on_edge, Visit visit) const {
    for (int64_t i = 0; i < on_edge.size; ++i)
      for (int64_t j = 0; j < i; ++j) {
        const uint32_t p = apex(on_edge[i]), q = apex(on_edge[j]);
        visit(cosine_at_edge(point(at_[u]), point(at_[v]), point(at_[p]), point(at_[q])), p, q);
      }
  }
  uint32_t apex(const EdgeSide& side) const { return triangles_[side.half_edge / 3][(side.half_edge + 2) % 3]; }
  CornersOfTriangle corners(uint32_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return {{a, b, c}, {at_[a], at_[b], at_[c]}};
  }

  /// Turns the triangle of a corner about the edge, away from another one.
  bool turn(uint32_t u, uint32_t v, uint32_t corner, uint32_t from) {
    if (stays_[corner]) return false;
    const WorldPoint origin = point(at_[u]), along = normalised(point(at_[v]) - origin);
    const auto across = [&](uint32_t w) {
      const WorldPoint way = point(at_[w]) - origin;
      return way - dot(way, along) * along;
    };
    const WorldPoint here = across(corner), other = normalised(across(from));
    WorldPoint up = here - dot(here, other) * other;
    if (length_sq(up) == 0) up = cross(along, other);
    const double height = length(here);
    const WorldPoint way = height * (kOpened[0] * other + kOpened[1] * normalised(up)) - here;
    if (length(way) > kFarthestOfEdge * length(point(at_[v]) - origin)) return false;
    return move(corner, nearest(point(at_[corner]) + way)) || move(corner, nearest(point(at_[corner]) + .5 * way));
  }

  struct Shape {
    double sine = 1;     ///< of the smallest angle of a triangle
    double cosine = -1;  ///< of the least angle between two
  };
  Shape shape_around(uint32_t v) const {
    Shape shape;
    for (const uint32_t t : around_.in(v)) {
      const auto& c = triangles_[t];
      shape.sine = std::min(shape.sine, smallest_sine(point(at_[c[0]]), point(at_[c[1]]), point(at_[c[2]])));
      for (size_t i = 0; i < 3; ++i) shape.cosine = std::max(shape.cosine, sharpest_at(c[i], c[(i + 1) % 3]));
    }
    return shape;
  }
  double sharpest_at(uint32_t u, uint32_t v) const {
    if (u > v) std::swap(u, v);
    double cosine = -1;
    const View<const EdgeSide> from = sides_.in(u);
    const EdgeSide* const begin = std::lower_bound(from.begin(), from.end(), EdgeSide{v, 0});
    const EdgeSide* const end = std::lower_bound(begin, from.end(), EdgeSide{v + 1, 0});
    for_each_pair(u, v, from.part(begin - from.begin(), end - begin),
                  [&](double of_pair, uint32_t, uint32_t) { cosine = std::max(cosine, of_pair); });
    return cosine;
  }

  bool move(uint32_t v, const PointQ8& to) {
    const PointQ8 from = at_[v];
    const View<const uint32_t> view = around_.in(v);
    const std::vector<uint32_t> around(view.begin(), view.end());
    const Shape before = shape_around(v);
    std::vector<WorldPoint> normals;
    for (const uint32_t t : around) normals.push_back(normal(t));
    at_[v] = to;
    const Shape after = shape_around(v);
    bool may = after.cosine < before.cosine && after.sine >= std::min(kPoorSine, before.sine);
    for (size_t i = 0; i < around.size(); ++i) may = may && dot(normals[i], normal(around[i])) > 0;
    std::vector<CornersOfTriangle> made;
    for (const uint32_t t : around) made.push_back(corners(t));
    if (!may || !(space_->are_free(made, around) || space_->meet_no_more(made, around))) {
      at_[v] = from;
      return false;
    }
    for (size_t i = 0; i < around.size(); ++i) {
      space_->take(around[i]);
      space_->put(around[i], made[i]);
    }
    return true;
  }
  WorldPoint normal(uint32_t t) const {
    const auto& [a, b, c] = triangles_[t];
    return doubled_area(point(at_[a]), point(at_[b]), point(at_[c]));
  }

  Buffer<PointQ8>& at_;
  std::vector<std::array<uint32_t, 3>> triangles_;
  EdgeSides sides_;
  Buckets<uint32_t> around_;  ///< triangles of each vertex
  std::vector<char> stays_;   ///< per vertex
  std::unique_ptr<TriangleSpace> space_;
};

}  // namespace

void open_wedges(const RegionWalls& walls, const CutSurface& cut, JoinedPatches& joined, Context& context) {
  run_with_threads(context, [&] {
    Wedges wedges(walls, cut, joined);
    std::vector<Wedge> found = wedges.find();
    if (found.empty()) return;
    wedges.keep_apart();
    for (int round = 0; round < kMostRounds && !found.empty(); ++round) {
      check_cancel(context, "features");
      bool has_opened = false;
      for (const Wedge& wedge : found) has_opened = wedges.open(wedge) || has_opened;
      if (!has_opened) return;
      found = wedges.find();
    }
  });
}

}  // namespace isoshell
