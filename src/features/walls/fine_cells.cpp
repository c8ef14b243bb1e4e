// FineCells (see fine_cells.h).
#include "features/walls/fine_cells.h"

#include <algorithm>
#include <tuple>
#include <utility>

#include "features/cutting/curve_edges.h"
#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

using Corners = std::array<uint32_t, 3>;

Corners from_smallest(Corners c) {
  std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
  return c;
}

bool has_area(const Corners& c) { return c[0] != c[1] && c[1] != c[2] && c[2] != c[0]; }

RegionTriangle on_curves(const CurveEdges& edges, const Corners& c, uint32_t patch) {
  return {c, {curve_of(edges, c[0], c[1]), curve_of(edges, c[1], c[2]), curve_of(edges, c[2], c[0])}, patch};
}

}  // namespace

FineCells::FineCells(const CutSurface& cut, const SeededMesh& made, const PatchMesh& relaxed,
                     const std::vector<TriangleIndices>& dual, const std::vector<uint32_t>& cell,
                     const std::vector<char>& is_optimized)
    : cut_(cut), relaxed_(relaxed), is_optimized_(is_optimized), seed_(cell), is_fine_(relaxed.vertices().size(), 0) {
  const JoinedMesh joined = join_patches(made.mesh, made.seeds.fixed);
  joined_.assign(joined.vertex_of.begin(), joined.vertex_of.end());
  for (uint32_t& s : seed_) s = joined_[s];
  list_changed(made, dual);
  group_changed();
}

/// Triangles of both meshes that are not in the other one.
void FineCells::list_changed(const SeededMesh& made, const std::vector<TriangleIndices>& dual) {
  std::vector<Changed> all;
  for (const RegionTriangle& t : relaxed_.triangles())
    if (!t.is_gone()) all.push_back({from_smallest(t.corner), 0, t.patch, true});
  for (const TriangleIndices& t : dual)
    all.push_back({from_smallest({joined_[t.a], joined_[t.b], joined_[t.c]}), 0,
                   cut_.surface.patch[made.seeds.home[t.a]], false});
  std::sort(all.begin(), all.end(), [](const Changed& a, const Changed& b) {
    return std::tie(a.corner, a.patch, a.is_relaxed) < std::tie(b.corner, b.patch, b.is_relaxed);
  });
  for (size_t i = 0; i < all.size(); ++i) {
    const bool is_in_both = i + 1 < all.size() && all[i].corner == all[i + 1].corner &&
                            all[i].patch == all[i + 1].patch && all[i].is_relaxed != all[i + 1].is_relaxed;
    if (is_in_both)
      ++i;
    else
      changed_.push_back(all[i]);
  }
}

/// Where they share an edge, one set of triangles fills what the other one does.
void FineCells::group_changed() {
  std::vector<std::pair<uint64_t, uint32_t>> edges;
  std::vector<uint32_t> parent(changed_.size());
  for (uint32_t i = 0; i < changed_.size(); ++i) {
    parent[i] = i;
    const Corners& c = changed_[i].corner;
    for (size_t k = 0; k < 3; ++k) edges.push_back({edge_key(c[k], c[(k + 1) % 3]), i});
  }
  std::sort(edges.begin(), edges.end());
  const View<uint32_t> sets{parent.data(), int64_t(parent.size())};
  for (size_t i = 1; i < edges.size(); ++i)
    if (edges[i].first == edges[i - 1].first) join(sets, edges[i].second, edges[i - 1].second);
  for (uint32_t i = 0; i < changed_.size(); ++i) changed_[i].group = find_root(sets, i);
}

void FineCells::add(const std::vector<uint32_t>& seeds) {
  std::vector<char> is_added(is_fine_.size(), 0);
  for (const uint32_t s : seeds) is_added[s] = 1;
  std::vector<char> is_beside = is_added;
  for (size_t c = 0; c < cut_.corner.size(); c += 3) {
    const Corners seed{seed_at(c), seed_at(c + 1), seed_at(c + 2)};
    if (is_added[seed[0]] || is_added[seed[1]] || is_added[seed[2]])
      for (const uint32_t s : seed) is_beside[s] = 1;
  }
  for (size_t s = 0; s < is_fine_.size(); ++s) is_fine_[s] = is_fine_[s] || is_beside[s];
  fine_count_ = std::count(is_fine_.begin(), is_fine_.end(), 1);
}

