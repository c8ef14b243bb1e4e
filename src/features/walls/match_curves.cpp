// with_matched_curves (see periodic_mesh.h).
#include <algorithm>
#include <cmath>
#include <optional>

#include "features/walls/periodic_mesh.h"

namespace isoshell {
namespace {

using Kind = RegionVertex::Kind;

constexpr int kMostRounds = 4;  ///< in which vertices that one side could not lose are given to the other one

constexpr double kOffPlane = .125;  ///< of an edge: how far a vertex gets that leaves a plane

class CurveMatcher : public PeriodicMesh {
 public:
  explicit CurveMatcher(PeriodicMesh mesh) : PeriodicMesh(std::move(mesh)) {}

  void match() {
    for (uint32_t t = 0; t < triangles().size(); ++t)
      if (!triangles()[t].is_gone() && sides().is_high(triangles()[t].patch)) remove(t);
    move_to_planes();
    bool has_changed = true;
    for (int round = 0; round < kMostRounds && has_changed; ++round) {
      has_changed = false;
      for (int axis = 0; axis < 3; ++axis)
        if (sides().has(2 * axis + 1)) has_changed = match_curves(axis) || has_changed;
    }
    leave_planes();
  }

 private:
  /// Optimised vertices may be a step of the lattice off their plane, or beyond one.
  void move_to_planes() {
    for (uint32_t v = 0; v < vertices().size(); ++v) {
      if (!is_used(v) || vertex(v).kind == Kind::corner) continue;
      RegionVertex to = vertex(v);
      to.position = sides().within(at(v));
      for_each_around(v, [&](uint32_t t) {
        if (const int side = sides().of_patch(triangles()[t].patch)) to.position = sides().on_plane(side, to.position);
      });
      if (!(to.position == at(v))) move(v, to, change_, [] { return true; });
    }
  }

  /// Beside what is no region walls may have triangles that lie in a side, which would be there on one of two sides.
  void leave_planes() {
    for (uint32_t t = 0; t < triangles().size(); ++t) {
      for (size_t edge = 0; edge < 3 && lies_in_plane(triangles()[t]); ++edge)
        flip(t, edge, change_, [] { return true; });
      for (size_t edge = 0; edge < 3 && lies_in_plane(triangles()[t]); ++edge) split_off_plane(t, edge);
    }
  }
  void split_off_plane(uint32_t t, size_t edge) {
    const RegionTriangle of = triangles()[t];
    const uint32_t u = of.corner[edge], v = of.corner[(edge + 1) % 3];
    const uint32_t home = lookup_.copy_in(vertex(u).home, of.patch);
    if (of.curve[edge] != kNone || home == kNone || at(u) == at(v)) return;
    RegionVertex middle = vertex(u);
    middle.kind = Kind::free;
    middle.position = sides().inside(.5 * (at(u) + at(v)), kOffPlane * length(at(v) - at(u)));
    middle.home = lookup_.nearest_from(home, middle.position);
    split(u, v, middle, change_, [] { return true; });
  }
  bool lies_in_plane(const RegionTriangle& t) const {
    if (t.is_gone() || sides().of_patch(t.patch) > 0) return false;
    return sides().hold({at(t.corner[0]), at(t.corner[1]), at(t.corner[2])});
  }

  /// Whether anything was changed.
  bool match_curves(int axis) {
    list_vertices();
    const WorldPoint period = sides().period_q8(axis);
    std::vector<std::vector<OnCurve>> wanted(cut_.curves.size());
    bool has_changed = false;
    for (uint32_t v = 0, count = uint32_t(vertices().size()); v < count; ++v) {
      if (!is_used(v) || vertex(v).kind == Kind::free || !is_on_side(v, 2 * axis + 1)) continue;
      const std::optional<PlaceOnCurve> there = places(2 * axis + 2).nearest(at(v) + period);
      if (!there) continue;
      if (is_end(there->curve, there->at)) {
        const uint32_t corner = corner_at(cut_.curves[there->curve].place[there->at]);
        has_changed = match_pair(v, corner, *there, period) || has_changed;
      } else {
        wanted[there->curve].push_back({there->at, v, at(v) + period});
      }
    }
    for (uint32_t c = 0; c < wanted.size(); ++c) {
      if (!is_beside(c, 2 * axis + 2) || !is_alive(c)) continue;
      std::sort(wanted[c].begin(), wanted[c].end());
      has_changed = match_curve(c, wanted[c], period, 2 * axis + 1) || has_changed;
    }
    return has_changed;
  }

  /// Brings a vertex to where the one opposite is, or that one to where this is.
  bool match_pair(uint32_t low, uint32_t high, const PlaceOnCurve& there, const WorldPoint& period) {
    if (high == kNone || at(high) == at(low) + period) return false;
    return move_to(high, there, at(low) + period) || move_to(low, own_place(low), at(high) - period);
  }
  PlaceOnCurve own_place(uint32_t v) const { return {vertex(v).curve, vertex(v).at}; }

  double way(uint32_t curve, size_t a, size_t b) const {
    const CutCurve& on = cut_.curves[curve];
    const double way = std::abs(on.at_q8[a] - on.at_q8[b]);
    return on.is_loop ? std::min(way, on.length_q8 - way) : way;
  }
  /// Of a list in order of places; its size where that is empty.
  size_t nearest_of(const std::vector<OnCurve>& list, uint32_t curve, size_t to) const {
    if (list.empty()) return 0;
    const auto next = size_t(std::lower_bound(list.begin(), list.end(), OnCurve{to, 0, {}}) - list.begin());
    const size_t after = next % list.size(), before = (next + list.size() - 1) % list.size();
    return way(curve, list[before].at, to) <= way(curve, list[after].at, to) ? before : after;
  }

