// PatchMesh (see patch_mesh.h).
#include "features/angles/patch_mesh.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/copy_product.h"
#include "core/parallel_ranges.h"
#include "features/mesh/mesh_fans.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr int kRings = 2;       ///< of triangles around what is changed
constexpr double kLess = 0.97;  ///< of the cost that a change must leave
constexpr double kLessIfSteady =
    0.5;  ///< of what moves and flips leave, where triangles stay poor in a frame that follows
constexpr double kLeastPart = (1 - kLess) / 3;  ///< of the cost that the triangle itself must have for changes to pay
constexpr int64_t kFewPoor = 3;                 ///< triangles of a region, for which every change is relaxed
constexpr size_t kMostTries = 6;                ///< changes that are relaxed where more are poor
constexpr size_t kFewLeft = 16;  ///< poor triangles of a mesh, for which two changes are tried, one after the other
constexpr int64_t kFewTries = 20000;  ///< that every mesh may take
constexpr double kHopeless = 1.5;     ///< of the least cost so far: a change that is above after a round is given up

/// Along strips narrower than edges all triangles are poor. Where one hardly counts beside the others, changes at its
/// corners do not save what they must, and the others have their own turn.
bool is_among_worse(const MeshRegion& region) {
  return region.poor() > kFewPoor && region.cost_of_first() < kLeastPart * region.cost();
}

std::vector<MeshRegion> cheapest(std::vector<MeshRegion> regions, size_t most) {
  std::stable_sort(regions.begin(), regions.end(),
                   [](const MeshRegion& a, const MeshRegion& b) { return a.cost() < b.cost(); });
  if (regions.size() > most) regions.erase(regions.begin() + int64_t(most), regions.end());
  return regions;
}

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

/// Curves by their ends where they are one segment between corners, ascending: there is one such at most.
using WholeCurves = std::vector<std::pair<uint64_t, uint32_t>>;

WholeCurves whole_curves(const CutSurface& cut) {
  WholeCurves ends;
  for (uint32_t c = 0; c < cut.curves.size(); ++c)
    if (const CutCurve& curve = cut.curves[c]; !curve.is_loop && curve.seeds.size() == 2)
      ends.push_back({edge_key(curve.place.front(), curve.place.back()), c});
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// That two vertices follow each other on.
uint32_t curve_of(const CutSurface& cut, const WholeCurves& ends, const RegionVertex& a, const RegionVertex& b) {
  if (a.kind == RegionVertex::Kind::on_curve) return a.curve;
  if (b.kind == RegionVertex::Kind::on_curve) return b.curve;
  const uint64_t key = edge_key(cut.place[a.home], cut.place[b.home]);
  const auto found = std::lower_bound(ends.begin(), ends.end(), std::make_pair(key, uint32_t(0)));
  return found != ends.end() && found->first == key ? found->second : 0;
}

std::vector<RegionVertex> vertices_of(const CutLookup& lookup, const SeedSet& seeds, const JoinedMesh& joined) {
  std::vector<RegionVertex> vertices(size_t(joined.mesh.position.size()));
  for (int64_t s = seeds.size() - 1; s >= 0; --s) {  // of copies the first counts
    RegionVertex& v = vertices[joined.vertex_of[s]];
    const PointQ8 p = joined.mesh.position[joined.vertex_of[s]];
    v = lookup.vertex_at(seeds.home[s]);
    v.position = {double(p.x), double(p.y), double(p.z)};
    if (s >= seeds.fixed.count) v.kind = RegionVertex::Kind::free;
  }
  return vertices;
}

/// The borders of the open mesh are on curves.
EditableMesh joined_mesh(const CutLookup& lookup, const SeedSet& seeds, const DualMesh& open) {
  const CutSurface& cut = lookup.cut();
  const JoinedMesh joined = join_patches(open, seeds.fixed);
  std::vector<RegionVertex> vertices = vertices_of(lookup, seeds, joined);
  std::vector<RegionTriangle> triangles;
  MeshTriangles corners;  // of the open mesh
  for (const TriangleIndices& i : open.triangles) {
    triangles.push_back({{joined.vertex_of[i.a], joined.vertex_of[i.b], joined.vertex_of[i.c]},
                         {kNone, kNone, kNone},
                         cut.surface.patch.empty() ? 0 : cut.surface.patch[seeds.home[i.a]]});
    corners.push_back({i.a, i.b, i.c});
  }
  const WholeCurves ends = whole_curves(cut);
  for_each_edge(find_edge_sides(corners, size_t(open.position.size())),
                [&](uint32_t, uint32_t, View<const EdgeSide> on_edge) {
                  if (on_edge.size > 1) return;
                  RegionTriangle& t = triangles[on_edge[0].half_edge / 3];
                  const size_t k = on_edge[0].half_edge % 3;
                  t.curve[k] = curve_of(cut, ends, vertices[t.corner[k]], vertices[t.corner[(k + 1) % 3]]);
                });
  return {std::move(vertices), std::move(triangles), EditableMesh::Size::many};
}

}  // namespace

