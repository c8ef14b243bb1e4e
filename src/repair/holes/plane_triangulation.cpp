// See plane_triangulation.h.
#include "repair/holes/plane_triangulation.h"

#include <algorithm>
#include <deque>

#include "voxel/exact_int.h"

namespace isoshell {
namespace {

constexpr uint32_t kNoTriangle = 0xffffffffu;

int next(int i) { return i == 2 ? 0 : i + 1; }
int before(int i) { return i == 0 ? 2 : i - 1; }

/// Edge i runs from corner i to the next one.
struct PlaneTriangle {
  std::array<uint32_t, 3> corner, across;
  std::array<bool, 3> is_line = {false, false, false};

  int find(uint32_t v) const { return corner[0] == v ? 0 : corner[1] == v ? 1 : 2; }
};

struct Edge {
  uint32_t triangle;
  int at;
};

/// Twice the area of abc, above 0 where they turn to the left.
Int128 turn(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c) {
  return Int128(b.x - a.x) * (c.y - a.y) - Int128(b.y - a.y) * (c.x - a.x);
}

/// Whether d is in the circle around abc, which turn to the left. Products have up to 163 bits: what one factor has
/// above 2^40 and below that is summed by itself.
bool is_in_circle(const PlanePoint& a, const PlanePoint& b, const PlanePoint& c, const PlanePoint& d) {
  constexpr int kBits = 40;
  Int128 high = 0, low = 0;
  const auto add = [&](const PlanePoint& p, const Int128& by) {
    const Int128 lifted = Int128(p.x - d.x) * (p.x - d.x) + Int128(p.y - d.y) * (p.y - d.y);
    high += (lifted >> kBits) * by;
    low += (lifted & ((Int128(1) << kBits) - 1)) * by;
  };
  add(a, turn(d, b, c)), add(b, turn(d, c, a)), add(c, turn(d, a, b));
  high += low >> kBits;
  return high > 0 || (high == 0 && (low & ((Int128(1) << kBits) - 1)) > 0);
}

class PlaneTriangulation {
 public:
  explicit PlaneTriangulation(const std::vector<PlanePoint>& points)
      : point_(points), count_(uint32_t(points.size())), triangle_of_(points.size() + 4, 0) {
    constexpr int64_t kLow = -1, kHigh = kLargestInPlane + 1;
    for (const PlanePoint& p :
         {PlanePoint{kLow, kLow}, PlanePoint{kHigh, kLow}, PlanePoint{kHigh, kHigh}, PlanePoint{kLow, kHigh}})
      point_.push_back(p);
    triangle_.push_back({{count_, count_ + 1, count_ + 2}, {kNoTriangle, kNoTriangle, 1}});
    triangle_.push_back({{count_, count_ + 2, count_ + 3}, {0, kNoTriangle, kNoTriangle}});
    for (const uint32_t t : {0u, 1u}) note(t);
  }

  /// False where another point is there.
  bool insert(uint32_t p) {
    const uint32_t t = locate(point_[p]);
    const PlaneTriangle old = triangle_[t];
    for (const uint32_t v : old.corner)
      if (point_[v].x == point_[p].x && point_[v].y == point_[p].y) return false;
    const auto [a, b, c] = old.corner;
    const uint32_t second = uint32_t(triangle_.size()), third = second + 1;
    triangle_[t] = {{a, b, p}, {old.across[0], second, third}};
    triangle_.push_back({{b, c, p}, {old.across[1], third, t}});
    triangle_.push_back({{c, a, p}, {old.across[2], t, second}});
    turn_back(old.across[1], t, second);
    turn_back(old.across[2], t, third);
    for (const uint32_t piece : {t, second, third}) note(piece);
    make_delaunay({t, second, third});
    last_ = t;
    return true;
  }

  /// False where it would cross another line, or passes a point.
  bool insert_line(uint32_t a, uint32_t b) {
    std::deque<std::array<uint32_t, 2>> crossed;
    if (!find_crossed(a, b, crossed)) return false;
    is_delaunay_ = is_delaunay_ && crossed.empty();
    size_t in_vain = 0;
    while (!crossed.empty()) {
      const auto [r, l] = crossed.front();
      crossed.pop_front();
      const Edge e = r < count_ ? find_edge(r, l) : find_edge(l, r);  // around the frame's corners is a border
      if (e.triangle == kNoTriangle || triangle_[e.triangle].is_line[size_t(e.at)]) return false;
      if (!is_convex(e)) {
        if (++in_vain > crossed.size() + 1) return false;
        crossed.push_back({r, l});
        continue;
      }
      in_vain = 0;
      const auto [c, d] = flip(e);
      if (c != a && c != b && d != a && d != b && side(a, b, c) * side(a, b, d) < 0) crossed.push_back({c, d});
    }
    return mark(a, b);
  }

