// See dissolve_cuts.h.
#include "repair/arrangement/dissolve_cuts.h"

#include <algorithm>
#include <cmath>

#include "core/buckets.h"
#include "core/index_sets.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "repair/arrangement/find_contacts.h"
#include "repair/arrangement/step_frame.h"
#include "repair/holes/plane_triangulation.h"

namespace isoshell::repair {
namespace {

constexpr double kMostOffSteps = 16 * kFine;  // what bends leave of a straight line, or a plane, from cut to cut
constexpr double kRoundedSteps = 2 * kFine;   // what is left of a plane when its corners are numbers of 32 bits
constexpr double kNearlyOne = .999;           // of the cosine between normals, before planes are compared

/// An edge of a piece whose neighbour there is of another triangle; the piece is to the left of it.
struct BorderEdge {
  uint32_t from, to;

  bool operator<(const BorderEdge& o) const { return from != o.from ? from < o.from : to < o.to; }
};

class Dissolver {
 public:
  Dissolver(PiecedFaces& faces, const std::vector<uint8_t>& is_kept, const WorldBox& box, const Context& context)
      : faces_(faces), source_(faces.source), stays_(is_kept), context_(context) {
    const StepFrame frame(box);
    for (const WorldPoint& p : faces.point) step_.push_back(frame.from(p));
  }

  /// From here on sources are planes: the smallest triangle of each.
  void join_planes(const std::vector<uint32_t>& kind) {
    find_pieces(kind.size());
    IndexSets planes(int64_t(kind.size()));
    for_each_edge(find_edge_sides(faces_.face, faces_.point.size()),
                  [&](uint32_t, uint32_t, View<const EdgeSide> sides) {
                    if (sides.size != 2) return;
                    const uint32_t s = source_[sides[0].half_edge / 3], t = source_[sides[1].half_edge / 3];
                    if (kind[s] != kind[t] || planes.root(s) == planes.root(t) || !are_in_one_plane(s, t)) return;
                    planes.unite(s, t);
                  });
    for (uint32_t& s : source_) s = planes.root(s);
    find_pieces(kind.size());
    std::vector<uint8_t> is_plane;  // else one was added to the next, as on a surface that bends little
    for (uint32_t s = 0; s < kind.size(); ++s) is_plane.push_back(is_flat(s));
    for (size_t f = 0; f < source_.size(); ++f)
      if (!is_plane[source_[f]]) source_[f] = faces_.source[f];
    find_pieces(kind.size());
  }

  void run() {
    find_borders();
    for (uint32_t s = 0; s < is_left_.size(); ++s)
      if (!has_piece(s) || !is_flat(s)) leave(s);
    keep_ends();
    keep_bent_borders();
    do triangulate_all();
    while (leave_crossing());
    take();
  }

 private:
  /// Its pieces stay as they are.
  void leave(uint32_t source) {
    is_left_[source] = 1;
    for (const uint32_t f : pieces_.in(source))
      for (const uint32_t v : faces_.face[f]) stays_[v] = 1;
  }

  void find_pieces(size_t sources) {
    normal_.assign(sources, WorldPoint{0, 0, 0});
    for (size_t f = 0; f < faces_.face.size(); ++f) {
      const auto& [a, b, c] = faces_.face[f];
      WorldPoint& normal = normal_[source_[f]];
      normal = normal + doubled_area(as_world(step_[a]), as_world(step_[b]), as_world(step_[c]));
    }
    for (WorldPoint& n : normal_) n = normalised(n);
    pieces_ = sort_into_buckets<uint32_t>(int64_t(sources), int64_t(faces_.face.size()),
                                          [&](int64_t f, auto put) { put(source_[size_t(f)], uint32_t(f)); });
    is_left_.assign(sources, 0);
  }
  bool has_piece(uint32_t source) const {
    const View<const uint32_t> all = pieces_.in(source);
    return std::any_of(all.begin(), all.end(), [&](uint32_t f) { return faces_.is_piece[f] != 0; });
  }

  /// How far the pieces of a source reach along a direction.
  Range reach_along(const WorldPoint& direction, uint32_t source) const {
    Range range;
    for (const uint32_t f : pieces_.in(source))
      for (const uint32_t v : faces_.face[f]) range.add(dot(direction, as_world(step_[v])));
    return range;
  }
  bool is_flat(uint32_t source) const { return reach_along(normal_[source], source).length() <= 2 * kMostOffSteps; }
  /// Whether all pieces of both are, along the normal of either, as near as rounding leaves them.
  bool are_in_one_plane(uint32_t s, uint32_t t) const {
    const WorldPoint &m = normal_[s], &n = normal_[t];
    if (dot(m, n) < kNearlyOne) return false;
    const auto is_thin = [&](const WorldPoint& normal) {
      Range range = reach_along(normal, s);
      const Range other = reach_along(normal, t);
      range.add(other.least), range.add(other.most);
      return range.length() <= kRoundedSteps;
    };
    return is_thin(m) || is_thin(n);
  }

