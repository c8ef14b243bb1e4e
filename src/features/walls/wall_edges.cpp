// How edges of a WallMesh are collapsed and split (see wall_mesh.h).
#include <algorithm>

#include "features/walls/wall_mesh.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kLeastTurn = 0.5;   ///< cosine between normals of a triangle before and after a change
constexpr double kLeastSine = 0.17;  ///< of the angles of a triangle that a change makes, where it had wider ones

bool has(const RegionTriangle& t, uint32_t v) { return t.corner[0] == v || t.corner[1] == v || t.corner[2] == v; }

RegionTriangle none_at(uint32_t v) { return {{v, v, v}, {kNone, kNone, kNone}, 0}; }

}  // namespace

/// Whether a triangle that replaces another one lies about as that does, and is no needle.
bool WallMesh::may_replace(const RegionTriangle& made, const RegionTriangle& before) const {
  const WorldPoint n = normal(made), m = normal(before);
  if (!(length_sq(n) > 0)) return false;
  if (length_sq(m) > 0 && dot(n, m) < kLeastTurn * length(n) * length(m)) return false;
  const double narrow = sine(made);
  return narrow >= kLeastSine || narrow >= sine(before);
}

/// Whether a triangle looks where the surface does, and is no needle.
bool WallMesh::is_sound(const RegionTriangle& t) const { return cosine_to_surface(t) > 0 && sine(t) >= kLeastSine; }

/// Whether a vertex may be taken into another one as far as kinds, curves and topology tell: the two have neighbours in
/// common across their edge only, and no two edges on curves become one. Lists in `fused` the edges that become one
/// with an edge on a curve.
bool WallMesh::may_collapse(uint32_t gone, uint32_t into, const std::vector<Side>& sides, WallScratch& scratch) const {
  using Kind = RegionVertex::Kind;
  const Kind kind = vertices_[gone].kind;
  if (sides.empty() || kind == Kind::corner || is_kept(gone)) return false;
  if (kind == Kind::on_curve && triangles_[sides[0].triangle].curve[sides[0].edge] == kNone) return false;
  list_neighbours(gone, scratch.here);
  list_neighbours(into, scratch.there);
  size_t both = 0;
  for (const uint32_t v : scratch.here) {
    const bool is_there = std::find(scratch.there.begin(), scratch.there.end(), v) != scratch.there.end();
    both += is_there ? 1 : 0;
    if (is_there || v == into || others_edges_.empty()) continue;
    if (is_of_others(into, v, *curve_between(gone, v))) return false;
  }
  const bool are_tetrahedra =
      scratch.here.size() == both + 1 && scratch.there.size() == both + 1;  // faces would be there twice
  if (both != sides.size() || are_tetrahedra) return false;
  scratch.fused.clear();
  for (const Side& s : sides) {
    const RegionTriangle& t = triangles_[s.triangle];
    const uint32_t one = t.curve[(s.edge + 1) % 3], other = t.curve[(s.edge + 2) % 3];
    if (one != kNone && other != kNone) return false;
    const uint32_t curve = one != kNone ? one : other;
    if (curve != kNone) scratch.fused.push_back({t.corner[(s.edge + 2) % 3], curve});
  }
  return true;
}

bool WallMesh::collapse(uint32_t gone, uint32_t into, WallScratch& scratch, Shapes shapes) {
  if (!may_collapse(gone, into, sides_of(gone, into), scratch)) return false;
  scratch.replaced = around_[gone];
  scratch.made.clear();
  scratch.number.clear();
  for (const uint32_t i : scratch.replaced) {
    if (has(triangles_[i], into)) continue;
    RegionTriangle t = triangles_[i];
    std::replace(t.corner.begin(), t.corner.end(), gone, into);
    if (shapes == Shapes::good ? !may_replace(t, triangles_[i]) : !(cosine_to_surface(t) > 0)) return false;
    scratch.made.push_back(t);
    scratch.number.push_back(i);
  }
  if (!are_free(scratch)) return false;
  for (const uint32_t i : scratch.replaced)
    if (has(triangles_[i], into)) replace(i, none_at(into));
  for (size_t i = 0; i < scratch.made.size(); ++i) replace(scratch.number[i], scratch.made[i]);
  for (const auto& [end, curve] : scratch.fused)
    for (const Side& s : sides_of(into, end)) triangles_[s.triangle].curve[s.edge] = curve;
  return true;
}

bool WallMesh::split(uint32_t u, uint32_t v, const RegionVertex& middle, WallScratch& scratch) {
  if (is_kept(u) && is_kept(v) && curve_between(u, v) != kNone) return false;
  const auto m = uint32_t(vertices_.size());
  vertices_.push_back(middle);
  around_.emplace_back();
  scratch.replaced.clear();
  scratch.made.clear();
  bool may_split = true;
  for (const Side& s : sides_of(u, v)) {
    const RegionTriangle before = triangles_[s.triangle];
    RegionTriangle one = before, other = before;
    const size_t next = (s.edge + 1) % 3, last = (s.edge + 2) % 3;
    one.corner[next] = other.corner[s.edge] = m;
    one.curve[next] = other.curve[last] = kNone;
    may_split = may_split && may_replace(one, before) && may_replace(other, before);
    scratch.made.insert(scratch.made.end(), {one, other});
    scratch.replaced.push_back(s.triangle);
  }
  if (scratch.made.empty() || !may_split || !are_free(scratch)) {
    vertices_.pop_back();
    around_.pop_back();
    return false;
  }
  for (size_t i = 0; i < scratch.replaced.size(); ++i) {
    replace(scratch.replaced[i], scratch.made[2 * i]);
    triangles_.push_back(none_at(m));
    replace(uint32_t(triangles_.size() - 1), scratch.made[2 * i + 1]);
  }
  return true;
}

}  // namespace isoshell