  /// Where lines keep an edge from being flipped, it stays.
  void flip_rest() {
    for (bool is_changed = !is_delaunay_; is_changed;) {
      is_changed = false;
      for (uint32_t t = 0; t < triangle_.size(); ++t)
        for (int i = 0; i < 3; ++i) {
          const Edge e{t, i};
          if (triangle_[t].across[size_t(i)] == kNoTriangle || triangle_[t].is_line[size_t(i)] || !wants_flip(e) ||
              !is_convex(e))
            continue;
          flip(e);
          is_changed = true;
        }
    }
  }

  std::vector<std::array<uint32_t, 3>> inside() const {
    std::vector<uint8_t> is_outside(triangle_.size(), 0);
    std::vector<uint32_t> open;
    for (uint32_t t = 0; t < triangle_.size(); ++t)
      if (*std::max_element(triangle_[t].corner.begin(), triangle_[t].corner.end()) >= count_) open.push_back(t);
    for (const uint32_t t : open) is_outside[t] = 1;
    while (!open.empty()) {
      const PlaneTriangle& t = triangle_[open.back()];
      open.pop_back();
      for (size_t i = 0; i < 3; ++i) {
        if (t.is_line[i] || t.across[i] == kNoTriangle || is_outside[t.across[i]]) continue;
        is_outside[t.across[i]] = 1;
        open.push_back(t.across[i]);
      }
    }
    std::vector<std::array<uint32_t, 3>> found;
    for (uint32_t t = 0; t < triangle_.size(); ++t)
      if (!is_outside[t]) found.push_back(triangle_[t].corner);
    return found;
  }

 private:
  int side(uint32_t a, uint32_t b, uint32_t c) const {
    const Int128 t = turn(point_[a], point_[b], point_[c]);
    return t > 0 ? 1 : t < 0 ? -1 : 0;
  }

  /// Of a Delaunay triangulation, in which a walk ends.
  uint32_t locate(const PlanePoint& p) const {
    uint32_t t = last_;
    for (bool is_found = false; !is_found;) {
      is_found = true;
      for (int i = 0; i < 3 && is_found; ++i) {
        const PlaneTriangle& here = triangle_[t];
        if (turn(point_[here.corner[size_t(i)]], point_[here.corner[size_t(next(i))]], p) >= 0) continue;
        t = here.across[size_t(i)];
        is_found = false;
      }
    }
    return t;
  }

  void note(uint32_t t) {
    for (const uint32_t v : triangle_[t].corner) triangle_of_[v] = t;
  }
  void turn_back(uint32_t t, uint32_t from, uint32_t to) {
    if (t == kNoTriangle) return;
    for (uint32_t& across : triangle_[t].across)
      if (across == from) {
        across = to;
        return;
      }
  }
  Edge across(const Edge& e) const {
    const uint32_t t = triangle_[e.triangle].across[size_t(e.at)];
    return {t, triangle_[t].find(triangle_[e.triangle].corner[size_t(next(e.at))])};
  }

  /// The four corners around an edge: its ends, the apex here and the one across.
  struct Quad {
    uint32_t a, b, c, d;
  };
  Quad quad(const Edge& e) const {
    const PlaneTriangle& t = triangle_[e.triangle];
    const Edge o = across(e);
    return {t.corner[size_t(e.at)], t.corner[size_t(next(e.at))], t.corner[size_t(before(e.at))],
            triangle_[o.triangle].corner[size_t(before(o.at))]};
  }
  bool is_convex(const Edge& e) const {
    const Quad q = quad(e);
    return side(q.a, q.d, q.c) > 0 && side(q.d, q.b, q.c) > 0;
  }
  /// Whether the corner across lies in the circle around the triangle; one without area has it, too.
  bool wants_flip(const Edge& e) const {
    const Quad q = quad(e);
    if (side(q.a, q.b, q.c) == 0) return true;
    const PlanePoint &a = point_[q.a], &b = point_[q.b], &c = point_[q.c], &d = point_[q.d];
    return is_in_circle(a, b, c, d);
  }

  /// Result: the ends of the new edge. The apex of both triangles is then their last corner.
  std::array<uint32_t, 2> flip(const Edge& e) {
    const Quad q = quad(e);
    const Edge o = across(e);
    const PlaneTriangle t = triangle_[e.triangle], u = triangle_[o.triangle];
    const size_t bc = size_t(next(e.at)), ca = size_t(before(e.at)), ad = size_t(next(o.at)), db = size_t(before(o.at));
    triangle_[e.triangle] = {
        {q.a, q.d, q.c}, {u.across[ad], o.triangle, t.across[ca]}, {u.is_line[ad], false, t.is_line[ca]}};
    triangle_[o.triangle] = {
        {q.d, q.b, q.c}, {u.across[db], t.across[bc], e.triangle}, {u.is_line[db], t.is_line[bc], false}};
    turn_back(u.across[ad], o.triangle, e.triangle);
    turn_back(t.across[bc], e.triangle, o.triangle);
    note(e.triangle);
    note(o.triangle);
    return {q.c, q.d};
  }

