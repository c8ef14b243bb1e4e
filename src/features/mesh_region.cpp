// MeshRegion (see mesh_region.h).
#include "features/mesh_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "isoshell/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kGoodSine = 0.587785;     ///< of 36 degrees
constexpr double kMostCost = 1e6;          ///< of one triangle: a degenerate one
constexpr double kFollows = 0.94;          ///< cosine between a triangle's normal and the surface's at its corners
constexpr double kLeastFollows = 0.5;      ///< what a region may begin with
constexpr double kCostOfPoor = 0.05;       ///< of any angle below 30 degrees, beside its own
constexpr double kCostOfTurn = 200;        ///< a normal 30 degrees off weighs as much as an angle of 17 degrees
constexpr double kMostOffCurve = 0.03;     ///< edges from the curve to its chord
constexpr double kCostOfChord = 0.4;       ///< at twice as far
constexpr int kRounds = 6;                 ///< of flips and moves
constexpr double kLeastCost = 1. / 64;     ///< of a triangle that is looked at: its smallest angle is below 32 degrees
constexpr double kEnough = 1 - 1. / 1024;  ///< of the cost before, or a change is not made

WorldPoint to_point(PointQ8 p) { return {double(p.x), double(p.y), double(p.z)}; }
WorldPoint to_point(Normal8 n) { return {double(n.x), double(n.y), double(n.z)}; }
WorldPoint whole(const WorldPoint& p) {
  const auto nearest = [](double x) { return std::floor(x + 0.5); };
  return {nearest(p.x), nearest(p.y), nearest(p.z)};
}

}  // namespace

double smallest_sine(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double ab = distance_sq(a, b), bc = distance_sq(b, c), ca = distance_sq(c, a);
  const double longer_sq = std::max({ab * bc, bc * ca, ca * ab});  // beside the smallest angle
  return longer_sq > 0 ? length(doubled_area(a, b, c)) / std::sqrt(longer_sq) : 0;
}

MeshRegion::MeshRegion(const CutSurface& cut, std::vector<RegionVertex> vertices, std::vector<RegionTriangle> triangles)
    : cut_(&cut), vertices_(std::move(vertices)), triangles_(std::move(triangles)), follows_(kFollows) {
  for (const RegionTriangle& t : triangles_) follows_ = std::min(follows_, cosine_to_surface(t));
  follows_ = std::max(follows_, kLeastFollows);
  find_costs();
}

void MeshRegion::find_costs() {
  costs_.clear();
  for (const RegionTriangle& t : triangles_) costs_.push_back(cost_of(t));
}

double MeshRegion::sine_of(const RegionTriangle& t) const {
  return smallest_sine(vertices_[t.corner[0]].position, vertices_[t.corner[1]].position,
                       vertices_[t.corner[2]].position);
}

int64_t MeshRegion::poor() const {
  return std::count_if(triangles_.begin(), triangles_.end(),
                       [&](const RegionTriangle& t) { return sine_of(t) < kPoorSine; });
}

double MeshRegion::worst_sine() const {
  double worst = kPoorSine;
  for (const RegionTriangle& t : triangles_) worst = std::min(worst, sine_of(t));
  return worst;
}

double MeshRegion::cost() const { return std::accumulate(costs_.begin(), costs_.end(), 0.0); }

double MeshRegion::cost_of(const RegionTriangle& t) const {
  const double sine = sine_of(t);
  if (!(sine > 0)) return kMostCost;
  const double thin = std::max(0.0, kGoodSine / sine - 1);
  const double turned = std::max(0.0, follows_ - cosine_to_surface(t));
  double sum = thin * thin + (sine < kPoorSine ? kCostOfPoor : 0) + kCostOfTurn * turned * turned;
  for (size_t i = 0; i < 3; ++i)
    if (t.curve[i] != kNone) sum += cost_of_chord(t.corner[i], t.corner[(i + 1) % 3], t.curve[i]);
  return std::min(sum, kMostCost);
}

/// Between the normal of a triangle and those of the surface at its corners, the least.
double MeshRegion::cosine_to_surface(const RegionTriangle& t) const {
  const WorldPoint n =
      doubled_area(vertices_[t.corner[0]].position, vertices_[t.corner[1]].position, vertices_[t.corner[2]].position);
  double least = 1;
  for (const uint32_t v : t.corner) least = std::min(least, cosine_at(vertices_[v], t.patch, n));
  return least;
}

