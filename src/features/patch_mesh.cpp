// PatchMesh (see patch_mesh.h).
#include "features/patch_mesh.h"

#include <algorithm>
#include <limits>
#include <tuple>

#include "core/copy_product.h"
#include "core/parallel_ranges.h"
#include "features/mesh_fans.h"
#include "isoshell/voxel_set.h"

namespace isoshell {
namespace {

constexpr int kRings = 2;                  ///< of triangles around what is changed
constexpr double kLess = 0.97;             ///< of the cost that a change must leave
constexpr double kMuchLess = 0.8;          ///< where more triangles are poor then
constexpr double kMostPerCount = 1. / 64;  ///< cost that a change may bring that only keeps the count
constexpr int64_t kMostTriesPerCount = 64;

template <class T>
void sort_unique(std::vector<T>& values) {
  std::sort(values.begin(), values.end());
  values.erase(std::unique(values.begin(), values.end()), values.end());
}

}  // namespace

PatchMesh::PatchMesh(const CutSurface& cut, const SeededMesh& made) : cut_(&cut) {
  const OnHost<SeedSet> seeds(made.seeds);
  const OnHost<DualMesh> open(made.mesh);
  const JoinedMesh joined = join_patches(*open, seeds->fixed);
  vertices_.resize(size_t(joined.mesh.position.size()));
  around_.resize(vertices_.size());
  for (uint32_t c = 0; c < cut.curves.size(); ++c)
    if (const CutCurve& curve = cut.curves[c]; !curve.is_loop && curve.seeds.size() == 2)
      ends_.push_back({edge_key(curve.place.front(), curve.place.back()), c});
  std::sort(ends_.begin(), ends_.end());
  list_vertices(*seeds, joined);
  list_triangles(*open, *seeds, joined);
  for (std::vector<char>& is_hopeless : is_hopeless_) is_hopeless.assign(triangles_.size(), 0);
  first_count_ = count_ = int64_t(vertices_.size());
}

void PatchMesh::list_vertices(const SeedSet& seeds, const JoinedMesh& joined) {
  std::vector<std::pair<uint32_t, size_t>> on_curve(cut_->copies_first.size() - 1, {kNone, 0});  // per place
  for (uint32_t c = 0; c < cut_->curves.size(); ++c)
    for (size_t i = 0; i < cut_->curves[c].place.size(); ++i) on_curve[cut_->curves[c].place[i]] = {c, i};
  for (int64_t s = seeds.size() - 1; s >= 0; --s) {  // of copies the first counts
    RegionVertex& v = vertices_[joined.vertex_of[s]];
    const PointQ8 p = joined.mesh.position[joined.vertex_of[s]];
    v.position = {double(p.x), double(p.y), double(p.z)};
    v.home = seeds.home[s];
    v.number = joined.vertex_of[s];
    const uint32_t place = s < seeds.fixed.count ? cut_->place[v.home] : kNone;
    if (place == kNone) continue;
    v.kind = place < cut_->corner_count ? RegionVertex::Kind::corner : RegionVertex::Kind::on_curve;
    std::tie(v.curve, v.at) = on_curve[place];
  }
}

void PatchMesh::list_triangles(const DualMesh& open, const SeedSet& seeds, const JoinedMesh& joined) {
  MeshTriangles corners;  // of the open mesh
  for (const TriangleIndices& i : open.triangles) {
    RegionTriangle made;
    made.corner = {joined.vertex_of[i.a], joined.vertex_of[i.b], joined.vertex_of[i.c]};
    made.curve = {kNone, kNone, kNone};
    made.patch = cut_->surface.patch.empty() ? 0 : cut_->surface.patch[seeds.home[i.a]];
    for (const uint32_t v : made.corner) around_[v].push_back(uint32_t(triangles_.size()));
    triangles_.push_back(made);
    corners.push_back({i.a, i.b, i.c});
  }
  const std::vector<ListedHalfEdge> sides = sorted_half_edges(corners);
  for (size_t i = 0; i < sides.size(); ++i) {
    const bool has_twin =
        (i > 0 && sides[i - 1].edge == sides[i].edge) || (i + 1 < sides.size() && sides[i + 1].edge == sides[i].edge);
    if (has_twin) continue;
    RegionTriangle& t = triangles_[sides[i].number / 3];
    const size_t k = sides[i].number % 3;
    t.curve[k] = curve_between(t.corner[k], t.corner[(k + 1) % 3]);
  }
}

/// That two vertices follow each other on.
uint32_t PatchMesh::curve_between(uint32_t u, uint32_t v) const {
  const RegionVertex &a = vertices_[u], &b = vertices_[v];
  if (a.kind == RegionVertex::Kind::on_curve) return a.curve;
  if (b.kind == RegionVertex::Kind::on_curve) return b.curve;
  return whole_curve(cut_->place[a.home], cut_->place[b.home]);
}

/// From one corner to another in one segment: there is one such at most.
uint32_t PatchMesh::whole_curve(uint32_t from, uint32_t to) const {
  const auto found = std::lower_bound(ends_.begin(), ends_.end(), std::make_pair(edge_key(from, to), uint32_t(0)));
  return found != ends_.end() && found->first == edge_key(from, to) ? found->second : 0;
}

double PatchMesh::sine_of(uint32_t triangle) const {
  const RegionTriangle& t = triangles_[triangle];
  if (is_gone(t)) return 1;
  return smallest_sine(vertices_[t.corner[0]].position, vertices_[t.corner[1]].position,
                       vertices_[t.corner[2]].position);
}

bool PatchMesh::is_edge(uint32_t u, uint32_t v) const {
  return std::any_of(around_[u].begin(), around_[u].end(), [&](uint32_t t) {
    const auto& c = triangles_[t].corner;
    return std::find(c.begin(), c.end(), v) != c.end();
  });
}

std::vector<uint32_t> PatchMesh::poor_triangles() const {
  std::vector<std::pair<double, uint32_t>> found;
  for (uint32_t t = 0; t < triangles_.size(); ++t)
    if (const double sine = sine_of(t); sine < kPoorSine) found.push_back({sine, t});
  std::sort(found.begin(), found.end());
  std::vector<uint32_t> out;
  for (const auto& [sine, t] : found) out.push_back(t);
  return out;
}

/// The triangles around vertices, and around those of these, and so on; ascending.
std::vector<uint32_t> PatchMesh::triangles_around(std::vector<uint32_t> vertices) const {
  std::vector<uint32_t> triangles;
  for (int ring = 0; ring < kRings; ++ring) {
    for (const uint32_t v : vertices) triangles.insert(triangles.end(), around_[v].begin(), around_[v].end());
    sort_unique(triangles);
    vertices.clear();
    for (const uint32_t t : triangles)
      vertices.insert(vertices.end(), triangles_[t].corner.begin(), triangles_[t].corner.end());
    sort_unique(vertices);
  }
  return triangles;
}

/// The vertices asked for come first.
PatchMesh::Cutout PatchMesh::cut_out(const std::vector<uint32_t>& vertices,
                                     const std::vector<uint32_t>& triangles) const {
  std::vector<uint32_t> all;
  for (const uint32_t t : triangles) all.insert(all.end(), triangles_[t].corner.begin(), triangles_[t].corner.end());
  sort_unique(all);
  std::stable_partition(all.begin(), all.end(),
                        [&](uint32_t v) { return std::find(vertices.begin(), vertices.end(), v) != vertices.end(); });
  std::vector<RegionVertex> region_vertices;
  for (const uint32_t v : all) {
    region_vertices.push_back(vertices_[v]);
    region_vertices.back().number = v;
    region_vertices.back().is_inner =
        std::includes(triangles.begin(), triangles.end(), around_[v].begin(), around_[v].end());
  }
  std::vector<RegionTriangle> region_triangles;
  for (const uint32_t t : triangles) {
    region_triangles.push_back(triangles_[t]);
    for (uint32_t& v : region_triangles.back().corner) v = uint32_t(std::find(all.begin(), all.end(), v) - all.begin());
  }
  return {triangles, MeshRegion(*cut_, std::move(region_vertices), std::move(region_triangles))};
}

/// Nothing but moves and flips, or a split or collapse of an edge.
std::vector<PatchMesh::Change> PatchMesh::changes_of(const MeshRegion& region, Reach reach) {
  std::vector<std::pair<uint32_t, uint32_t>> edges;
  for (const RegionTriangle& t : region.triangles())
    for (size_t i = 0; i < 3; ++i) {
      const auto [u, v] = std::minmax(t.corner[i], t.corner[(i + 1) % 3]);
      if (u < 3 || reach == Reach::rings) edges.push_back({u, v});  // the first three are the corners
    }
  sort_unique(edges);
  std::vector<Change> changes{{Change::relax, 0, 0}};
  for (const auto& [u, v] : edges)
    changes.insert(changes.end(), {{Change::collapse, u, v}, {Change::collapse, v, u}, {Change::split, u, v}});
  return changes;
}

bool PatchMesh::apply(MeshRegion& region, const Change& change) {
  const WorldPoint &a = region.vertices()[change.u].position, &b = region.vertices()[change.v].position;
  if (change.what == Change::split && !region.split(change.u, change.v, 0.5 * (a + b))) return false;
  if (change.what == Change::collapse && !region.collapse(change.u, change.v)) return false;
  region.relax();
  return true;
}

/// Infinite where the change cannot be made, makes the smallest angle smaller, or leaves more poor triangles that are
/// not much better.
double PatchMesh::cost_after(const MeshRegion& start, const Change& change) {
  MeshRegion region = start;
  if (!apply(region, change)) return std::numeric_limits<double>::infinity();
  const double cost = region.cost();
  const bool is_better = region.poor() <= start.poor() || cost < kMuchLess * start.cost();
  return is_better && region.worst_sine() >= start.worst_sine() ? cost : std::numeric_limits<double>::infinity();
}

MeshRegion PatchMesh::changed(MeshRegion region, const Change& change) {
  apply(region, change);
  return region;
}

std::optional<PatchMesh::Change> PatchMesh::best_change(const MeshRegion& start, Reach reach) {
  const std::vector<Change> changes = changes_of(start, reach);
  std::vector<double> cost(changes.size());
  for_each_index(size_t(0), changes.size(), [&](size_t i) { cost[i] = cost_after(start, changes[i]); });
  const auto least = size_t(std::min_element(cost.begin(), cost.end()) - cost.begin());
  if (cost[least] >= kLess * start.cost()) return {};
  return changes[least];
}

/// Takes out those, in their order, around which no triangle is that is around one before.
std::vector<uint32_t> PatchMesh::take_apart(std::vector<uint32_t>& triangles) const {
  std::vector<char> is_taken(triangles_.size());
  std::vector<uint32_t> apart, left;
  for (const uint32_t t : triangles) {
    const auto& corner = triangles_[t].corner;
    const std::vector<uint32_t> around = triangles_around({corner.begin(), corner.end()});
    const bool is_free = std::none_of(around.begin(), around.end(), [&](uint32_t u) { return is_taken[u]; });
    for (const uint32_t u : around) is_taken[u] = 1;
    (is_free ? apart : left).push_back(t);
  }
  triangles = std::move(left);
  return apart;
}

bool PatchMesh::improve(std::vector<uint32_t> triangles, Reach reach) {
  std::vector<char>& is_hopeless = is_hopeless_[size_t(reach)];
  bool has_changed = false;
  while (!triangles.empty()) {
    const auto is_done = [&](uint32_t t) { return sine_of(t) >= kPoorSine || is_hopeless[t]; };
    triangles.erase(std::remove_if(triangles.begin(), triangles.end(), is_done), triangles.end());
    const std::vector<uint32_t> apart = take_apart(triangles);
    std::vector<Cutout> cutouts;
    for (const uint32_t t : apart) {
      const std::vector<uint32_t> corners(triangles_[t].corner.begin(), triangles_[t].corner.end());
      cutouts.push_back(cut_out(corners, triangles_around(corners)));
    }
    std::vector<std::optional<Change>> best(apart.size());
    for_each_index(size_t(0), apart.size(), [&](size_t i) { best[i] = best_change(cutouts[i].region, reach); });
    for (size_t i = 0; i < apart.size(); ++i) {
      if (best[i])
        put_back(cutouts[i], changed(cutouts[i].region, *best[i]));
      else
        is_hopeless[apart[i]] = 1;
      has_changed = has_changed || best[i];
    }
  }
  return has_changed;
}

/// Each edge that is on no curve, by its length beside the one aimed at there.
std::vector<std::pair<double, uint64_t>> PatchMesh::edges_by_length() const {
  const EdgeLengths& lengths = cut_->surface.lengths;
  std::vector<std::pair<double, uint64_t>> out;
  for (const RegionTriangle& t : triangles_)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t.corner[i], v = t.corner[(i + 1) % 3];
      if (u >= v || t.curve[i] != kNone) continue;
      const double aimed_at =
          lengths.at.empty() ? 1 : double(lengths.at[vertices_[u].home]) + double(lengths.at[vertices_[v].home]);
      out.push_back(
          {distance_sq(vertices_[u].position, vertices_[v].position) / (aimed_at * aimed_at), edge_key(u, v)});
    }
  std::sort(out.begin(), out.end());
  return out;
}