  /// After an insertion: edges across from the new point, which is the last corner of these.
  void make_delaunay(std::vector<uint32_t> open) {
    while (!open.empty()) {
      const uint32_t t = open.back();
      open.pop_back();
      const uint32_t other = triangle_[t].across[0];
      if (other == kNoTriangle || !wants_flip({t, 0})) continue;
      flip({t, 0});
      open.push_back(t);
      open.push_back(other);
    }
  }

  /// Calls visit(triangle, corner) around a point, until it returns false.
  template <class Visit>
  void around(uint32_t v, Visit visit) const {
    const uint32_t first = triangle_of_[v];
    uint32_t t = first;
    do {
      const int i = triangle_[t].find(v);
      if (!visit(t, i)) return;
      t = triangle_[t].across[size_t(before(i))];
    } while (t != first && t != kNoTriangle);
  }

  Edge find_edge(uint32_t a, uint32_t b) const {
    Edge found{kNoTriangle, 0};
    around(a, [&](uint32_t t, int i) {
      if (triangle_[t].corner[size_t(next(i))] == b) found = {t, i};
      return found.triangle == kNoTriangle;
    });
    return found;
  }

  bool mark(uint32_t a, uint32_t b) {
    const Edge e = find_edge(a, b);
    if (e.triangle == kNoTriangle) return false;
    const Edge o = across(e);
    triangle_[e.triangle].is_line[size_t(e.at)] = triangle_[o.triangle].is_line[size_t(o.at)] = true;
    return true;
  }

  /// The edges between a and b, each with the end on the right first. False where a point is on the way.
  bool find_crossed(uint32_t a, uint32_t b, std::deque<std::array<uint32_t, 2>>& crossed) const {
    if (find_edge(a, b).triangle != kNoTriangle) return true;
    Edge e{kNoTriangle, 0};
    around(a, [&](uint32_t t, int i) {
      const uint32_t r = triangle_[t].corner[size_t(next(i))], l = triangle_[t].corner[size_t(before(i))];
      if (side(a, b, r) < 0 && side(a, b, l) > 0 && side(r, l, b) <= 0) e = {t, next(i)};
      return e.triangle == kNoTriangle;
    });
    while (e.triangle != kNoTriangle) {
      const Quad q = quad(e);
      crossed.push_back({q.a, q.b});
      if (q.d == b) return true;
      const int at = side(a, b, q.d);
      if (at == 0) return false;
      const Edge o = across(e);
      e = {o.triangle, at > 0 ? next(o.at) : before(o.at)};
      const PlaneTriangle& t = triangle_[e.triangle];
      if (side(a, b, t.corner[size_t(e.at)]) > 0) return false;
    }
    return false;
  }

  std::vector<PlanePoint> point_;
  uint32_t count_, last_ = 0;
  bool is_delaunay_ = true;  ///< no line has changed that
  std::vector<PlaneTriangle> triangle_;
  std::vector<uint32_t> triangle_of_;  ///< per point one of its triangles
};

}  // namespace

std::optional<std::vector<std::array<uint32_t, 3>>> triangulate_plane(
    const std::vector<PlanePoint>& points, const std::vector<std::array<uint32_t, 2>>& lines,
    const std::vector<std::array<uint32_t, 2>>& wishes) {
  PlaneTriangulation plane(points);
  for (uint32_t p = 0; p < points.size(); ++p)
    if (!plane.insert(p)) return {};
  for (const auto& [a, b] : lines)
    if (!plane.insert_line(a, b)) return {};
  for (const auto& [a, b] : wishes) plane.insert_line(a, b);
  plane.flip_rest();
  return plane.inside();
}

std::vector<std::array<uint32_t, 3>> left_of(const std::vector<std::array<uint32_t, 2>>& lines,
                                             const std::vector<std::array<uint32_t, 3>>& triangles) {
  struct Side {
    std::array<uint32_t, 2> end;
    size_t triangle;
    bool operator<(const Side& o) const { return end < o.end; }
  };
  std::vector<Side> sides;
  for (size_t t = 0; t < triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) sides.push_back({{triangles[t][i], triangles[t][(i + 1) % 3]}, t});
  std::sort(sides.begin(), sides.end());
  std::vector<char> is_left(triangles.size(), 0);
  std::vector<size_t> found;
  const auto reach = [&](std::array<uint32_t, 2> end) {
    const auto side = std::lower_bound(sides.begin(), sides.end(), Side{end, 0});
    if (side == sides.end() || side->end != end || is_left[side->triangle]) return;
    is_left[side->triangle] = 1;
    found.push_back(side->triangle);
  };
  for (const auto& line : lines) reach(line);
  std::vector<std::array<uint32_t, 2>> border = lines;
  std::sort(border.begin(), border.end());
  std::vector<std::array<uint32_t, 3>> out;
  for (size_t i = 0; i < found.size(); ++i) {
    const auto& t = triangles[found[i]];
    out.push_back(t);
    for (size_t k = 0; k < 3; ++k)
      if (!std::binary_search(border.begin(), border.end(), std::array{t[k], t[(k + 1) % 3]}))
        reach({t[(k + 1) % 3], t[k]});
  }
  return out;
}

}  // namespace isoshell