PatchMesh::PatchMesh(const CutSurface& cut, const SeededMesh& made, const JoinOptions& options)
    : PatchMesh(std::make_shared<CutLookup>(cut), made, options) {}

PatchMesh::PatchMesh(const std::shared_ptr<const CutLookup>& lookup, const SeededMesh& made, const JoinOptions& options)
    : PatchMesh(lookup, joined_mesh(*lookup, *OnHost<SeedSet>(made.seeds), *OnHost<DualMesh>(made.mesh)), options) {}

PatchMesh::PatchMesh(std::shared_ptr<const CutLookup> lookup, EditableMesh mesh, const JoinOptions& options)
    : EditableMesh(std::move(mesh)),
      lookup_(std::move(lookup)),
      is_hopeless_(triangles().size(), 0),
      options_(options),
      tries_(options_.tries_per_vertex * std::max(vertex_count(), kFewTries)) {}

std::vector<uint32_t> PatchMesh::poor_triangles() const {
  std::vector<std::pair<double, uint32_t>> found;
  for (uint32_t t = 0; t < triangles().size(); ++t)
    if (const double narrow = sine(triangles()[t]); narrow < kPoorSine) found.push_back({narrow, t});
  std::sort(found.begin(), found.end());
  std::vector<uint32_t> out;
  for (const auto& [narrow, t] : found) out.push_back(t);
  return out;
}

/// The triangles around vertices, and around those of these, and so on; ascending.
std::vector<uint32_t> PatchMesh::triangles_around(std::vector<uint32_t> vertices) const {
  std::vector<uint32_t> triangles;
  for (int ring = 0; ring < kRings; ++ring) {
    for (const uint32_t v : vertices) triangles.insert(triangles.end(), around(v).begin(), around(v).end());
    sort_unique(triangles);
    vertices.clear();
    for (const uint32_t t : triangles)
      vertices.insert(vertices.end(), this->triangles()[t].corner.begin(), this->triangles()[t].corner.end());
    sort_unique(vertices);
  }
  return triangles;
}

/// The vertices asked for come first.
PatchMesh::Cutout PatchMesh::cut_out(const std::vector<uint32_t>& vertices,
                                     const std::vector<uint32_t>& triangles) const {
  std::vector<uint32_t> all;
  for (const uint32_t t : triangles)
    all.insert(all.end(), this->triangles()[t].corner.begin(), this->triangles()[t].corner.end());
  sort_unique(all);
  std::stable_partition(all.begin(), all.end(),
                        [&](uint32_t v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); });
  std::vector<RegionVertex> region_vertices;
  for (const uint32_t v : all) {
    region_vertices.push_back(vertex(v));
    region_vertices.back().number = v;
    region_vertices.back().is_inner = std::all_of(around(v).begin(), around(v).end(), [&](uint32_t t) {
      return std::binary_search(triangles.begin(), triangles.end(), t);
    });
  }
  std::vector<RegionTriangle> region_triangles;
  for (const uint32_t t : triangles) {
    region_triangles.push_back(this->triangles()[t]);
    for (uint32_t& v : region_triangles.back().corner) v = uint32_t(std::find(all.begin(), all.end(), v) - all.begin());
  }
  return {triangles, MeshRegion(*lookup_, std::move(region_vertices), std::move(region_triangles))};
}

