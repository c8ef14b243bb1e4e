// MeshRegion (see mesh_region.h).
#include "features/angles/mesh_region.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kFollows = 0.94;          ///< cosine between a triangle's normal and the surface's at its corners
constexpr double kLeastFollows = 0.5;      ///< what a region may begin with
constexpr int kRounds = 6;                 ///< of flips and moves
constexpr double kLeastCost = 1. / 64;     ///< of a triangle that is looked at: its smallest angle is below 32 degrees
constexpr double kEnough = 1 - 1. / 1024;  ///< of the cost before, or a change is not made

WorldPoint whole(const WorldPoint& p) {
  const auto nearest = [](double x) { return std::floor(x + 0.5); };
  return {nearest(p.x), nearest(p.y), nearest(p.z)};
}

}  // namespace

MeshRegion::MeshRegion(const CutLookup& surface, std::vector<RegionVertex> vertices,
                       std::vector<RegionTriangle> triangles)
    : surface_(&surface),
      vertices_(std::move(vertices)),
      triangles_(std::move(triangles)),
      changed_(vertices_.size(), 0),
      tried_(vertices_.size(), -1),
      looked_at_(triangles_.size(), -1),
      flips_tried_(triangles_.size(), -1),
      follows_(kFollows) {
  for (const RegionTriangle& t : triangles_) follows_ = std::min(follows_, cosine_to_surface(t));
  follows_ = std::max(follows_, kLeastFollows);
  for (const RegionTriangle& t : triangles_) costs_.push_back(cost_of(t, kMostCost));
}

std::vector<size_t> MeshRegion::triangles_of(uint32_t v) const {
  std::vector<size_t> out;
  for (size_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t].corner;
    if (c[0] == v || c[1] == v || c[2] == v) out.push_back(t);
  }
  return out;
}

std::vector<MeshRegion::Side> MeshRegion::sides_of(uint32_t u, uint32_t v) const {
  std::vector<Side> sides;
  for (size_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t].corner;
    const size_t i = c[0] == u ? 0 : c[1] == u ? 1 : c[2] == u ? 2 : 3;
    if (i == 3) continue;
    if (c[(i + 1) % 3] == v) sides.push_back({t, i});
    if (c[(i + 2) % 3] == v) sides.push_back({t, (i + 2) % 3});
  }
  return sides;
}

/// Off curves there is one at most.
std::optional<MeshRegion::Side> MeshRegion::side_from(uint32_t u, uint32_t v) const {
  for (size_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t].corner;
    for (size_t i = 0; i < 3; ++i)
      if (c[i] == u && c[(i + 1) % 3] == v) return Side{t, i};
  }
  return {};
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

/// Those that a vertex on a curve has edges with along it.
std::vector<uint32_t> MeshRegion::next_on_curve(uint32_t v) const {
  std::vector<uint32_t> out;
  for (const RegionTriangle& t : triangles_)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = t.corner[i], b = t.corner[(i + 1) % 3];
      if (t.curve[i] == vertices_[v].curve && (a == v || b == v)) out.push_back(a == v ? b : a);
    }
  std::sort(out.begin(), out.end());
  out.erase(std::unique(out.begin(), out.end()), out.end());
  return out;
}

/// Says that vertices, or triangles around them, are not as they were.
void MeshRegion::touch(const std::vector<uint32_t>& vertices) {
  ++clock_;
  for (const uint32_t v : vertices) changed_[v] = clock_;
}

int MeshRegion::changed_at(const RegionTriangle& t) const {
  return std::max({changed_[t.corner[0]], changed_[t.corner[1]], changed_[t.corner[2]]});
}

bool MeshRegion::has_changed(size_t triangle) const {
  const RegionTriangle& t = triangles_[triangle];
  return t.is_gone() || changed_at(t) > 0;
}

RegionVertex MeshRegion::on_curve_at(uint32_t curve, size_t at) const {
  RegionVertex out;
  out.kind = RegionVertex::Kind::on_curve;
  out.curve = curve;
  out.at = at % surface_->cut().curves[curve].place.size();
  out.home = surface_->home_on(curve, out.at);
  out.position = surface_->position(out.home);
  return out;
}

/// In an edge, as near to a point as there are places on its curve, or vertices of the surface. Stays a corner where
/// there is none.
RegionVertex MeshRegion::vertex_between(uint32_t u, uint32_t v, uint32_t curve, uint32_t patch,
                                        const WorldPoint& near) const {
  RegionVertex none;
  none.kind = RegionVertex::Kind::corner;
  if (curve != kNone) {
    const auto [begin, end] = span(u, v, curve);
    size_t best = end;
    double nearest = std::numeric_limits<double>::infinity();
    for (size_t i = begin + 1; i < end; ++i)
      if (const double d = distance_sq(surface_->position(surface_->home_on(curve, i)), near); d < nearest)
        best = i, nearest = d;
    return best < end ? on_curve_at(curve, best) : none;
  }
  const uint32_t start =
      vertices_[u].kind == RegionVertex::Kind::free ? vertices_[u].home : surface_->copy_in(vertices_[v].home, patch);
  return start == kNone ? none : vertex_near(start, near);
}