/// Between a vector and the normal of the surface of a patch at a vertex; of several fans there the one that fits best.
double MeshRegion::cosine_at(const RegionVertex& v, uint32_t patch, const WorldPoint& n) const {
  const auto cosine = [&](uint32_t copy) {
    const WorldPoint at = to_point(cut_->surface.normal[copy]);
    const double scale = std::sqrt(length_sq(at) * length_sq(n));
    return scale > 0 ? dot(at, n) / scale : 1;
  };
  const uint32_t place = cut_->place[v.home];
  if (place == kNone) return cosine(v.home);
  double best = -1;
  for (int64_t i = cut_->copies_first[place]; i < cut_->copies_first[place + 1]; ++i)
    if (patch_of(cut_->copies[size_t(i)]) == patch) best = std::max(best, cosine(cut_->copies[size_t(i)]));
  return best;
}

std::vector<size_t> MeshRegion::triangles_of(uint32_t v) const {
  std::vector<size_t> out;
  for (size_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t].corner;
    if (c[0] == v || c[1] == v || c[2] == v) out.push_back(t);
  }
  return out;
}

double MeshRegion::cost_of_chord(uint32_t u, uint32_t v, uint32_t curve) const {
  const CutCurve& c = cut_->curves[curve];
  const auto [begin, end] = span(u, v, curve);
  const auto at = [&](size_t i) {
    return to_point(cut_->surface.position[cut_->copies[size_t(cut_->copies_first[c.place[i % c.place.size()]])]]);
  };
  const WorldPoint a = at(begin), chord = at(end) - a;
  const double whole_sq = length_sq(chord);
  double farthest_sq = 0;
  for (size_t i = begin + 1; i < end; ++i) {
    const WorldPoint p = at(i);
    const double part = whole_sq > 0 ? std::clamp(dot(p - a, chord) / whole_sq, 0.0, 1.0) : 0;
    farthest_sq = std::max(farthest_sq, distance_sq(p, a + part * chord));
  }
  const double off = std::sqrt(farthest_sq) / edge_length_at(vertices_[u].home) / kMostOffCurve - 1;
  return off > 0 ? kCostOfChord * off * off : 0;
}

double MeshRegion::edge_length_at(uint32_t home) const {
  const EdgeLengths& lengths = cut_->surface.lengths;
  return lengths.at.empty() ? cut_->longest_edge_q8 : double(lengths.at[home]);
}

uint32_t MeshRegion::patch_of(uint32_t vertex) const {
  return cut_->surface.patch.empty() ? 0 : cut_->surface.patch[vertex];
}

/// Of several fans of one patch at a place the first one; kNone where there is none.
uint32_t MeshRegion::copy_in(uint32_t home, uint32_t patch) const {
  const uint32_t place = cut_->place[home];
  if (place == kNone || patch_of(home) == patch) return home;
  for (int64_t i = cut_->copies_first[place]; i < cut_->copies_first[place + 1]; ++i)
    if (patch_of(cut_->copies[size_t(i)]) == patch) return cut_->copies[size_t(i)];
  return kNone;
}

/// Its place on a curve that it is on or ends; of both ends of a curve that returns to its corner the one nearer to
/// `other`.
size_t MeshRegion::place_on(const RegionVertex& v, uint32_t curve, size_t other) const {
  if (v.kind == RegionVertex::Kind::on_curve) return v.at;
  const CutCurve& c = cut_->curves[curve];
  const size_t last = c.place.size() - 1;
  if (c.place.front() == c.place.back()) return 2 * other < last ? 0 : last;
  return c.place.front() == cut_->place[v.home] ? 0 : last;
}

/// The places between two vertices that follow each other on a curve, the shorter way around a loop; beyond its last
/// one it goes on with the first.
std::array<size_t, 2> MeshRegion::span(uint32_t u, uint32_t v, uint32_t curve) const {
  const RegionVertex &a = vertices_[u], &b = vertices_[v];
  const CutCurve& c = cut_->curves[curve];
  const size_t n = c.place.size();
  if (a.kind != RegionVertex::Kind::on_curve && b.kind != RegionVertex::Kind::on_curve) return {0, n - 1};
  const size_t i = place_on(a, curve, b.at), j = place_on(b, curve, a.at);
  const size_t begin = std::min(i, j), end = std::max(i, j);
  if (c.is_loop && 2 * (c.at_q8[end] - c.at_q8[begin]) > c.length_q8) return {end, begin + n};
  return {begin, end};
}

std::vector<MeshRegion::Side> MeshRegion::sides_of(uint32_t u, uint32_t v) const {
  std::vector<Side> sides;
  for (size_t t = 0; t < triangles_.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = triangles_[t].corner[i], b = triangles_[t].corner[(i + 1) % 3];
      if ((a == u && b == v) || (a == v && b == u)) sides.push_back({t, i});
    }
  return sides;
}

