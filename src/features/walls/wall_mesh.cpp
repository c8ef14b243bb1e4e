// WallMesh (see wall_mesh.h): what it is made of, and what its triangles cost.
#include "features/walls/wall_mesh.h"

#include <algorithm>
#include <cmath>

#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kEnough = 1 - 1. / 1024;  ///< of the cost before, or a change is not made
constexpr double kFollows = 0.9;           ///< cosine between a triangle's normal and the surface's at its corners
constexpr double kCostOfTurn = 4;
constexpr double kMostCostOfWall = 1e6;
constexpr int kRegularInside = 6, kRegularOnCurve = 3;  ///< triangles around a vertex in a patch

PointQ8 steps(const WorldPoint& p) { return {int32_t(p.x), int32_t(p.y), int32_t(p.z)}; }

std::array<uint32_t, 3> ascending(std::array<uint32_t, 3> corners) {
  std::sort(corners.begin(), corners.end());
  return corners;
}

/// Between the edges that there are, on average, and those that there will be: a triangle meets few cells of that size,
/// and few triangles meet a cell.
double cell_between(const FineMesh& fine, const MeshTriangles& triangles, double edge_q8) {
  double sum = 0;
  for (const auto& t : triangles) sum += length(fine.position[t[1]] - fine.position[t[0]]);
  return std::sqrt(sum / double(triangles.size()) * edge_q8);
}

}  // namespace

WallMesh::WallMesh(const CutSurface& cut, const WallTriangles& walls)
    : lookup_(std::make_shared<CutLookup>(cut)),
      space_(cell_between(*cut.fine, walls.triangles, cut.longest_edge_q8), walls.triangles.size()) {
  list_vertices(walls.vertices);
  Edges on_curve;
  for (uint32_t c = 0; c < cut.fine->paths.size(); ++c) list_curve(c, cut.fine->paths[c], on_curve);
  std::sort(on_curve.begin(), on_curve.end());
  list_triangles(walls, on_curve);
}

void WallMesh::list_vertices(size_t count) {
  const CutSurface& cut = lookup_->cut();
  vertices_.resize(count);
  around_.resize(vertices_.size());
  // Where sheets touch at a point, a curve that ends there is on the border of some of them alone: a copy there is
  // home.
  std::vector<char> has_place(vertices_.size(), 0);
  for (size_t c = 0; c < cut.corner.size(); ++c) {
    const uint32_t number = cut.fine->triangles[c / 3][c % 3], copy = cut.corner[c];
    if (number >= count || has_place[number]) continue;
    has_place[number] = cut.place[copy] != kNone;
    vertices_[number].home = copy;
    vertices_[number].position = lookup_->position(copy);
  }
}

/// Sets what is on a curve, and adds its edges.
void WallMesh::list_curve(uint32_t number, const CurvePath& path, Edges& edges) {
  std::vector<uint32_t> along;
  for (size_t i = 0; i < path.vertex.size(); ++i) {
    if (path.vertex[i] >= vertices_.size()) continue;
    along.push_back(path.vertex[i]);
    RegionVertex& v = vertices_[path.vertex[i]];
    const bool is_end = !path.is_loop && (i == 0 || i + 1 == path.vertex.size());
    v.kind = is_end ? RegionVertex::Kind::corner : RegionVertex::Kind::on_curve;
    v.curve = number;
    v.at = i;
  }
  for (size_t i = 1; i < along.size(); ++i) edges.push_back({edge_key(along[i - 1], along[i]), number});
  if (path.is_loop) edges.push_back({edge_key(along.back(), along.front()), number});
}

void WallMesh::list_triangles(const WallTriangles& walls, const Edges& on_curve) {
  const CutSurface& cut = lookup_->cut();
  const std::vector<uint32_t>& source = cut.fine->source_face;
  std::vector<uint32_t> patch_of_face(size_t(*std::max_element(source.begin(), source.end())) + 1);
  for (size_t t = 0; t < source.size(); ++t) patch_of_face[source[t]] = lookup_->patch(cut.corner[3 * t]);
  triangles_.resize(walls.triangles.size());
  for (uint32_t t = 0; t < triangles_.size(); ++t) {
    RegionTriangle made;
    made.corner = walls.triangles[t];
    made.patch = patch_of_face[walls.source_face[t]];
    for (size_t i = 0; i < 3; ++i) {
      const uint64_t key = edge_key(made.corner[i], made.corner[(i + 1) % 3]);
      const auto found = std::lower_bound(on_curve.begin(), on_curve.end(), std::make_pair(key, uint32_t(0)));
      made.curve[i] = found != on_curve.end() && found->first == key ? found->second : kNone;
    }
    triangles_[t].corner.fill(0);  // gone so far
    replace(t, made);
  }
}