  /// Vertices that are each other's nearest become a pair. The others are put into the curve, or taken from it.
  bool match_curve(uint32_t c, const std::vector<OnCurve>& wanted, const WorldPoint& period, int low_side) {
    const std::vector<OnCurve> there = on_curve(c);
    std::vector<char> is_paired(there.size(), 0);
    std::vector<OnCurve> missing;
    bool has_changed = false;
    for (size_t w = 0; w < wanted.size(); ++w) {
      const size_t h = nearest_of(there, c, wanted[w].at);
      if (h == there.size() || nearest_of(wanted, c, there[h].at) != w) {
        missing.push_back(wanted[w]);
        continue;
      }
      is_paired[h] = 1;
      has_changed = match_pair(wanted[w].vertex, there[h].vertex, {c, wanted[w].at}, period) || has_changed;
    }
    for (size_t h = 0; h < there.size(); ++h) {
      if (is_paired[h]) continue;
      const uint32_t v = there[h].vertex;
      has_changed = take_away(v) || put_in_opposite(v, period, low_side) || has_changed;
    }
    for (const OnCurve& w : missing) has_changed = put_in({c, w.at}, w.position) || take_away(w.vertex) || has_changed;
    return has_changed;
  }

  bool move_to(uint32_t v, const PlaceOnCurve& there, const WorldPoint& position) {
    if (vertex(v).kind != Kind::on_curve) return false;
    std::vector<WorldPoint> normals;
    for (const uint32_t t : around(v)) normals.push_back(normal(triangles()[t]));
    RegionVertex to = lookup_.on_curve_at(there.curve, there.at);
    to.position = position;
    const bool has_moved = move(v, to, change_, [&] {
      for (size_t i = 0; i < change_.made.size(); ++i)
        if (dot(normal(change_.made[i]), normals[i]) <= 0) return false;
      return true;
    });
    if (!has_moved) return false;
    note_taken_away(there.curve, v);
    note_put_in(there.curve, {there.at, v, position});
    return true;
  }
  bool take_away(uint32_t v) {
    const bool is_gone = collapse_along_curve(v);
    if (is_gone) note_taken_away(vertex(v).curve, v);
    return is_gone;
  }
  bool collapse_along_curve(uint32_t v) {
    std::vector<uint32_t> into;
    list_targets(v, into);
    std::sort(into.begin(), into.end(), [&](uint32_t a, uint32_t b) {
      const double to_a = distance_sq(at(v), at(a)), to_b = distance_sq(at(v), at(b));
      return to_a != to_b ? to_a < to_b : a < b;
    });
    return std::any_of(into.begin(), into.end(), [&](uint32_t w) {
      return collapse(v, w, change_, [&] {
        for (size_t i = 0; i < change_.made.size(); ++i)
          if (!faces_as_made(change_.made[i], change_.number[i])) return false;
        return true;
      });
    });
  }
  bool faces_as_made(const RegionTriangle& made, uint32_t before) const {
    return dot(normal(made), normal(triangles()[before])) > 0;
  }

  /// Gives the low side a vertex of the high one.
  bool put_in_opposite(uint32_t v, const WorldPoint& period, int low_side) {
    const WorldPoint there = at(v) - period;
    const std::optional<PlaceOnCurve> low = places(low_side).nearest(there);
    return low && put_in(*low, there);
  }
  /// Splits the edge of a curve that passes a place.
  bool put_in(const PlaceOnCurve& place, const WorldPoint& position) {
    if (is_end(place.curve, place.at)) return false;
    const auto [u, v] = beside(place);
    if (u == kNone || v == kNone || curve_between(u, v).value_or(kNone) != place.curve) return false;
    RegionVertex middle = lookup_.on_curve_at(place.curve, place.at);
    middle.position = position;
    const bool is_split = split(u, v, middle, change_, [&] {
      for (size_t i = 0; i < change_.made.size(); ++i)
        if (!faces_as_made(change_.made[i], change_.replaced[i / 2])) return false;
      return true;
    });
    if (is_split) note_put_in(place.curve, {place.at, uint32_t(vertices().size() - 1), position});
    return is_split;
  }
  /// The vertices before and behind a place.
  std::pair<uint32_t, uint32_t> beside(const PlaceOnCurve& place) const {
    const CutCurve& curve = cut_.curves[place.curve];
    const std::vector<OnCurve>& list = on_curve(place.curve);
    const auto next = std::lower_bound(list.begin(), list.end(), OnCurve{place.at, 0, {}});
    if (next != list.end() && next->at == place.at) return {kNone, kNone};
    if (curve.is_loop) {
      if (list.empty()) return {kNone, kNone};
      return {(next == list.begin() ? list.back() : *(next - 1)).vertex,
              (next == list.end() ? list.front() : *next).vertex};
    }
    return {next == list.begin() ? corner_at(curve.place.front()) : (next - 1)->vertex,
            next == list.end() ? corner_at(curve.place.back()) : next->vertex};
  }

  MeshChange change_;
};

}  // namespace

PeriodicMesh with_matched_curves(PeriodicMesh mesh) {
  CurveMatcher matcher(std::move(mesh));
  matcher.match();
  return std::move(static_cast<PeriodicMesh&>(matcher));
}

}  // namespace isoshell