std::vector<uint32_t> MeshRegion::neighbours_of(uint32_t v) const {
  std::vector<uint32_t> out;
  for (const RegionTriangle& t : triangles_)
    for (size_t i = 0; i < 3; ++i)
      if (t.corner[i] == v) out.insert(out.end(), {t.corner[(i + 1) % 3], t.corner[(i + 2) % 3]});
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// In an edge, as near to a point as there are places on its curve, or vertices of the surface. Stays a corner where
/// there is none.
RegionVertex MeshRegion::vertex_between(uint32_t u, uint32_t v, uint32_t curve, uint32_t patch,
                                        const WorldPoint& near) const {
  RegionVertex out;
  out.kind = RegionVertex::Kind::corner;
  const SurfaceMesh& surface = cut_->surface;
  if (curve != kNone) {
    const CutCurve& c = cut_->curves[curve];
    const auto [begin, end] = span(u, v, curve);
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = begin + 1; i < end; ++i) {
      const uint32_t home = cut_->copies[size_t(cut_->copies_first[c.place[i % c.place.size()]])];
      const WorldPoint position = to_point(surface.position[home]);
      if (distance_sq(position, near) >= nearest) continue;
      nearest = distance_sq(position, near);
      out.kind = RegionVertex::Kind::on_curve;
      out.curve = curve;
      out.at = i % c.place.size();
      out.home = home;
      out.position = position;
    }
    return out;
  }
  uint32_t at = vertices_[u].kind == RegionVertex::Kind::free ? vertices_[u].home : copy_in(vertices_[v].home, patch);
  if (at == kNone) return out;
  for (uint32_t from = kNone; from != at;) {
    from = at;
    double nearest = distance_sq(to_point(surface.position[at]), near);
    for (int64_t n = surface.vertex_first[from]; n < surface.vertex_first[from + 1]; ++n) {
      const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
      for (const uint32_t w : {t.a, t.b, t.c}) {
        const double d = distance_sq(to_point(surface.position[w]), near);
        if (d < nearest || (d == nearest && w < at)) nearest = d, at = w;
      }
    }
  }
  out.kind = cut_->place[at] == kNone ? RegionVertex::Kind::free : RegionVertex::Kind::corner;
  out.home = at;
  out.position = to_point(surface.position[at]);
  return out;
}

bool MeshRegion::split(uint32_t u, uint32_t v, const WorldPoint& near) {
  if (!vertices_[u].is_inner && !vertices_[v].is_inner) return false;
  const std::vector<Side> sides = sides_of(u, v);
  if (sides.empty()) return false;
  const RegionTriangle first = triangles_[sides[0].triangle];
  const RegionVertex middle = vertex_between(u, v, first.curve[sides[0].edge], first.patch, near);
  if (middle.kind == RegionVertex::Kind::corner) return false;
  const auto m = uint32_t(vertices_.size());
  vertices_.push_back(middle);
  for (const Side& s : sides) {
    RegionTriangle& t = triangles_[s.triangle];
    RegionTriangle other = t;
    const size_t next = (s.edge + 1) % 3, last = (s.edge + 2) % 3;
    t.corner[next] = m;
    t.curve[next] = kNone;
    other.corner[s.edge] = m;
    other.curve[last] = kNone;
    triangles_.push_back(other);
  }
  find_costs();
  return true;
}

bool MeshRegion::collapse(uint32_t gone, uint32_t into) {
  using Kind = RegionVertex::Kind;
  const RegionVertex &from = vertices_[gone], &to = vertices_[into];
  if (!from.is_inner || !to.is_inner) return false;
  const std::vector<Side> sides = sides_of(gone, into);
  if (sides.empty()) return false;
  const uint32_t along = triangles_[sides[0].triangle].curve[sides[0].edge];
  if (from.kind != Kind::free && (from.kind != Kind::on_curve || along == kNone)) return false;
  const std::vector<uint32_t> here = neighbours_of(gone), there = neighbours_of(into);
  std::vector<uint32_t> both;
  std::set_intersection(here.begin(), here.end(), there.begin(), there.end(), std::back_inserter(both));
  if (both.size() != sides.size()) return false;
  std::vector<std::pair<uint32_t, uint32_t>> fused;  // ends of edges of which one was on a curve
  for (const Side& s : sides) {
    const RegionTriangle& t = triangles_[s.triangle];
    const uint32_t one = t.curve[(s.edge + 1) % 3], other = t.curve[(s.edge + 2) % 3];
    if (one != kNone && other != kNone) return false;
    const uint32_t curve = one != kNone ? one : other;
    if (curve != kNone) fused.push_back({t.corner[(s.edge + 2) % 3], curve});
  }
  std::vector<RegionTriangle> left;
  for (RegionTriangle t : triangles_) {
    const bool has_gone = std::count(t.corner.begin(), t.corner.end(), gone) > 0;
    if (has_gone && std::count(t.corner.begin(), t.corner.end(), into) > 0) continue;
    std::replace(t.corner.begin(), t.corner.end(), gone, into);
    for (size_t i = 0; i < 3; ++i)
      for (const auto& [end, curve] : fused) {
        const uint32_t a = t.corner[i], b = t.corner[(i + 1) % 3];
        if ((a == into && b == end) || (a == end && b == into)) t.curve[i] = curve;
      }
    left.push_back(t);
  }
  triangles_ = std::move(left);
  find_costs();
  return true;
}

