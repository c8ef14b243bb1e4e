// EditableMesh (see editable_mesh.h).
#include "features/mesh/editable_mesh.h"

#include <algorithm>
#include <cmath>

#include "geometry/half_edges.h"

namespace isoshell {
namespace {

constexpr RegionTriangle kGone{{kNone, kNone, kNone}, {kNone, kNone, kNone}, 0};

bool is_in(const std::vector<uint32_t>& list, uint32_t v) {
  return std::find(list.begin(), list.end(), v) != list.end();
}

}  // namespace

double smallest_sine(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double ab = distance_sq(a, b), bc = distance_sq(b, c), ca = distance_sq(c, a);
  const double longer_sq = std::max({ab * bc, bc * ca, ca * ab});  // beside the smallest angle
  return longer_sq > 0 ? length(doubled_area(a, b, c)) / std::sqrt(longer_sq) : 0;
}

EditableMesh::EditableMesh(std::vector<RegionVertex> vertices, std::vector<RegionTriangle> triangles, Size size)
    : vertices_(std::move(vertices)), triangles_(std::move(triangles)) {
  if (size == Size::few) return;
  around_.resize(vertices_.size());
  for (uint32_t t = 0; t < triangles_.size(); ++t)
    if (!triangles_[t].is_gone())
      for (const uint32_t v : triangles_[t].corner) around_[v].push_back(t);
  count_.value = std::count_if(around_.begin(), around_.end(), [](const auto& at) { return !at.empty(); });
}

void EditableMesh::add_vertex(const RegionVertex& v) {
  vertices_.push_back(v);
  if (!around_.empty()) around_.emplace_back();
}

void EditableMesh::drop_last_vertex() {
  vertices_.pop_back();
  if (!around_.empty()) around_.pop_back();
}

void EditableMesh::list_neighbours(uint32_t v, std::vector<uint32_t>& out) const {
  out.clear();
  for_each_around(v, [&](uint32_t t) {
    for (const uint32_t w : triangles_[t].corner)
      if (w != v && !is_in(out, w)) out.push_back(w);
  });
}

void EditableMesh::list_targets(uint32_t v, std::vector<uint32_t>& out) const {
  out.clear();
  if (vertices_[v].kind == RegionVertex::Kind::corner || vertices_[v].is_fixed) return;
  if (vertices_[v].kind == RegionVertex::Kind::free) return list_neighbours(v, out);
  for_each_around(v, [&](uint32_t t) {
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = triangles_[t].corner[i], b = triangles_[t].corner[(i + 1) % 3];
      if (triangles_[t].curve[i] == kNone || (a != v && b != v)) continue;
      if (const uint32_t w = a == v ? b : a; !is_in(out, w)) out.push_back(w);
    }
  });
}

std::optional<uint32_t> EditableMesh::curve_between(uint32_t u, uint32_t v) const {
  std::optional<uint32_t> curve;
  for_each_side(u, v, [&](const Side& s) {
    if (!curve) curve = triangles_[s.triangle].curve[s.edge];
  });
  return curve;
}

CornersOfTriangle EditableMesh::corners(const RegionTriangle& t) const {
  const auto& [a, b, c] = t.corner;
  return {{a, b, c}, {rounded_down(at(a)), rounded_down(at(b)), rounded_down(at(c))}};
}

void EditableMesh::keep_apart(double cell_q8) {
  if (space_) return;
  space_ = std::make_shared<TriangleSpace>(cell_q8, triangles_.size());
  for (uint32_t t = 0; t < triangles_.size(); ++t)
    if (!triangles_[t].is_gone()) space_->put(t, corners(triangles_[t]));
}