CornersOfTriangle WallMesh::corners(const RegionTriangle& t) const {
  return {{t.corner[0], t.corner[1], t.corner[2]},
          {steps(at(t.corner[0])), steps(at(t.corner[1])), steps(at(t.corner[2]))}};
}

void WallMesh::replace(uint32_t triangle, const RegionTriangle& by) {
  RegionTriangle& t = triangles_[triangle];
  if (!t.is_gone()) {
    space_.take(triangle);
    for (const uint32_t v : t.corner) {
      std::vector<uint32_t>& around = around_[v];
      around.erase(std::find(around.begin(), around.end(), triangle));
      count_ -= around.empty() ? 1 : 0;
    }
  }
  t = by;
  if (t.is_gone()) return;
  for (const uint32_t v : t.corner) {
    count_ += around_[v].empty() ? 1 : 0;
    around_[v].push_back(triangle);
  }
  space_.put(triangle, corners(t));
}

void WallMesh::avoid_twins_of(const std::vector<RegionTriangle>& others) {
  const auto is_here = [&](uint32_t v) { return v < vertices_.size(); };
  for (const RegionTriangle& t : others) {
    if (std::all_of(t.corner.begin(), t.corner.end(), is_here)) twins_.push_back(ascending(t.corner));
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t.corner[i], v = t.corner[(i + 1) % 3];
      if (is_here(u) && is_here(v)) others_edges_.push_back({edge_key(u, v), t.curve[i]});
    }
  }
  std::sort(twins_.begin(), twins_.end());
  std::sort(others_edges_.begin(), others_edges_.end());
}

/// Whether an edge on a curve, or off all, would be that of others at another place.
bool WallMesh::is_of_others(uint32_t u, uint32_t v, uint32_t curve) const {
  const auto found =
      std::lower_bound(others_edges_.begin(), others_edges_.end(), std::make_pair(edge_key(u, v), uint32_t(0)));
  return found != others_edges_.end() && found->first == edge_key(u, v) && (curve == kNone || found->second != curve);
}

void WallMesh::avoid(const std::vector<CornersOfTriangle>& others) {
  others_.emplace(lookup_->cut().longest_edge_q8, others.size());
  for (uint32_t i = 0; i < others.size(); ++i) others_->put(i, others[i]);
}

void WallMesh::keep(uint32_t v) {
  is_kept_.resize(vertices_.size(), 0);
  is_kept_[v] = 1;
}

double WallMesh::aimed_at(uint32_t v) const {
  return lookup_->cut().is_requested ? lookup_->edge_length(vertices_[v].home) : 1;
}

void WallMesh::list_neighbours(uint32_t v, std::vector<uint32_t>& out) const {
  out.clear();
  for (const uint32_t t : around_[v])
    for (const uint32_t w : triangles_[t].corner)
      if (w != v && std::find(out.begin(), out.end(), w) == out.end()) out.push_back(w);
}

void WallMesh::list_targets(uint32_t v, std::vector<uint32_t>& out) const {
  if (vertices_[v].kind == RegionVertex::Kind::free) return list_neighbours(v, out);
  out.clear();
  if (is_kept(v) || vertices_[v].kind == RegionVertex::Kind::corner) return;
  for (const uint32_t t : around_[v])
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t a = triangles_[t].corner[i], b = triangles_[t].corner[(i + 1) % 3];
      if (triangles_[t].curve[i] == kNone || (a != v && b != v)) continue;
      const uint32_t w = a == v ? b : a;
      if (std::find(out.begin(), out.end(), w) == out.end()) out.push_back(w);
    }
}

std::vector<WallMesh::Side> WallMesh::sides_of(uint32_t u, uint32_t v) const {
  std::vector<Side> sides;
  for (const uint32_t t : around_[u]) {
    const auto& c = triangles_[t].corner;
    const size_t i = c[0] == u ? 0 : c[1] == u ? 1 : 2;
    if (c[(i + 1) % 3] == v) sides.push_back({t, i});
    if (c[(i + 2) % 3] == v) sides.push_back({t, (i + 2) % 3});
  }
  return sides;
}

std::optional<uint32_t> WallMesh::curve_between(uint32_t u, uint32_t v) const {
  const std::vector<Side> sides = sides_of(u, v);
  if (sides.empty()) return {};
  return triangles_[sides[0].triangle].curve[sides[0].edge];
}

/// What is made, beside what it replaces.
bool WallMesh::are_free(WallScratch& scratch) const {
  scratch.corners.clear();
  for (const RegionTriangle& t : scratch.made) scratch.corners.push_back(corners(t));
  const auto is_twin = [&](const CornersOfTriangle& t) {
    return std::binary_search(twins_.begin(), twins_.end(), ascending({t.id[0], t.id[1], t.id[2]}));
  };
  if (std::any_of(scratch.corners.begin(), scratch.corners.end(), is_twin)) return false;
  return space_.are_free(scratch.corners, scratch.replaced) && (!others_ || others_->are_free(scratch.corners, {}));
}

