// WallMesh (see wall_mesh.h): what it is made of, and what its triangles cost.
#include "features/walls/wall_mesh.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <utility>

#include "features/cutting/curve_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

using Kind = RegionVertex::Kind;

constexpr double kFollows = 0.9;  ///< cosine between a triangle's normal and the surface's at its corners
constexpr double kCostOfTurn = 4;
constexpr int kRegularInside = 6, kRegularOnCurve = 3;  ///< triangles around a vertex in a patch
constexpr double kLeastTurn = 0.5;                      ///< cosine between normals before and after a change
constexpr double kLeastSine = 0.17;  ///< of the angles of a triangle that a change makes, where it had wider ones

/// Between the edges that there are, on average, and those that there will be: a triangle meets few cells of that size,
/// and few triangles meet a cell.
double cell_between(const EditableMesh& mesh, double edge_q8) {
  double sum = 0, count = 0;
  for (const RegionTriangle& t : mesh.triangles()) {
    if (t.is_gone()) continue;
    sum += length(mesh.at(t.corner[1]) - mesh.at(t.corner[0]));
    ++count;
  }
  return std::sqrt(sum / std::max(count, 1.) * edge_q8);
}

std::vector<RegionVertex> vertices_of(const CutLookup& lookup, size_t count) {
  const CutSurface& cut = lookup.cut();
  std::vector<RegionVertex> vertices(count);
  // Where sheets touch at a point, a curve that ends there is on the border of some of them alone: a copy there is
  // home.
  std::vector<char> has_place(count, 0);
  for (size_t c = 0; c < cut.corner.size(); ++c) {
    const uint32_t number = cut.fine->triangles[c / 3][c % 3], copy = cut.corner[c];
    if (number >= count || has_place[number]) continue;
    has_place[number] = cut.place[copy] != kNone;
    vertices[number] = lookup.vertex_at(copy);
  }
  return vertices;
}

std::vector<RegionTriangle> triangles_of(const CutLookup& lookup, const WallTriangles& walls) {
  const CutSurface& cut = lookup.cut();
  std::vector<uint32_t> becomes(cut.fine->position.size(), kNone);
  std::iota(becomes.begin(), becomes.begin() + int64_t(walls.vertices), 0u);
  const CurveEdges edges = curve_edges(cut.fine->paths, becomes);
  const std::vector<uint32_t>& source = cut.fine->source_face;
  std::vector<uint32_t> patch_of_face(size_t(*std::max_element(source.begin(), source.end())) + 1);
  for (size_t t = 0; t < source.size(); ++t) patch_of_face[source[t]] = lookup.patch(cut.corner[3 * t]);
  std::vector<RegionTriangle> out(walls.triangles.size());
  for (size_t t = 0; t < out.size(); ++t) {
    out[t].corner = walls.triangles[t];
    out[t].patch = patch_of_face[walls.source_face[t]];
    for (size_t i = 0; i < 3; ++i) out[t].curve[i] = curve_of(edges, out[t].corner[i], out[t].corner[(i + 1) % 3]);
  }
  return out;
}

}  // namespace

WallMesh::WallMesh(const CutSurface& cut, const WallTriangles& walls)
    : WallMesh(std::make_shared<CutLookup>(cut), walls) {}

WallMesh::WallMesh(const std::shared_ptr<const CutLookup>& lookup, const WallTriangles& walls)
    : WallMesh(lookup, EditableMesh(vertices_of(*lookup, walls.vertices), triangles_of(*lookup, walls), Size::many)) {}

WallMesh::WallMesh(std::shared_ptr<const CutLookup> lookup, EditableMesh mesh)
    : EditableMesh(std::move(mesh)), lookup_(std::move(lookup)) {
  if (lookup_->cut().regions) labels_ = labels_of_patches(lookup_->cut());
  keep_apart(cell_between(*this, lookup_->cut().longest_edge_q8));
}

double WallMesh::aimed_at(uint32_t v) const {
  return lookup_->cut().is_requested ? lookup_->edge_length(vertex(v).home) : 1;
}

