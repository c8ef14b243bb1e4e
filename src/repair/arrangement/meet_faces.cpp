// See meet_faces.h. Whether an edge passes through a face is decided in integers; how far points and edges are from
// each other in doubles, which are right to a thousandth of a step.
#include "repair/arrangement/meet_faces.h"

#include <algorithm>
#include <cmath>

#include "geometry/segment.h"
#include "voxel/intersect.h"

namespace isoshell::repair {
namespace {

double square(double x) { return x * x; }
Vec128 normal_of(StepPoint a, StepPoint b, StepPoint c) { return cross(difference(b, a), difference(c, a)); }
Int128 product(const Vec128& a, const StepVector& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
StepPoint rounded(const WorldPoint& p) {
  return {int64_t(std::floor(p.x + .5)), int64_t(std::floor(p.y + .5)), int64_t(std::floor(p.z + .5))};
}

HeightPlane plane_through(const WorldPoint& p, const WorldPoint& normal) {
  const double size = length(normal);
  if (!(size > 0)) return {};
  const WorldPoint unit = (1 / size) * normal;
  return {unit, dot(unit, p)};
}

/// Whether planes tell that two faces are farther than `reach` from each other, but at corners that they share.
class Separation {
 public:
  Separation(const FacePlanes& s, const FacePlanes& t, const LatticeFaces& faces)
      : face_{&s, &t}, reach_(faces.reach_steps), weld_(faces.weld_steps()) {}

  bool is_known() {
    if (is_beside(0) || is_beside(1)) return true;  // most are, and share nothing
    find_shared();
    if (shared_ > 0 && (shared_ == 3 || is_beside_but_shared(0) || is_beside_but_shared(1))) return true;
    return are_apart_along_common_line() || is_beyond_edge(0) || is_beyond_edge(1);
  }

 private:
  static constexpr size_t kNotShared = 3;
  static constexpr double kNearlyParallel = 1e-12;  // ranges along the line say nothing then

  void find_shared() {
    for (size_t i = 0; i < 3; ++i)
      for (size_t j = 0; j < 3; ++j)
        if (face_[0]->corner[i] == face_[1]->corner[j]) same_[0][i] = j, same_[1][j] = i, ++shared_;
  }

  /// Whether the corners of k are on one side of the other's plane and out of reach.
  bool is_beside(size_t k) {
    auto& [a, b, c] = height_[k];
    const HeightPlane& plane = face_[1 - k]->plane;
    const auto& at = face_[k]->at;
    a = plane.height(at[0]), b = plane.height(at[1]), c = plane.height(at[2]);
    return ((a > reach_ && b > reach_ && c > reach_) || (a < -reach_ && b < -reach_ && c < -reach_)) && !lies_on(k);
  }
  /// Whether each corner of k is made one with some corner of the other: then the faces are, though they are farther
  /// apart than what else is made one. Otherwise others at their corners would do so to some of these corners alone.
  bool lies_on(size_t k) const {
    for (const double height : height_[k])
      if (std::abs(height) > weld_) return false;
    const auto is_near_corner = [&](const WorldPoint& p) {
      const auto& to = face_[1 - k]->at;
      return std::any_of(to.begin(), to.end(), [&](const auto& q) { return distance_sq(p, q) <= weld_ * weld_; });
    };
    const auto& at = face_[k]->at;
    return std::all_of(at.begin(), at.end(), is_near_corner);
  }
  /// The same of those that are not shared.
  bool is_beside_but_shared(size_t k) const {
    bool is_above = true, is_below = true;
    for (size_t i = 0; i < 3; ++i) {
      if (same_[k][i] != kNotShared) continue;
      is_above = is_above && height_[k][i] > reach_;
      is_below = is_below && height_[k][i] < -reach_;
    }
    return (is_above || is_below) && !lies_on(k);
  }

  /// Points that are near each other are near both planes: whether those of one face are apart from those of the other
  /// along the line that the planes have in common. Where a corner is shared, the sides across from it are looked at.
  bool are_apart_along_common_line() const {
    if (shared_ > 1) return false;
    const WorldPoint line = cross(face_[0]->plane.normal, face_[1]->plane.normal);
    if (length_sq(line) < kNearlyParallel) return false;
    const double by = weld_ * length(line);
    const Range s = near_other(0, line), t = near_other(1, line);
    if (shared_ == 0) return s.is_apart(t, by);
    return side_near_other(0, line).is_apart(t, by) && side_near_other(1, line).is_apart(s, by);
  }
  Range near_other(size_t k, const WorldPoint& line) const {
    Range range;
    for (size_t i = 0; i < 3; ++i) add_near(k, i, line, range);
    return range;
  }
  Range side_near_other(size_t k, const WorldPoint& line) const {
    Range range;
    for (size_t i = 0; i < 3; ++i)
      if (same_[k][i] == kNotShared && same_[k][(i + 1) % 3] == kNotShared) add_near(k, i, line, range);
    return range;
  }
  /// Of edge i of k.
  void add_near(size_t k, size_t i, const WorldPoint& line, Range& range) const {
    const size_t j = (i + 1) % 3;
    const double h = height_[k][i], g = height_[k][j], x = dot(line, face_[k]->at[i]), y = dot(line, face_[k]->at[j]);
    if (std::abs(h) <= weld_) range.add(x);
    if (std::abs(g) <= weld_) range.add(y);
    for (const double level : {-weld_, weld_})
      if ((h < level) != (g < level)) range.add(x + (level - h) / (g - h) * (y - x));
  }

  /// Whether the corners of k are beyond an edge of the other and out of reach, or its ends.
  bool is_beyond_edge(size_t k) const {
    for (size_t e = 0; e < 3; ++e) {
      const auto is_beyond = [&](size_t i) {
        return same_[k][i] == e || same_[k][i] == (e + 1) % 3 ||
               face_[1 - k]->across_edge[e].height(face_[k]->at[i]) > reach_;
      };
      if (is_beyond(0) && is_beyond(1) && is_beyond(2)) return true;
    }
    return false;
  }

  std::array<const FacePlanes*, 2> face_;
  double reach_, weld_;
  std::array<std::array<size_t, 3>, 2> same_ = {{{3, 3, 3}, {3, 3, 3}}};  ///< the other's corner that this one is
  std::array<std::array<double, 3>, 2> height_;                           ///< of corners above the other's plane
  int shared_ = 0;
};

/// Where a corner lies on a face.
enum Place : int { kEdge0, kEdge1, kEdge2, kInside, kApart, kShared };

enum class Meeting { apart, at_end, inside };

class FacePair {
 public:
  FacePair(const LatticeFaces& faces, const FacePlanes& f, const FacePlanes& g, Contacts& to)
      : faces_(faces),
        to_(to),
        reach_sq_(square(faces.reach_steps)),
        weld_sq_(square(faces.weld_steps())),
        number_{f.number, g.number},
        corner_{f.corner, g.corner},
        plane_{f.plane, g.plane} {
    for (size_t s = 0; s < 2; ++s) normal_[s] = normal_of(at(corner_[s][0]), at(corner_[s][1]), at(corner_[s][2]));
  }

  void meet() {
    if (faces_.leaves_near && !triangles_intersect(corners_of(0), corners_of(1))) return;
    if (find_close_corners()) return;
    const size_t before = to_.found.size();
    for (size_t s = 0; s < 2; ++s)
      for (size_t i = 0; i < 3; ++i) place_[s][i] = place_of(s, i);
    add_corners();
    add_edges();
    for (size_t s = 0; s < 2; ++s)
      for (size_t i = 0; i < 3; ++i) add_pass(s, i);
    if (to_.found.size() > before || !triangles_intersect_apart(corners_of(0), corners_of(1))) return;
    to_.crossing.push_back(number_);
    // The edges of a low face are near each other, and none is where it is met: it has to vanish.
    if (faces_.leaves_near)
      for (const uint32_t f : number_) meet_itself(faces_, f, to_);
  }

 private:
  StepPoint at(uint32_t v) const { return faces_.point[v]; }

  CornersAt<StepPoint> corners_of(size_t s) const {
    const auto& [a, b, c] = corner_[s];
    return {{a, b, c}, {at(a), at(b), at(c)}};
  }

  bool find_close_corners() {
    bool is_found = false;
    for (const uint32_t u : corner_[0])
      for (const uint32_t v : corner_[1]) {
        if (u == v || distance_sq(as_world(at(u)), as_world(at(v))) > weld_sq_) continue;
        to_.close.push_back(ends_of(u, v));
        is_found = true;
      }
    if (is_found) to_.near_close.insert(to_.near_close.end(), number_.begin(), number_.end());
    return is_found;
  }

  bool is_on(uint32_t v, const Ends& e) const {
    return segment_distance_sq(as_world(at(v)), as_world(at(e[0])), as_world(at(e[1]))) <= reach_sq_;
  }

  /// Of a corner of s on the other face.
  int place_of(size_t s, size_t i) const {
    const uint32_t v = corner_[s][i];
    const Corners& other = corner_[1 - s];
    if (has_corner(other, v)) return kShared;
    if (std::abs(plane_[1 - s].height(as_world(at(v)))) > faces_.reach_steps) return kApart;
    const WorldPoint p = as_world(at(v)), n = as_world(normal_[1 - s]);
    int nearest = kApart;
    double nearest_sq = reach_sq_;
    bool is_inside = true;
    for (size_t k = 0; k < 3; ++k) {
      // In the order of the ends, so that all faces at the edge say the same.
      const Ends e = edge_of(other, k);
      const WorldPoint a = as_world(at(e[0])), b = as_world(at(e[1]));
      const double sq = segment_distance_sq(p, a, b);
      if (sq <= nearest_sq) nearest = int(k), nearest_sq = sq;
      const double turn = dot(cross(b - a, p - a), n);
      is_inside = is_inside && (e[0] == other[k] ? turn > 0 : turn < 0);
    }
    return nearest != kApart ? nearest : is_inside ? kInside : kApart;
  }

  void add(Contact c) {
    c.pair = number_;
    to_.found.push_back(c);
  }

  void add_corners() {
    for (size_t s = 0; s < 2; ++s)
      for (size_t i = 0; i < 3; ++i) {
        const int place = place_[s][i];
        if (place > kInside) continue;
        Contact c;
        c.point = corner_[s][i];
        if (place == kInside)
          c.face = number_[1 - s];
        else
          c.edge[0] = edge_of(corner_[1 - s], size_t(place));
        add(c);
      }
  }

  /// Whether two edges without a common end meet, and where; `at_end` when an end of one is on the other.
  Meeting meeting_of(const Ends& d, const Ends& e, StepPoint& where) const {
    const StepVector u = difference(at(d[1]), at(d[0])), w = difference(at(e[1]), at(e[0])),
                     r = difference(at(e[0]), at(d[0]));
    const WorldPoint n = as_world(cross(u, w));
    const double sq = length_sq(n);
    if (sq > 0 && std::abs(dot(n, as_world(r))) > faces_.reach_steps * std::sqrt(sq)) return Meeting::apart;
    if (is_on(d[0], e) || is_on(d[1], e) || is_on(e[0], d) || is_on(e[1], d)) return Meeting::at_end;
    if (!(sq > 0)) return Meeting::apart;
    const double along_d = dot(as_world(cross(r, w)), n) / sq, along_e = dot(as_world(cross(r, u)), n) / sq;
    if (!(along_d > 0 && along_d < 1 && along_e > 0 && along_e < 1)) return Meeting::apart;
    const WorldPoint p = as_world(at(d[0])) + along_d * as_world(u), q = as_world(at(e[0])) + along_e * as_world(w);
    where = rounded(.5 * (p + q));
    return Meeting::inside;
  }

  void add_edges() {
    const bool do_meet =
        faces_.leaves_near || !faces_.leaves_near_edges || triangles_intersect(corners_of(0), corners_of(1));
    for (size_t i = 0; i < 3; ++i)
      for (size_t k = 0; k < 3; ++k) {
        Ends d = edge_of(corner_[0], i), e = edge_of(corner_[1], k);
        if (d[0] == e[0] || d[0] == e[1] || d[1] == e[0] || d[1] == e[1]) continue;
        if (e < d) std::swap(d, e);
        Contact c;
        const Meeting meeting = meeting_of(d, e, c.at);
        if (meeting == Meeting::apart) continue;
        if (meeting == Meeting::inside && faces_.leaves_near_edges && !do_meet) continue;
        is_met_[0][i] = is_met_[1][k] = true;
        if (meeting == Meeting::at_end) continue;
        c.edge = {d, e};
        add(c);
      }
  }

  /// Of an edge of s through the inside of the other, far from its edges.
  void add_pass(size_t s, size_t i) {
    if (is_met_[s][i] || place_[s][i] != kApart || place_[s][(i + 1) % 3] != kApart) return;
    const Corners& other = corner_[1 - s];
    const Ends d = edge_of(corner_[s], i);
    const Vec128& n = normal_[1 - s];
    const StepPoint a = at(other[0]), b = at(other[1]), c = at(other[2]), p = at(d[0]), q = at(d[1]);
    const Int128 from = product(n, difference(p, a)), to = product(n, difference(q, a));
    if (from == to || (from > 0 && to > 0) || (from < 0 && to < 0)) return;
    const int first = side_of_plane(p, q, a, b), second = side_of_plane(p, q, b, c), third = side_of_plane(p, q, c, a);
    if (first == 0 || first != second || second != third) return;
    const double along = double(from) / double(from - to);
    Contact pass;
    pass.edge[0] = d;
    pass.face = number_[1 - s];
    pass.at = rounded(as_world(p) + along * as_world(difference(q, p)));
    add(pass);
  }

  const LatticeFaces& faces_;
  Contacts& to_;
  double reach_sq_, weld_sq_;
  std::array<uint32_t, 2> number_;
  std::array<Corners, 2> corner_;
  std::array<HeightPlane, 2> plane_;
  std::array<Vec128, 2> normal_;
  std::array<std::array<int, 3>, 2> place_{};
  std::array<std::array<bool, 3>, 2> is_met_{};
};

}  // namespace

bool has_area(const LatticeFaces& faces, uint32_t f) {
  const Corners& c = faces.face[f];
  const Vec128 n = normal_of(faces.point[c[0]], faces.point[c[1]], faces.point[c[2]]);
  return n.x != 0 || n.y != 0 || n.z != 0;
}

FacePlanes planes_of(const LatticeFaces& faces, uint32_t f) {
  FacePlanes planes;
  planes.number = f;
  planes.corner = faces.face[f];
  const auto at = [&](size_t i) { return faces.point[planes.corner[i % 3]]; };
  planes.plane = plane_through(as_world(at(0)), as_world(normal_of(at(0), at(1), at(2))));
  for (size_t i = 0; i < 3; ++i) {
    planes.at[i] = as_world(at(i));
    planes.across_edge[i] = plane_through(planes.at[i], cross(as_world(at(i + 1)) - planes.at[i], planes.plane.normal));
  }
  return planes;
}

void meet_faces(const LatticeFaces& faces, const FacePlanes& f, const FacePlanes& g, Contacts& to) {
  ++to.pairs;
  if (Separation(f, g, faces).is_known()) return;
  if (f.number < g.number)
    FacePair(faces, f, g, to).meet();
  else
    FacePair(faces, g, f, to).meet();
}

bool meet_itself(const LatticeFaces& faces, uint32_t f, Contacts& to) {
  const Corners& corner = faces.face[f];
  size_t longest = 0;
  double longest_sq = -1;
  bool is_short = false;
  for (size_t i = 0; i < 3; ++i) {
    const Ends e = edge_of(corner, i);
    const double sq = distance_sq(as_world(faces.point[e[0]]), as_world(faces.point[e[1]]));
    if (sq <= square(faces.weld_steps())) {
      to.close.push_back(e);
      to.near_close.push_back(f);
      is_short = true;
    }
    if (sq > longest_sq) longest = i, longest_sq = sq;
  }
  if (is_short) return true;
  const Ends e = edge_of(corner, longest);
  const uint32_t apex = corner[(longest + 2) % 3];
  if (segment_distance_sq(as_world(faces.point[apex]), as_world(faces.point[e[0]]), as_world(faces.point[e[1]])) >
      square(faces.reach_steps))
    return false;
  Contact c;
  c.pair = {f, f};
  c.edge[0] = e;
  c.point = apex;
  to.found.push_back(c);
  return true;
}

}  // namespace isoshell::repair