std::vector<PatchMesh::Change> PatchMesh::changes_of(const MeshRegion& region, Reach reach) {
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  for (const RegionTriangle& t : region.triangles())
    for (size_t i = 0; i < 3 && !t.is_gone(); ++i) {
      const auto [u, v] = std::minmax(t.corner[i], t.corner[(i + 1) % 3]);
      if ((u < 3) == (reach == Reach::corners)) edges.push_back({u, v});  // the first three are the corners
    }
  sort_unique(edges);
  std::vector<Change> changes;
  for (const auto& [u, v] : edges)
    changes.insert(changes.end(), {{Change::collapse, u, v}, {Change::collapse, v, u}, {Change::split, u, v}});
  return changes;
}

bool PatchMesh::make_change(MeshRegion& region, const Change& change) {
  const WorldPoint &a = region.vertices()[change.u].position, &b = region.vertices()[change.v].position;
  return change.what == Change::split ? region.split(change.u, change.v, 0.5 * (a + b))
                                      : region.collapse(change.u, change.v);
}

/// The region after each change, before anything is moved. Where many triangles are poor, which are searched one by one
/// and share their changes, those that leave the least cost, at the corners.
std::vector<MeshRegion> PatchMesh::promising(const MeshRegion& region, Reach reach) {
  const bool are_few = region.poor() <= kFewPoor;
  std::vector<MeshRegion> made;
  if (reach == Reach::beyond && !are_few) return made;
  for (const Change& change : changes_of(region, reach)) {
    MeshRegion there = region;
    if (!make_change(there, change)) continue;
    there.flip_edges();
    made.push_back(std::move(there));
  }
  const size_t most = are_few ? made.size() : kMostTries;
  return cheapest(std::move(made), most);
}

/// Looks for a better region than the best one so far, a change beyond another one. `made`: takes all of them, where it
/// is asked for.
void PatchMesh::search(const MeshRegion& start, const MeshRegion& from, Reach reach, MeshRegion& best,
                       std::vector<MeshRegion>* made) {
  for (MeshRegion& there : promising(from, reach)) {
    there.relax(kHopeless * best.cost());
    if (there.cost() < best.cost() && there.is_better_than(start)) best = there;
    if (made) made->push_back(std::move(there));
  }
}

/// What moves and flips alone leave, where no triangle is poor then, or the best of what a change more leaves, the
/// nearest ones first; where few triangles of the mesh are poor, of two changes. None where that is not enough.
std::optional<MeshRegion> PatchMesh::improved(const MeshRegion& start) const {
  MeshRegion relaxed = start;
  relaxed.relax();
  if (!relaxed.is_better_than(start)) relaxed = start;
  if (relaxed.poor() == 0) return relaxed;
  const bool is_enough = relaxed.cost() < kLess * start.cost();
  const auto relaxed_if_enough = [&] { return is_enough ? std::make_optional(relaxed) : std::nullopt; };
  if (is_among_worse(start)) return relaxed_if_enough();
  const auto is_worth_it = [&](const MeshRegion& region) {
    const bool may_renumber = !options_.is_steady || region.poor() == 0;
    return region.cost() < (may_renumber ? kLess * start.cost() : kLessIfSteady * relaxed.cost());
  };
  MeshRegion best = relaxed;
  std::vector<MeshRegion> made;
  for (const Reach reach : {Reach::corners, Reach::beyond}) {
    search(start, relaxed, reach, best, are_last_ ? &made : nullptr);
    if (is_worth_it(best)) return best;
  }
  for (const MeshRegion& first : cheapest(std::move(made), kMostTries)) {
    for (const Reach reach : {Reach::corners, Reach::beyond}) search(start, first, reach, best, nullptr);
    if (is_worth_it(best)) return best;
  }
  return relaxed_if_enough();
}

/// Takes out those, in their order, around which no triangle is that is around one before.
std::vector<uint32_t> PatchMesh::take_apart(std::vector<uint32_t>& triangles) const {
  std::vector<char> is_taken(this->triangles().size());
  std::vector<uint32_t> apart, left;
  for (const uint32_t t : triangles) {
    const auto& corner = this->triangles()[t].corner;
    std::vector<uint32_t> around;
    if (!is_taken[t]) around = triangles_around({corner.begin(), corner.end()});
    const bool is_free =
        !is_taken[t] && std::none_of(around.begin(), around.end(), [&](uint32_t u) { return is_taken[u]; });
    (is_free ? apart : left).push_back(t);
    if (!is_free) continue;
    for (const uint32_t u : around) is_taken[u] = 1;
  }
  triangles = std::move(left);
  return apart;
}