  void find_borders() {
    std::vector<std::pair<uint32_t, BorderEdge>> found;
    borders_at_.assign(faces_.point.size(), 0);
    for_each_edge(find_edge_sides(faces_.face, faces_.point.size()),
                  [&](uint32_t u, uint32_t v, View<const EdgeSide> sides) {
                    const auto source = [&](int64_t i) { return source_[sides[i].half_edge / 3]; };
                    if (sides.size == 2 && source(0) == source(1)) return;
                    ++borders_at_[u];
                    ++borders_at_[v];
                    if (sides.size != 2) stays_[u] = stays_[v] = 1;
                    for (int64_t i = 0; i < sides.size; ++i) {
                      const uint32_t h = sides[i].half_edge;
                      const bool rises = faces_.face[h / 3][h % 3] == u;
                      found.push_back({source(i), rises ? BorderEdge{u, v} : BorderEdge{v, u}});
                    }
                  });
    borders_ = sort_into_buckets<BorderEdge>(pieces_.count(), int64_t(found.size()), [&](int64_t i, auto put) {
      put(found[size_t(i)].first, found[size_t(i)].second);
    });
  }

  /// Points where borders of more than two triangles meet, or end.
  void keep_ends() {
    const Buckets<uint32_t> sources = sort_into_buckets<uint32_t>(
        int64_t(faces_.point.size()), int64_t(faces_.face.size()), [&](int64_t f, auto put) {
          for (const uint32_t v : faces_.face[size_t(f)]) put(v, source_[size_t(f)]);
        });
    for (uint32_t v = 0; v < stays_.size(); ++v) {
      const View<const uint32_t> at = sources.in(v);
      int64_t count = std::min<int64_t>(at.size, 1);
      for (int64_t i = 1; i < at.size; ++i) count += at[i] != at[i - 1];
      if (count > 2 || (borders_at_[v] != 0 && borders_at_[v] != 2)) stays_[v] = 1;
    }
  }

  /// The edge of a triangle's border that goes on from a point which stays not.
  const BorderEdge* next_of(uint32_t source, uint32_t from) const {
    const View<const BorderEdge> all = borders_.in(source);
    const BorderEdge* at = std::lower_bound(all.begin(), all.end(), BorderEdge{from, 0});
    return at != all.end() && at->from == from ? at : nullptr;
  }
  /// The points between one that stays and the next along a border, and that last.
  std::vector<uint32_t> way_of(uint32_t source, const BorderEdge& first) const {
    std::vector<uint32_t> way{first.to};
    while (!stays_[way.back()]) {
      const BorderEdge* next = next_of(source, way.back());
      if (!next || way.size() > size_t(borders_.in(source).size)) break;
      way.push_back(next->to);
    }
    return way;
  }

  /// Points that are off the straight line between those that stay, and those of borders on which none does.
  void keep_bent_borders() {
    std::vector<uint8_t> is_between(stays_.size(), 0);
    std::vector<uint32_t> bent;
    for (uint32_t s = 0; s < is_left_.size(); ++s)
      for (const BorderEdge& e : borders_.in(s)) {
        if (!stays_[e.from]) continue;
        const std::vector<uint32_t> way = way_of(s, e);
        const WorldPoint from = as_world(step_[e.from]), along = normalised(as_world(step_[way.back()]) - from);
        const bool is_straight = std::all_of(way.begin(), way.end(), [&](uint32_t v) {
          return length(cross(along, as_world(step_[v]) - from)) <= kMostOffSteps;
        });
        for (size_t i = 0; i + 1 < way.size(); ++i) is_between[way[i]] = 1;
        if (!is_straight || way.back() == e.from) bent.insert(bent.end(), way.begin(), way.end());
      }
    for (const uint32_t v : bent) stays_[v] = 1;
    for (size_t v = 0; v < stays_.size(); ++v) stays_[v] |= uint8_t(borders_at_[v] != 0 && !is_between[v]);
  }

  /// What has no triangulation stays as it is; then the others have other borders.
  void triangulate_all() {
    for (bool is_done = false; !is_done;) {
      is_done = true;
      made_.clear();
      made_source_.clear();
      for (uint32_t s = 0; s < is_left_.size(); ++s) {
        if (is_left_[s] || pieces_.in(s).size == 0 || triangulate(s)) continue;
        leave(s);
        is_done = false;
      }
    }
  }

  /// Where new triangles, which are up to some steps off the pieces, pass through others, the pieces stay. Result:
  /// whether any do.
  bool leave_crossing() {
    LatticeFaces all;
    for (size_t f = 0; f < faces_.face.size(); ++f)
      if (is_left_[source_[f]]) all.face.push_back(faces_.face[f]);
    const size_t left = all.face.size();
    all.is_unsettled.assign(left, 0);
    all.face.insert(all.face.end(), made_.begin(), made_.end());
    all.is_unsettled.resize(all.face.size(), 1);
    all.point = step_;
    unsettle_crossing(all, context_);
    bool is_any = false;
    for (size_t i = 0; i < made_.size(); ++i) {
      if (!all.is_unsettled[left + i] || is_left_[made_source_[i]]) continue;
      leave(made_source_[i]);
      is_any = true;
    }
    return is_any;
  }