WorldPoint WallMesh::normal(const RegionTriangle& t) const {
  return doubled_area(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]));
}
double WallMesh::sine(const RegionTriangle& t) const {
  return smallest_sine(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]));
}

/// Between the normal of a triangle and those of the surface at its corners, the least.
double WallMesh::cosine_to_surface(const RegionTriangle& t) const {
  const WorldPoint unit = normalised(normal(t));
  double least = 1;
  for (const uint32_t v : t.corner) least = std::min(least, lookup_->cosine(vertices_[v].home, t.patch, unit));
  return least;
}

double WallMesh::cost(const RegionTriangle& t) const {
  const WorldPoint &a = at(t.corner[0]), &b = at(t.corner[1]), &c = at(t.corner[2]), n = normal(t);
  const double doubled = length(n);
  if (!(doubled > 0)) return kMostCostOfWall;
  const double shape = (distance_sq(a, b) + distance_sq(b, c) + distance_sq(c, a)) / (kTwoRootThree * doubled);
  const double turned = std::max(0., kFollows - cosine_to_surface(t));
  return std::min(kMostCostOfWall, shape - 1 + kCostOfTurn * turned * turned);
}

double WallMesh::cost_around(uint32_t v) const {
  double sum = 0;
  for (const uint32_t t : around_[v]) sum += cost(triangles_[t]);
  return sum;
}

/// The square by which the triangles of a vertex in a patch, and some more, are not as many as in a regular mesh.
double WallMesh::irregularity(uint32_t v, uint32_t patch, int more) const {
  if (vertices_[v].kind == RegionVertex::Kind::corner) return 0;
  const auto in_patch = [&](uint32_t t) { return triangles_[t].patch == patch; };
  const auto count = int(std::count_if(around_[v].begin(), around_[v].end(), in_patch)) + more;
  const int off = count - (vertices_[v].kind == RegionVertex::Kind::free ? kRegularInside : kRegularOnCurve);
  return off * off;
}

bool WallMesh::flip(uint32_t triangle, size_t edge, double cost_of_valence, WallScratch& scratch) {
  const RegionTriangle t = triangles_[triangle];
  if (t.is_gone() || t.curve[edge] != kNone) return false;
  const uint32_t a = t.corner[edge], b = t.corner[(edge + 1) % 3], c = t.corner[(edge + 2) % 3];
  const std::vector<Side> sides = sides_of(a, b);
  if (sides.size() != 2) return false;
  const Side other = sides[sides[0].triangle == triangle ? 1 : 0];
  const RegionTriangle s = triangles_[other.triangle];
  const uint32_t d = s.corner[(other.edge + 2) % 3];
  if (c == d || s.corner[other.edge] != b) return false;
  const RegionTriangle first = {{a, d, c}, {s.curve[(other.edge + 1) % 3], kNone, t.curve[(edge + 2) % 3]}, t.patch};
  const RegionTriangle second = {{b, c, d}, {t.curve[(edge + 1) % 3], kNone, s.curve[(other.edge + 2) % 3]}, t.patch};
  const auto irregular = [&](int at_ends, int beside) {
    return cost_of_valence * (irregularity(a, t.patch, at_ends) + irregularity(b, t.patch, at_ends) +
                              irregularity(c, t.patch, beside) + irregularity(d, t.patch, beside));
  };
  const double before = cost(t) + cost(s), after = cost(first) + cost(second);
  if (after + irregular(-1, 1) >= kEnough * (before + irregular(0, 0))) return false;
  if (after >= before && !(is_sound(first) && is_sound(second))) return false;
  if (!sides_of(c, d).empty() || is_of_others(c, d, kNone)) return false;
  scratch.made.assign({first, second});
  scratch.replaced.assign({triangle, other.triangle});
  if (!are_free(scratch)) return false;
  replace(triangle, first);
  replace(other.triangle, second);
  return true;
}

bool WallMesh::move(uint32_t v, const RegionVertex& to, WallScratch& scratch) {
  const RegionVertex before = vertices_[v];
  const double cost_before = cost_around(v);
  vertices_[v].home = to.home;
  vertices_[v].at = to.at;
  vertices_[v].position = to.position;
  scratch.made.clear();
  for (const uint32_t t : around_[v]) scratch.made.push_back(triangles_[t]);
  scratch.replaced = around_[v];
  if (cost_around(v) >= kEnough * cost_before || !are_free(scratch)) {
    vertices_[v] = before;
    return false;
  }
  for (const uint32_t t : around_[v]) {
    space_.take(t);
    space_.put(t, corners(triangles_[t]));
  }
  return true;
}

}  // namespace isoshell
