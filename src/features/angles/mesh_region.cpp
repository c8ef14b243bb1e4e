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

constexpr double kFollows = 0.94;       ///< cosine between a triangle's normal and the surface's at its corners
constexpr double kLeastFollows = 0.5;   ///< what a region may begin with
constexpr int kRounds = 6;              ///< of flips and moves
constexpr double kLeastCost = 1. / 64;  ///< of a triangle that is looked at: its smallest angle is below 32 degrees

WorldPoint whole(const WorldPoint& p) {
  const auto nearest = [](double x) { return std::floor(x + 0.5); };
  return {nearest(p.x), nearest(p.y), nearest(p.z)};
}

}  // namespace

MeshRegion::MeshRegion(const CutLookup& surface, std::vector<RegionVertex> vertices,
                       std::vector<RegionTriangle> triangles)
    : EditableMesh(std::move(vertices), std::move(triangles), Size::few),
      surface_(&surface),
      changed_(this->vertices().size(), 0),
      tried_(this->vertices().size(), -1),
      looked_at_(this->triangles().size(), -1),
      flips_tried_(this->triangles().size(), -1),
      follows_(kFollows) {
  for (const RegionTriangle& t : this->triangles())
    if (sine(t) > 0) follows_ = std::min(follows_, surface_->cosine(*this, t));
  follows_ = std::max(follows_, kLeastFollows);
  for (const RegionTriangle& t : this->triangles()) costs_.push_back(cost_of(t, kMostCost));
}

std::vector<uint32_t> MeshRegion::triangles_of(uint32_t v) const {
  std::vector<uint32_t> out;
  for_each_around(v, [&](uint32_t t) { out.push_back(t); });
  return out;
}

void MeshRegion::cost_again(const std::vector<uint32_t>& triangles) {
  for (const uint32_t t : triangles) costs_[t] = cost_of(this->triangles()[t], kMostCost);
}

/// Says that vertices of triangles, or triangles around them, are not as they were.
void MeshRegion::note(const std::vector<RegionTriangle>& changed) {
  ++clock_;
  for (const RegionTriangle& t : changed)
    for (const uint32_t v : t.corner) changed_[v] = clock_;
}

int MeshRegion::changed_at(const RegionTriangle& t) const {
  return std::max({changed_[t.corner[0]], changed_[t.corner[1]], changed_[t.corner[2]]});
}

bool MeshRegion::has_changed(size_t triangle) const {
  const RegionTriangle& t = triangles()[triangle];
  return t.is_gone() || changed_at(t) > 0;
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
    return best < end ? surface_->on_curve_at(curve, best) : none;
  }
  const uint32_t start =
      vertex(u).kind == RegionVertex::Kind::free ? vertex(u).home : surface_->copy_in(vertex(v).home, patch);
  const RegionVertex there = start == kNone ? none : surface_->vertex_at(surface_->nearest_from(start, near));
  return there.kind == RegionVertex::Kind::free ? there : none;
}

bool MeshRegion::split(uint32_t u, uint32_t v, const WorldPoint& near) {
  const uint32_t first = find_around(u, [&](const RegionTriangle& t) { return t.has(u) && t.has(v); });
  if (first == kNone) return false;
  const RegionVertex middle = vertex_between(u, v, *curve_between(u, v), triangles()[first].patch, near);
  if (middle.kind == RegionVertex::Kind::corner) return false;
  MeshChange change;
  if (!EditableMesh::split(u, v, middle, change, [] { return true; })) return false;
  changed_.push_back(0);
  tried_.push_back(-1);
  costs_.resize(triangles().size());
  looked_at_.resize(triangles().size(), -1);
  flips_tried_.resize(triangles().size(), -1);
  cost_again(change.number);
  note(change.made);
  return true;
}

bool MeshRegion::collapse(uint32_t gone, uint32_t into) {
  MeshChange change;
  if (!EditableMesh::collapse(gone, into, change, [] { return true; })) return false;
  cost_again(change.replaced);
  cost_again(triangles_of(into));
  note(change.made);
  for (const uint32_t v : change.here) changed_[v] = clock_;
  changed_[gone] = clock_;
  return true;
}