  bool triangulate(uint32_t source) {
    const WorldPoint& normal = normal_[source];
    std::vector<uint32_t> used;
    for (const uint32_t f : pieces_.in(source))
      for (const uint32_t v : faces_.face[f])
        if (stays_[v]) used.push_back(v);
    std::sort(used.begin(), used.end());
    used.erase(std::unique(used.begin(), used.end()), used.end());
    const auto place_of = [&](uint32_t v) {
      return uint32_t(std::lower_bound(used.begin(), used.end(), v) - used.begin());
    };
    std::vector<PlanePoint> plane;
    for (const uint32_t v : used) plane.push_back(seen(step_[v], normal));
    std::vector<std::array<uint32_t, 2>> lines;
    for (const BorderEdge& e : borders_.in(source)) {
      if (!stays_[e.from]) continue;
      const uint32_t end = way_of(source, e).back();
      if (!stays_[end] || end == e.from) return false;
      lines.push_back({place_of(e.from), place_of(end)});
    }
    const auto triangles = triangulate_plane(plane, lines);
    if (!triangles) return false;
    const auto inside = left_of(lines, *triangles);
    if (!covers(inside, plane, source, normal)) return false;
    for (const auto& [a, b, c] : inside) {
      made_.push_back({used[a], used[b], used[c]});
      made_source_.push_back(source);
    }
    return true;
  }

  /// Along the longest component of the normal, so that what turns to the left there faces along it.
  static PlanePoint seen(const StepPoint& p, const WorldPoint& normal) {
    const double x = std::abs(normal.x), y = std::abs(normal.y), z = std::abs(normal.z);
    const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
    PlanePoint s = axis == 0 ? PlanePoint{p.y, p.z} : axis == 1 ? PlanePoint{p.z, p.x} : PlanePoint{p.x, p.y};
    if ((axis == 0 ? normal.x : axis == 1 ? normal.y : normal.z) < 0) std::swap(s.x, s.y);
    return s;
  }

  /// The area of the pieces, but for what straight lines give and take, and all points.
  bool covers(const std::vector<std::array<uint32_t, 3>>& made, const std::vector<PlanePoint>& plane, uint32_t source,
              const WorldPoint& normal) const {
    const auto doubled = [](PlanePoint a, PlanePoint b, PlanePoint c) {
      return double(b.x - a.x) * double(c.y - a.y) - double(b.y - a.y) * double(c.x - a.x);
    };
    double before = 0, after = 0, around = 0;
    for (const uint32_t f : pieces_.in(source)) {
      const auto& [a, b, c] = faces_.face[f];
      before += doubled(seen(step_[a], normal), seen(step_[b], normal), seen(step_[c], normal));
    }
    for (const BorderEdge& e : borders_.in(source)) around += length(as_world(step_[e.to]) - as_world(step_[e.from]));
    std::vector<uint8_t> is_used(plane.size(), 0);
    for (const auto& [a, b, c] : made) {
      after += doubled(plane[a], plane[b], plane[c]);
      is_used[a] = is_used[b] = is_used[c] = 1;
    }
    return std::abs(after - before) <= 2 * kMostOffSteps * around &&
           std::all_of(is_used.begin(), is_used.end(), [](uint8_t is) { return is != 0; });
  }

  void take() {
    PiecedFaces out;
    for (size_t f = 0; f < faces_.face.size(); ++f) {
      if (!is_left_[source_[f]]) continue;
      out.face.push_back(faces_.face[f]);
      out.source.push_back(faces_.source[f]);
    }
    out.face.insert(out.face.end(), made_.begin(), made_.end());
    out.source.insert(out.source.end(), made_source_.begin(), made_source_.end());
    out.point = std::move(faces_.point);
    faces_ = std::move(out);
  }

  PiecedFaces& faces_;
  std::vector<uint32_t> source_;  ///< per face
  std::vector<uint8_t> stays_;    ///< per point
  std::vector<StepPoint> step_;
  Buckets<uint32_t> pieces_;          ///< per source its faces
  std::vector<WorldPoint> normal_;    ///< per source, of length 1
  std::vector<uint8_t> is_left_;      ///< per source: its pieces stay
  Buckets<BorderEdge> borders_;       ///< per source
  std::vector<uint32_t> borders_at_;  ///< per point the edges
  std::vector<std::array<uint32_t, 3>> made_;
  std::vector<uint32_t> made_source_;
  const Context& context_;
};

}  // namespace

void dissolve_cuts(PiecedFaces& faces, const std::vector<uint32_t>& kind, const std::vector<uint8_t>& is_kept,
                   const WorldBox& box, const Context& context) {
  Dissolver dissolver(faces, is_kept, box, context);
  dissolver.join_planes(kind);
  dissolver.run();
}

}  // namespace isoshell::repair