bool PatchMesh::meet_count() {
  while (surplus() != 0) {
    const int64_t before = surplus();
    const auto what = before > 0 ? Change::collapse : Change::split;
    std::vector<std::pair<double, uint64_t>> edges = edges_by_length();
    if (before < 0) std::reverse(edges.begin(), edges.end());
    int64_t tries = kMostTriesPerCount * std::abs(before);
    for (size_t i = 0; i < edges.size() && surplus() != 0 && tries > 0; ++i) {
      const auto u = uint32_t(edges[i].second >> 32), v = uint32_t(edges[i].second);
      if (!is_edge(u, v)) continue;
      --tries;
      const Cutout cutout = cut_out({u, v}, triangles_around({u, v}));
      const Change there = {what, 0, 1}, back = {what, 1, 0};
      const double cost = cost_after(cutout.region, there), cost_back = cost_after(cutout.region, back);
      if (std::min(cost, cost_back) <= cutout.region.cost() + kMostPerCount)
        put_back(cutout, changed(cutout.region, cost <= cost_back ? there : back));
    }
    if (surplus() == before) return false;
  }
  return true;
}

void PatchMesh::put_back(const Cutout& cutout, const MeshRegion& region) {
  std::vector<uint32_t> number;
  for (const RegionVertex& v : region.vertices()) {
    if (v.number == RegionVertex::kNoOne) {
      number.push_back(uint32_t(vertices_.size()));
      vertices_.push_back(v);
      around_.emplace_back();
    } else {
      number.push_back(v.number);
      vertices_[v.number] = v;
    }
    vertices_[number.back()].number = number.back();
  }
  for (const uint32_t t : cutout.triangles) {
    for (const uint32_t v : triangles_[t].corner) around_[v].erase(std::find(around_[v].begin(), around_[v].end(), t));
    triangles_[t].corner = {0, 0, 0};
    for (std::vector<char>& is_hopeless : is_hopeless_) is_hopeless[t] = 0;
  }
  for (size_t i = 0; i < region.triangles().size(); ++i) {
    const bool is_new = i >= cutout.triangles.size();
    const uint32_t t = is_new ? uint32_t(triangles_.size()) : cutout.triangles[i];
    if (is_new) {
      triangles_.emplace_back();
      for (std::vector<char>& is_hopeless : is_hopeless_) is_hopeless.push_back(0);
    }
    triangles_[t] = region.triangles()[i];
    for (uint32_t& v : triangles_[t].corner) v = number[v];
    for (const uint32_t v : triangles_[t].corner) {
      auto& around = around_[v];
      around.insert(std::lower_bound(around.begin(), around.end(), t), t);
    }
  }
  count_ += int64_t(region.vertices().size()) - int64_t(cutout.region.vertices().size());
  count_ -= std::count_if(number.begin(), number.end(), [&](uint32_t v) { return around_[v].empty(); });
}