/// Of a and b at the ends, c and d opposite.
bool EditableMesh::list_flip(uint32_t triangle, size_t edge, MeshChange& change) const {
  const RegionTriangle& t = triangles_[triangle];
  if (t.is_gone() || t.curve[edge] != kNone) return false;
  const uint32_t a = t.corner[edge], b = t.corner[(edge + 1) % 3], c = t.corner[(edge + 2) % 3];
  const uint32_t other =
      find_around(with_fewer(a, b), [&](const RegionTriangle& s) { return s.edge_between(b, a) < 3; });
  if (other == kNone) return false;
  const RegionTriangle& s = triangles_[other];
  const size_t back = s.edge_between(b, a);
  const uint32_t d = s.corner[(back + 2) % 3];
  if (c == d || s.patch != t.patch) return false;
  if (vertices_[a].is_fixed && vertices_[b].is_fixed) return false;
  if (!vertices_[c].is_inner && !vertices_[d].is_inner) return false;
  change.clear();
  change.replaced.resize(2);
  change.number.resize(2);
  change.replaced[0] = change.number[0] = triangle;
  change.replaced[1] = change.number[1] = other;
  change.made.push_back({{a, d, c}, {s.curve[(back + 1) % 3], kNone, t.curve[(edge + 2) % 3]}, t.patch});
  change.made.push_back({{b, c, d}, {t.curve[(edge + 1) % 3], kNone, s.curve[(back + 2) % 3]}, t.patch});
  return true;
}

/// Whether an edge between two vertices may become one as far as those around tell: they have neighbours in common
/// across their edge only.
bool EditableMesh::may_meet_neighbours(uint32_t gone, uint32_t into, MeshChange& change) const {
  list_neighbours(gone, change.here);
  list_neighbours(into, change.there);
  size_t both = 0, sides = 0;
  for (const uint32_t v : change.here) both += is_in(change.there, v) ? 1 : 0;
  for_each_side(gone, into, [&](const Side&) { ++sides; });
  const bool are_tetrahedra =
      change.here.size() == both + 1 && change.there.size() == both + 1;  // faces would be there twice
  return both == sides && sides > 0 && !are_tetrahedra;
}

/// No two edges on curves become one.
bool EditableMesh::list_collapse(uint32_t gone, uint32_t into, MeshChange& change) const {
  const RegionVertex& from = vertices_[gone];
  if (from.kind == RegionVertex::Kind::corner || from.is_fixed || !from.is_inner || !vertices_[into].is_inner)
    return false;
  if (from.kind == RegionVertex::Kind::on_curve && curve_between(gone, into).value_or(kNone) == kNone) return false;
  if (!may_meet_neighbours(gone, into, change)) return false;
  change.clear();
  bool are_apart = true;
  for_each_side(gone, into, [&](const Side& s) {
    const RegionTriangle& t = triangles_[s.triangle];
    const uint32_t one = t.curve[(s.edge + 1) % 3], other = t.curve[(s.edge + 2) % 3];
    are_apart = are_apart && (one == kNone || other == kNone);
    const uint32_t curve = one != kNone ? one : other;
    if (curve != kNone) change.fused.push_back({into, t.corner[(s.edge + 2) % 3], curve});
  });
  if (!are_apart) return false;
  for_each_around(gone, [&](uint32_t i) {
    change.replaced.push_back(i);
    if (triangles_[i].has(into)) return;
    RegionTriangle& t = change.made.emplace_back(triangles_[i]);
    std::replace(t.corner.begin(), t.corner.end(), gone, into);
    change.number.push_back(i);
  });
  return true;
}

bool EditableMesh::list_split(uint32_t u, uint32_t v, MeshChange& change) const {
  if (!vertices_[u].is_inner && !vertices_[v].is_inner) return false;
  if (vertices_[u].is_fixed && vertices_[v].is_fixed) return false;
  const auto middle = uint32_t(vertices_.size());
  change.clear();
  for_each_side(u, v, [&](const Side& s) {
    RegionTriangle one = triangles_[s.triangle], other = one;
    const size_t next = (s.edge + 1) % 3, last = (s.edge + 2) % 3;
    one.corner[next] = other.corner[s.edge] = middle;
    one.curve[next] = other.curve[last] = kNone;
    change.replaced.push_back(s.triangle);
    change.made.insert(change.made.end(), {one, other});
    change.number.insert(change.number.end(), {s.triangle, kNone});
  });
  return !change.made.empty();
}

void EditableMesh::list_around(uint32_t v, MeshChange& change) const {
  change.clear();
  for_each_around(v, [&](uint32_t t) {
    change.replaced.push_back(t);
    change.made.push_back(triangles_[t]);
  });
  change.number = change.replaced;
}