/// Whether that costs less.
bool MeshRegion::flip(uint32_t triangle, size_t edge, MeshChange& change) {
  double cost = 0, other_cost = 0;
  const auto costs_less = [&] {
    const double most = kEnough * (costs_[triangle] + costs_[change.replaced[1]]);
    cost = cost_of(change.made[0], most);
    if (cost < most) other_cost = cost_of(change.made[1], most - cost);
    return cost + other_cost < most;
  };
  if (!EditableMesh::flip(triangle, edge, change, costs_less)) return false;
  costs_[triangle] = cost;
  costs_[change.replaced[1]] = other_cost;
  note(change.made);
  return true;
}

/// Along a curve, towards both of the next vertices, in steps that double; not as far as these.
std::vector<RegionVertex> MeshRegion::positions_along(uint32_t v) const {
  std::vector<RegionVertex> out;
  const RegionVertex& here = vertex(v);
  std::vector<uint32_t> next;
  list_targets(v, next);
  std::sort(next.begin(), next.end());
  for (const uint32_t u : next) {
    const auto [begin, end] = span(u, v, here.curve);
    for (size_t step = 1; begin + step < end; step *= 2)
      out.push_back(surface_->on_curve_at(here.curve, begin == here.at ? begin + step : end - step));
  }
  return out;
}

/// Around the home of a vertex: neighbours of that on the surface, and halfway to them.
std::vector<RegionVertex> MeshRegion::positions_around(uint32_t v) const {
  const SurfaceMesh& surface = surface_->cut().surface;
  const uint32_t home = vertex(v).home;
  RegionVertex there = vertex(v);
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

bool MeshRegion::move(uint32_t v, MeshChange& change) {
  const RegionVertex before = vertex(v);
  if (!before.is_inner || before.kind == RegionVertex::Kind::corner || changed_[v] <= tried_[v]) return false;
  tried_[v] = clock_;
  RegionVertex best = before;
  std::vector<uint32_t> around = triangles_of(v);
  std::stable_sort(around.begin(), around.end(), [&](auto a, auto b) { return costs_[a] > costs_[b]; });  // soonest
  double least = 0;
  for (const uint32_t t : around) least += kEnough * costs_[t];
  if (least == 0) return false;
  const bool is_free = before.kind == RegionVertex::Kind::free;
  for (const RegionVertex& there : is_free ? positions_around(v) : positions_along(v)) {
    place(v, there);
    double cost = 0;
    for (size_t i = 0; i < around.size() && cost < least; ++i) cost += cost_of(triangles()[around[i]], least - cost);
    if (cost < least) least = cost, best = there;
  }
  place(v, before);
  if (best.home == before.home && best.position == before.position) return false;
  if (!EditableMesh::move(v, best, change, [] { return true; })) return false;
  cost_again(around);
  note(change.made);
  return true;
}

void MeshRegion::mark_all_tried() {
  std::fill(tried_.begin(), tried_.end(), clock_);
  std::fill(looked_at_.begin(), looked_at_.end(), clock_);
  std::fill(flips_tried_.begin(), flips_tried_.end(), clock_);
}

/// Unless that did not help before and nothing around has changed since.
bool MeshRegion::flip_any(uint32_t triangle, MeshChange& change) {
  bool has_changed = false;
  for (size_t i = 0; i < 3 && costs_[triangle] >= kLeastCost; ++i) {
    if (changed_at(triangles()[triangle]) <= flips_tried_[triangle]) break;
    has_changed = flip(triangle, i, change) || has_changed;
  }
  if (!has_changed) flips_tried_[triangle] = clock_;
  return has_changed;
}

void MeshRegion::flip_edges() {
  MeshChange change;
  for (bool has_changed = true; has_changed;) {
    has_changed = false;
    for (uint32_t t = 0; t < triangles().size(); ++t) has_changed = flip_any(t, change) || has_changed;
  }
}

void MeshRegion::relax(double hopeless) {
  MeshChange change;
  for (int round = 0; round < kRounds; ++round) {
    bool has_changed = false;
    for (uint32_t t = 0; t < triangles().size(); ++t) {
      if (costs_[t] < kLeastCost || changed_at(triangles()[t]) <= looked_at_[t]) continue;
      looked_at_[t] = clock_;
      has_changed = flip_any(t, change) || has_changed;
      for (const uint32_t v : std::array<uint32_t, 3>(triangles()[t].corner))
        has_changed = move(v, change) || has_changed;
    }
    if (!has_changed || cost() > hopeless) return;
  }
}

}  // namespace isoshell