/// The vertex of the surface there. A corner where that is on a border.
RegionVertex MeshRegion::vertex_near(uint32_t start, const WorldPoint& near) const {
  const uint32_t at = surface_->nearest_from(start, near);
  RegionVertex out;
  out.kind = surface_->cut().place[at] == kNone ? RegionVertex::Kind::free : RegionVertex::Kind::corner;
  out.home = at;
  out.position = surface_->position(at);
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
  changed_.push_back(0);
  tried_.push_back(-1);
  std::vector<uint32_t> touched{m};
  for (const Side& s : sides) {
    RegionTriangle& t = triangles_[s.triangle];
    RegionTriangle other = t;
    touched.insert(touched.end(), t.corner.begin(), t.corner.end());
    const size_t next = (s.edge + 1) % 3, last = (s.edge + 2) % 3;
    t.corner[next] = m;
    t.curve[next] = kNone;
    other.corner[s.edge] = m;
    other.curve[last] = kNone;
    costs_[s.triangle] = cost_of(t, kMostCost);
    costs_.push_back(cost_of(other, kMostCost));
    looked_at_.push_back(-1);
    flips_tried_.push_back(-1);
    triangles_.push_back(other);
  }
  touch(touched);
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
  const size_t of_tetrahedron = both.size() + 1;  // two triangles with the same corners would be left of it
  if (here.size() == of_tetrahedron && there.size() == of_tetrahedron) return false;
  std::vector<std::pair<uint32_t, uint32_t>> fused;  // ends of edges of which one was on a curve
  for (const Side& s : sides) {
    const RegionTriangle& t = triangles_[s.triangle];
    const uint32_t one = t.curve[(s.edge + 1) % 3], other = t.curve[(s.edge + 2) % 3];
    if (one != kNone && other != kNone) return false;
    const uint32_t curve = one != kNone ? one : other;
    if (curve != kNone) fused.push_back({t.corner[(s.edge + 2) % 3], curve});
  }
  for (const size_t i : triangles_of(gone)) {
    RegionTriangle& t = triangles_[i];
    const bool is_fused = std::count(t.corner.begin(), t.corner.end(), into) > 0;
    std::replace(t.corner.begin(), t.corner.end(), gone, into);
    if (is_fused) t.corner.fill(RegionVertex::kNoOne), costs_[i] = 0;
  }
  for (const size_t i : triangles_of(into)) {
    RegionTriangle& t = triangles_[i];
    for (size_t k = 0; k < 3; ++k)
      for (const auto& [end, curve] : fused) {
        const uint32_t a = t.corner[k], b = t.corner[(k + 1) % 3];
        if ((a == into && b == end) || (a == end && b == into)) t.curve[k] = curve;
      }
    costs_[i] = cost_of(t, kMostCost);
  }
  std::vector<uint32_t> touched = here;
  touched.insert(touched.end(), {gone, into});
  touch(touched);
  return true;
}

/// Whether that costs less. Of a and b at the ends, c and d opposite.
bool MeshRegion::flip(size_t triangle, size_t edge) {
  const RegionTriangle t = triangles_[triangle];
  if (t.curve[edge] != kNone) return false;
  const uint32_t a = t.corner[edge], b = t.corner[(edge + 1) % 3], c = t.corner[(edge + 2) % 3];
  const std::optional<Side> other = side_from(b, a);
  if (!other) return false;
  const RegionTriangle s = triangles_[other->triangle];
  const uint32_t d = s.corner[(other->edge + 2) % 3];
  if (c == d || s.patch != t.patch) return false;
  if (!vertices_[c].is_inner && !vertices_[d].is_inner) return false;
  const RegionTriangle first = {{a, d, c}, {s.curve[(other->edge + 1) % 3], kNone, t.curve[(edge + 2) % 3]}, t.patch};
  const RegionTriangle second = {{b, c, d}, {t.curve[(edge + 1) % 3], kNone, s.curve[(other->edge + 2) % 3]}, t.patch};
  const double most = kEnough * (costs_[triangle] + costs_[other->triangle]);
  const double cost = cost_of(first, most);
  const double other_cost = cost < most ? cost_of(second, most - cost) : 0;
  if (cost + other_cost >= most || !sides_of(c, d).empty()) return false;
  triangles_[triangle] = first;
  triangles_[other->triangle] = second;
  costs_[triangle] = cost;
  costs_[other->triangle] = other_cost;
  touch({a, b, c, d});
  return true;
}