bool PatchMesh::improve(std::vector<uint32_t> triangles) {
  keep_apart(lookup_->cut().longest_edge_q8);
  bool has_changed = false;
  const bool were_last = are_last_;
  are_last_ = triangles.size() <= kFewLeft;
  if (are_last_ && !were_last) std::fill(is_hopeless_.begin(), is_hopeless_.end(), char(0));
  while (!triangles.empty()) {
    const auto is_done = [&](uint32_t t) { return sine(this->triangles()[t]) >= kPoorSine || is_hopeless_[t]; };
    triangles.erase(std::remove_if(triangles.begin(), triangles.end(), is_done), triangles.end());
    std::vector<uint32_t> apart = take_apart(triangles);
    if (int64_t(apart.size()) > tries_) {
      left_alone_ = int64_t(apart.size() + triangles.size()) - tries_;
      apart.resize(size_t(tries_));
      triangles.clear();
    }
    tries_ -= int64_t(apart.size());
    std::vector<std::optional<Cutout>> cutouts(apart.size());
    std::vector<std::optional<MeshRegion>> better(apart.size());
    for_each_index(size_t(0), apart.size(), [&](size_t i) {
      const auto& corner = this->triangles()[apart[i]].corner;
      const std::vector<uint32_t> corners(corner.begin(), corner.end());
      cutouts[i] = cut_out(corners, triangles_around(corners));
      better[i] = improved(cutouts[i]->region);
    });
    for (size_t i = 0; i < apart.size(); ++i) {
      if (better[i] && put_back(*cutouts[i], *better[i])) {
        has_changed = true;
        continue;
      }
      is_hopeless_[apart[i]] = 1;
    }
  }
  return has_changed;
}

JoinedPatches PatchMesh::joined() const {
  std::vector<uint32_t> number(vertices().size(), kNone);
  JoinedPatches out;
  out.left_alone = left_alone_;
  out.mesh.position = Buffer<PointQ8>(vertex_count());
  out.home = Buffer<uint32_t>(vertex_count());
  uint32_t count = 0;
  for (uint32_t v = 0; v < vertices().size(); ++v) {
    if (around(v).empty()) continue;
    out.mesh.position[count] = rounded_down(at(v));
    out.home[count] = vertex(v).home;
    if (vertex(v).kind == RegionVertex::Kind::corner) out.features.corners.push_back(count);
    out.on_curves += vertex(v).kind != RegionVertex::Kind::free ? 1 : 0;
    number[v] = count++;
  }
  std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> triangles;
  for (const RegionTriangle& t : this->triangles()) {
    if (t.is_gone()) continue;
    std::array<uint32_t, 3> i{number[t.corner[0]], number[t.corner[1]], number[t.corner[2]]};
    for (size_t k = 0; k < 3; ++k)
      if (t.curve[k] != kNone)
        out.features.curve_edges.push_back({{std::min(i[k], i[(k + 1) % 3]), std::max(i[k], i[(k + 1) % 3])},
                                            lookup_->cut().curves[t.curve[k]].curve});
    std::rotate(i.begin(), std::min_element(i.begin(), i.end()), i.end());
    triangles.push_back({i, t.patch});
  }
  std::sort(triangles.begin(), triangles.end());
  out.mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  for (size_t t = 0; t < triangles.size(); ++t) {
    const auto& [corner, patch] = triangles[t];
    out.mesh.triangles[int64_t(t)] = {corner[0], corner[1], corner[2]};
    out.features.patch.push_back(patch);
  }
  std::vector<MeshCurveEdge>& edges = out.features.curve_edges;  // so far once for each of their triangles
  const auto key = [](const MeshCurveEdge& e) { return std::tie(e.vertex, e.curve); };
  std::sort(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  edges.erase(std::unique(edges.begin(), edges.end(), [&](const auto& a, const auto& b) { return key(a) == key(b); }),
              edges.end());
  return out;
}

}  // namespace isoshell