JoinedPatches PatchMesh::joined() const {
  std::vector<uint32_t> number(vertices_.size(), kNone);
  JoinedPatches out;
  out.mesh.position = Buffer<PointQ8>(count_);
  out.home = Buffer<uint32_t>(count_);
  uint32_t count = 0;
  for (size_t v = 0; v < vertices_.size(); ++v) {
    if (around_[v].empty()) continue;
    const WorldPoint& p = vertices_[v].position;
    out.mesh.position[count] = {int32_t(p.x), int32_t(p.y), int32_t(p.z)};
    out.home[count] = vertices_[v].home;
    if (vertices_[v].kind == RegionVertex::Kind::corner) out.features.corners.push_back(count);
    out.on_curves += vertices_[v].kind != RegionVertex::Kind::free ? 1 : 0;
    number[v] = count++;
  }
  std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> triangles;
  for (const RegionTriangle& t : triangles_) {
    if (is_gone(t)) continue;
    std::array<uint32_t, 3> i{number[t.corner[0]], number[t.corner[1]], number[t.corner[2]]};
    for (size_t k = 0; k < 3; ++k)
      if (t.curve[k] != kNone)
        out.features.curve_edges.push_back(
            {{std::min(i[k], i[(k + 1) % 3]), std::max(i[k], i[(k + 1) % 3])}, cut_->curves[t.curve[k]].curve});
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