double WallMesh::cost(const RegionTriangle& t) const {
  const WorldPoint &a = at(t.corner[0]), &b = at(t.corner[1]), &c = at(t.corner[2]);
  const double doubled = length(normal(t));
  if (!(doubled > 0)) return kMostCost;
  const double shape = (distance_sq(a, b) + distance_sq(b, c) + distance_sq(c, a)) / (kTwoRootThree * doubled);
  const double turned = std::max(0., kFollows - lookup_->cosine(*this, t));
  return std::min(kMostCost, shape - 1 + kCostOfTurn * turned * turned);
}

double WallMesh::cost_around(uint32_t v) const {
  double sum = 0;
  for (const uint32_t t : around(v)) sum += cost(triangles()[t]);
  return sum;
}

/// The square by which the triangles of a vertex in a patch, and some more, are not as many as in a regular mesh.
double WallMesh::irregularity(uint32_t v, uint32_t patch, int more) const {
  if (vertex(v).kind == Kind::corner) return 0;
  const auto in_patch = [&](uint32_t t) { return triangles()[t].patch == patch; };
  const auto count = int(std::count_if(around(v).begin(), around(v).end(), in_patch)) + more;
  const int off = count - (vertex(v).kind == Kind::free ? kRegularInside : kRegularOnCurve);
  return off * off;
}

/// Whether a triangle that replaces another one lies about as that does, and is no needle, or a short one.
bool WallMesh::may_replace(const RegionTriangle& made, const RegionTriangle& before, double short_sq_q8) const {
  const WorldPoint n = normal(made), m = normal(before);
  if (!(length_sq(n) > 0)) return false;
  if (length_sq(m) > 0 && dot(n, m) < kLeastTurn * length(n) * length(m)) return false;
  const double narrow = sine(made);
  if (narrow >= kLeastSine || narrow >= sine(before)) return true;
  const auto& [a, b, c] = made.corner;
  return std::max({distance_sq(at(a), at(b)), distance_sq(at(b), at(c)), distance_sq(at(c), at(a))}) < short_sq_q8;
}

/// Whether a triangle looks where the surface does, and is no needle.
bool WallMesh::is_sound(const RegionTriangle& t) const {
  return lookup_->cosine(*this, t) > 0 && sine(t) >= kLeastSine;
}

bool WallMesh::collapse(uint32_t gone, uint32_t into, MeshChange& change, Shapes shapes, double short_square) {
  const double short_sq_q8 = short_square * aimed_at(into) * aimed_at(into);
  return EditableMesh::collapse(gone, into, change, [&] {
    for (size_t i = 0; i < change.made.size(); ++i) {
      const RegionTriangle& made = change.made[i];
      if (shapes == Shapes::good ? !may_replace(made, triangles()[change.number[i]], short_sq_q8)
                                 : !(lookup_->cosine(*this, made) > 0))
        return false;
    }
    return keeps_sheets_in_order(*this, change, labels_);
  });
}

bool WallMesh::split(uint32_t u, uint32_t v, const RegionVertex& middle, MeshChange& change) {
  return EditableMesh::split(u, v, middle, change, [&] {
    for (size_t i = 0; i < change.made.size(); ++i)
      if (!may_replace(change.made[i], triangles()[change.replaced[i / 2]], 0)) return false;
    return keeps_sheets_in_order(*this, change, labels_);
  });
}

bool WallMesh::flip(uint32_t triangle, size_t edge, double cost_of_valence, MeshChange& change) {
  return EditableMesh::flip(triangle, edge, change, [&] {
    const RegionTriangle &first = change.made[0], &second = change.made[1];
    const auto irregular = [&](int at_ends, int beside) {
      return cost_of_valence *
             (irregularity(first.corner[0], first.patch, at_ends) +
              irregularity(second.corner[0], first.patch, at_ends) +
              irregularity(first.corner[2], first.patch, beside) + irregularity(first.corner[1], first.patch, beside));
    };
    const double before = cost(triangles()[change.replaced[0]]) + cost(triangles()[change.replaced[1]]);
    const double after = cost(first) + cost(second);
    if (after + irregular(-1, 1) >= kEnough * (before + irregular(0, 0))) return false;
    return (after < before || (is_sound(first) && is_sound(second))) && keeps_sheets_in_order(*this, change, labels_);
  });
}

bool WallMesh::move(uint32_t v, const RegionVertex& to, MeshChange& change) {
  const double before = cost_around(v);
  return EditableMesh::move(
      v, to, change, [&] { return cost_around(v) < kEnough * before && are_sheets_in_order(*this, change, labels_); });
}

}  // namespace isoshell