/// Whether that costs less. Of a and b at the ends, c and d opposite.
bool MeshRegion::flip(size_t triangle, size_t edge) {
  const RegionTriangle t = triangles_[triangle];
  const uint32_t a = t.corner[edge], b = t.corner[(edge + 1) % 3], c = t.corner[(edge + 2) % 3];
  const std::vector<Side> sides = sides_of(a, b);
  if (t.curve[edge] != kNone || sides.size() != 2) return false;
  const Side other = sides[0].triangle == triangle ? sides[1] : sides[0];
  const RegionTriangle s = triangles_[other.triangle];
  const uint32_t d = s.corner[(other.edge + 2) % 3];
  if (c == d || s.patch != t.patch || s.corner[other.edge] != b) return false;
  if ((!vertices_[c].is_inner && !vertices_[d].is_inner) || !sides_of(c, d).empty()) return false;
  const RegionTriangle first = {{a, d, c}, {s.curve[(other.edge + 1) % 3], kNone, t.curve[(edge + 2) % 3]}, t.patch};
  const RegionTriangle second = {{b, c, d}, {t.curve[(edge + 1) % 3], kNone, s.curve[(other.edge + 2) % 3]}, t.patch};
  const double cost = cost_of(first), other_cost = cost_of(second);
  if (cost + other_cost >= kEnough * (costs_[triangle] + costs_[other.triangle])) return false;
  triangles_[triangle] = first;
  triangles_[other.triangle] = second;
  costs_[triangle] = cost;
  costs_[other.triangle] = other_cost;
  return true;
}

/// Where a vertex may go: along its curve as far as the next ones, or around its home.
std::vector<RegionVertex> MeshRegion::places_for(uint32_t v) const {
  std::vector<RegionVertex> out;
  const RegionVertex& here = vertices_[v];
  const SurfaceMesh& surface = cut_->surface;
  if (here.kind == RegionVertex::Kind::on_curve) {
    const CutCurve& c = cut_->curves[here.curve];
    for (const uint32_t u : neighbours_of(v)) {
      const std::vector<Side> sides = sides_of(u, v);
      if (triangles_[sides[0].triangle].curve[sides[0].edge] != here.curve) continue;
      const auto [begin, end] = span(u, v, here.curve);
      for (size_t i = begin + 1; i < end; ++i) {
        RegionVertex there = here;
        there.at = i % c.place.size();
        there.home = cut_->copies[size_t(cut_->copies_first[c.place[there.at]])];
        there.position = to_point(surface.position[there.home]);
        out.push_back(there);
      }
    }
    return out;
  }
  const WorldPoint home = to_point(surface.position[here.home]);
  for (int64_t n = surface.vertex_first[here.home]; n < surface.vertex_first[here.home + 1]; ++n) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
    for (const uint32_t w : {t.a, t.b, t.c}) {
      RegionVertex there = here;
      const WorldPoint at = to_point(surface.position[w]);
      there.position = whole(0.5 * (home + at));  // at home itself where w is it
      out.push_back(there);
      if (cut_->place[w] != kNone) continue;
      there.position = at;
      there.home = w;
      out.push_back(there);
    }
  }
  return out;
}

bool MeshRegion::move(uint32_t v) {
  if (!vertices_[v].is_inner || vertices_[v].kind == RegionVertex::Kind::corner) return false;
  const RegionVertex before = vertices_[v];
  RegionVertex best = before;
  const std::vector<size_t> around = triangles_of(v);
  double least = 0;
  for (const size_t t : around) least += kEnough * costs_[t];
  if (least == 0) return false;
  const std::vector<RegionVertex> places = places_for(v);
  for (const RegionVertex& there : places) {
    vertices_[v] = there;
    double cost = 0;
    for (size_t i = 0; i < around.size() && cost < least; ++i) cost += cost_of(triangles_[around[i]]);
    if (cost < least) least = cost, best = there;
  }
  vertices_[v] = best;
  for (const size_t t : around) costs_[t] = cost_of(triangles_[t]);
  return best.home != before.home || length_sq(best.position - before.position) > 0;
}

void MeshRegion::relax() {
  for (int round = 0; round < kRounds; ++round) {
    bool has_changed = false;
    for (size_t t = 0; t < triangles_.size(); ++t) {
      if (costs_[t] < kLeastCost) continue;
      for (size_t i = 0; i < 3; ++i) has_changed = flip(t, i) || has_changed;
      for (const uint32_t v : std::array<uint32_t, 3>(triangles_[t].corner)) has_changed = move(v) || has_changed;
    }
    if (!has_changed) return;
  }
}

}  // namespace isoshell