/// Along a curve, towards both of the next vertices, in steps that double; not as far as these.
std::vector<RegionVertex> MeshRegion::positions_along(uint32_t v) const {
  std::vector<RegionVertex> out;
  const RegionVertex& here = vertices_[v];
  for (const uint32_t u : next_on_curve(v)) {
    const auto [begin, end] = span(u, v, here.curve);
    for (size_t step = 1; begin + step < end; step *= 2)
      out.push_back(on_curve_at(here.curve, begin == here.at ? begin + step : end - step));
  }
  return out;
}

/// Around the home of a vertex: neighbours of that on the surface, and halfway to them.
std::vector<RegionVertex> MeshRegion::positions_around(uint32_t v) const {
  const SurfaceMesh& surface = surface_->cut().surface;
  const uint32_t home = vertices_[v].home;
  RegionVertex there = vertices_[v];
  const WorldPoint middle = there.position = surface_->position(home);
  std::vector<RegionVertex> out{there};
  for (int64_t n = surface.vertex_first[home]; n < surface.vertex_first[home + 1]; ++n) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
    const uint32_t w = t.a == home ? t.b : t.b == home ? t.c : t.a;  // all of them: the home is on no border
    const WorldPoint at = surface_->position(w);
    there.home = home;
    there.position = whole(0.5 * (middle + at));
    out.push_back(there);
    if (surface_->cut().place[w] != kNone) continue;
    there.home = w;
    there.position = at;
    out.push_back(there);
  }
  return out;
}

bool MeshRegion::move(uint32_t v) {
  if (!vertices_[v].is_inner || vertices_[v].kind == RegionVertex::Kind::corner) return false;
  if (changed_[v] <= tried_[v]) return false;
  tried_[v] = clock_;
  const RegionVertex before = vertices_[v];
  RegionVertex best = before;
  std::vector<size_t> around = triangles_of(v);
  std::stable_sort(around.begin(), around.end(), [&](size_t a, size_t b) { return costs_[a] > costs_[b]; });  // soonest
  double least = 0;
  for (const size_t t : around) least += kEnough * costs_[t];
  if (least == 0) return false;
  const bool is_free = before.kind == RegionVertex::Kind::free;
  for (const RegionVertex& there : is_free ? positions_around(v) : positions_along(v)) {
    vertices_[v].home = there.home;
    vertices_[v].at = there.at;
    vertices_[v].position = there.position;
    double cost = 0;
    for (size_t i = 0; i < around.size() && cost < least; ++i) cost += cost_of(triangles_[around[i]], least - cost);
    if (cost < least) least = cost, best = vertices_[v];
  }
  vertices_[v] = best;
  if (best.home == before.home && length_sq(best.position - before.position) == 0) return false;
  for (const size_t t : around) costs_[t] = cost_of(triangles_[t], kMostCost);
  std::vector<uint32_t> touched = neighbours_of(v);
  touched.push_back(v);
  touch(touched);
  return true;
}

void MeshRegion::mark_all_tried() {
  std::fill(tried_.begin(), tried_.end(), clock_);
  std::fill(looked_at_.begin(), looked_at_.end(), clock_);
  std::fill(flips_tried_.begin(), flips_tried_.end(), clock_);
}

/// Unless that did not help before and nothing around has changed since.
bool MeshRegion::flip_any(size_t triangle) {
  bool has_changed = false;
  for (size_t i = 0; i < 3 && costs_[triangle] >= kLeastCost; ++i) {
    if (changed_at(triangles_[triangle]) <= flips_tried_[triangle]) break;
    has_changed = flip(triangle, i) || has_changed;
  }
  if (!has_changed) flips_tried_[triangle] = clock_;
  return has_changed;
}

void MeshRegion::flip_edges() {
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (size_t t = 0; t < triangles_.size(); ++t) has_changed = flip_any(t) || has_changed;
  }
}

void MeshRegion::relax(double hopeless) {
  for (int round = 0; round < kRounds; ++round) {
    bool has_changed = false;
    for (size_t t = 0; t < triangles_.size(); ++t) {
      if (costs_[t] < kLeastCost || changed_at(triangles_[t]) <= looked_at_[t]) continue;
      looked_at_[t] = clock_;
      has_changed = flip_any(t) || has_changed;
      for (const uint32_t v : std::array<uint32_t, 3>(triangles_[t].corner)) has_changed = move(v) || has_changed;
    }
    if (!has_changed || cost() > hopeless) return;
  }
}

}  // namespace isoshell