/// Those in which a triangle has a corner whose cell is fine: there the dual counts, which the fine triangles fit.
std::vector<char> FineCells::active_groups() const {
  std::vector<char> is_active(changed_.size(), 0);
  for (const Changed& t : changed_)
    if (is_fine_[t.corner[0]] || is_fine_[t.corner[1]] || is_fine_[t.corner[2]]) is_active[t.group] = 1;
  return is_active;
}

/// The relaxed vertices, then the fine ones in fine cells. `becomes`: per vertex of the fine mesh its number there, or
/// that of the seed into which it is contracted.
FineCells::Vertices FineCells::vertices() const {
  const FineMesh& fine = *cut_.fine;
  Vertices out{relaxed_.vertices(), {}, std::vector<uint32_t>(fine.position.size(), kNone)};
  for (RegionVertex& v : out.vertex)
    v.is_settled = v.kind != RegionVertex::Kind::free || is_optimized_[relaxed_.lookup().patch(v.home)];
  for (uint32_t s = 0; s < out.vertex.size(); ++s) out.seed.push_back(s);
  std::vector<uint32_t> copy(fine.position.size(), kNone);  // one that is on a border, where there is one
  for (size_t c = 0; c < cut_.corner.size(); ++c) {
    const uint32_t v = fine.triangles[c / 3][c % 3];
    if (copy[v] == kNone || cut_.place[copy[v]] == kNone) copy[v] = cut_.corner[c];
    if (out.becomes[v] == kNone || is_fine_[seed_at(c)]) out.becomes[v] = seed_at(c);
  }
  for (uint32_t v = 0; v < copy.size(); ++v) {
    if (copy[v] == kNone || !is_fine_[out.becomes[v]]) continue;
    out.becomes[v] = uint32_t(out.vertex.size());
    out.vertex.push_back(relaxed_.lookup().vertex_at(copy[v]));
    out.seed.push_back(kNone);
  }
  return out;
}

/// Those between relaxed vertices alone.
std::vector<RegionTriangle> FineCells::relaxed_triangles(const CurveEdges& edges) const {
  const auto is_fine = [&](const Corners& c) { return is_fine_[c[0]] || is_fine_[c[1]] || is_fine_[c[2]]; };
  const std::vector<char> is_active = active_groups();
  std::vector<std::pair<Corners, uint32_t>> replaced;  // with their patches
  std::vector<RegionTriangle> triangles;
  for (const Changed& t : changed_) {
    if (!is_active[t.group]) continue;
    if (t.is_relaxed)
      replaced.push_back({t.corner, t.patch});
    else if (!is_fine(t.corner))
      triangles.push_back(on_curves(edges, t.corner, t.patch));
  }
  for (const RegionTriangle& t : relaxed_.triangles())
    if (!t.is_gone() && !is_fine(t.corner) &&
        !std::binary_search(replaced.begin(), replaced.end(), std::make_pair(from_smallest(t.corner), t.patch)))
      triangles.push_back(t);
  return triangles;
}

FineCells::Mesh FineCells::mesh() const {
  Vertices made = vertices();
  const CurveEdges edges = curve_edges(cut_.fine->paths, made.becomes);
  std::vector<RegionTriangle> triangles = relaxed_triangles(edges);
  for (size_t c = 0; c < cut_.corner.size(); c += 3) {
    Corners corner;
    bool has_fine = false;
    for (size_t i = 0; i < 3; ++i) {
      corner[i] = made.becomes[cut_.fine->triangles[c / 3][i]];
      if (made.seed[corner[i]] == kNone)
        has_fine = true;
      else
        corner[i] = seed_at(c + i);
    }
    if (has_fine && has_area(corner)) triangles.push_back(on_curves(edges, corner, cut_.surface.patch[cut_.corner[c]]));
  }
  EditableMesh mesh(std::move(made.vertex), std::move(triangles), EditableMesh::Size::many);
  return {WallMesh(relaxed_.shared_lookup(), std::move(mesh)), std::move(made.seed)};
}

}  // namespace isoshell