/// A triangle between three of them could lie on others that are fixed.
bool EditableMesh::has_only_fixed(const RegionTriangle& t) const {
  return std::all_of(t.corner.begin(), t.corner.end(), [&](uint32_t v) { return vertices_[v].is_fixed; });
}

bool EditableMesh::are_free(MeshChange& change) const {
  if (std::any_of(change.made.begin(), change.made.end(), [&](const auto& t) { return has_only_fixed(t); }))
    return false;
  if (!space_) return true;
  change.corners.clear();
  for (const RegionTriangle& t : change.made) change.corners.push_back(corners(t));
  return space_->are_free(change.corners, change.replaced) || space_->meet_no_more(change.corners, change.replaced);
}

void EditableMesh::add(const RegionTriangle& t) {
  triangles_.push_back(kGone);
  replace(uint32_t(triangles_.size() - 1), t);
}

void EditableMesh::remove(uint32_t triangle) { replace(triangle, kGone); }

/// Whether a flip's four corners are the corners of a convex part of a plane on the lattice. What it makes covers what
/// was there, so it meets what that met: no third triangle has the edge that goes, as it is on no curve, and none the
/// edge that comes, which flip() asks.
bool EditableMesh::is_in_plane(const MeshChange& flip) const {
  const auto on_lattice = [&](size_t corner) { return rounded_down(at(flip.made[0].corner[corner])); };
  const PointQ8 a = on_lattice(0), d = on_lattice(1), c = on_lattice(2), b = rounded_down(at(flip.made[1].corner[0]));
  const int axis = best_axis(a, b, c);
  if (axis < 0 || side_of_plane(a, b, c, d) != 0) return false;
  const auto a2 = seen_along(a, axis), b2 = seen_along(b, axis), c2 = seen_along(c, axis), d2 = seen_along(d, axis);
  return turn(a2, b2, c2) * turn(a2, b2, d2) < 0 && turn(c2, d2, a2) * turn(c2, d2, b2) < 0;
}

/// Flips in a plane are made without a look at what is there: faces of a thousand corners have as many triangles beside
/// each of them, and take a thousand flips.
bool EditableMesh::commit_flip(MeshChange& change) {
  const auto is_fixed = [&](const auto& t) { return has_only_fixed(t); };
  if (std::any_of(change.made.begin(), change.made.end(), is_fixed) || !is_in_plane(change)) return commit(change);
  make(change);
  return true;
}

bool EditableMesh::commit(MeshChange& change) {
  if (!are_free(change)) return false;
  make(change);
  return true;
}

void EditableMesh::make(MeshChange& change) {
  for (const uint32_t t : change.replaced)
    if (!is_in(change.number, t)) replace(t, kGone);
  for (size_t i = 0; i < change.made.size(); ++i) {
    uint32_t& number = change.number[i];
    if (number == kNone) {
      number = uint32_t(triangles_.size());
      triangles_.push_back(kGone);
    }
    replace(number, change.made[i]);
  }
  for (const auto& [u, v, curve] : change.fused)
    for_each_side(u, v, [&, on = curve](const Side& s) { triangles_[s.triangle].curve[s.edge] = on; });
}

void EditableMesh::replace(uint32_t triangle, const RegionTriangle& by) {
  RegionTriangle& t = triangles_[triangle];
  if (space_ && !t.is_gone()) space_->take(triangle);
  if (!around_.empty() && t.corner != by.corner) {
    for (size_t i = 0; i < 3 && !t.is_gone(); ++i) {
      std::vector<uint32_t>& around = around_[t.corner[i]];
      around.erase(std::find(around.begin(), around.end(), triangle));
      if (around.empty()) --count_.value;
    }
    for (size_t i = 0; i < 3 && !by.is_gone(); ++i) {
      if (around_[by.corner[i]].empty()) ++count_.value;
      around_[by.corner[i]].push_back(triangle);
    }
  }
  t = by;
  if (space_ && !t.is_gone()) space_->put(triangle, corners(t));
}

}  // namespace isoshell
