// How a mesh of patches comes to have as many vertices as asked for (see patch_mesh.h).
#include <algorithm>
#include <cstdlib>

#include "core/watched.h"
#include "features/angles/patch_mesh.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kMostPerCount = 1. / 24;  ///< cost that a change may bring that only keeps the count
constexpr double kMostAtFirst = 0.25;      ///< beyond that, before vertices move
constexpr int64_t kMostTriesPerCount = 64;
constexpr size_t kFewEdges = 11;    ///< of both ends of an edge that is collapsed: 7 are left then
constexpr size_t kPassesOfFew = 3;  ///< over edges, each with one edge more at the ends, before all count
constexpr size_t kMostPasses = 12;
constexpr int64_t kLeastShare = 10;  ///< a pass that meets less than one part in so many is the last

}  // namespace

/// Each edge between vertices off curves, by its length beside the one aimed at there.
std::vector<std::pair<double, uint64_t>> PatchMesh::edges_by_length() const {
  using Kind = RegionVertex::Kind;
  const EdgeLengths& lengths = cut_->surface.lengths;
  std::vector<std::pair<double, uint64_t>> out;
  for (const RegionTriangle& t : triangles_)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t.corner[i], v = t.corner[(i + 1) % 3];
      if (u >= v || vertices_[u].kind != Kind::free || vertices_[v].kind != Kind::free) continue;
      const double aimed_at =
          lengths.at.empty() ? 1 : double(lengths.at[vertices_[u].home]) + double(lengths.at[vertices_[v].home]);
      out.push_back(
          {distance_sq(vertices_[u].position, vertices_[v].position) / (aimed_at * aimed_at), edge_key(u, v)});
    }
  std::sort(out.begin(), out.end());
  return out;
}

/// With a vertex more or less in the edge between the first two, where that hardly costs.
std::optional<MeshRegion> PatchMesh::recounted(const MeshRegion& start) const {
  const auto what = surplus() > 0 ? Change::collapse : Change::split;
  for (const Change& change : {Change{what, 0, 1}, Change{what, 1, 0}}) {
    MeshRegion there = start;
    there.mark_all_tried();
    if (!make(there, change)) continue;
    there.flip_edges();
    const double most = start.cost() + kMostPerCount;
    if (there.cost() > most + kMostAtFirst) continue;
    there.relax(most + kMostAtFirst);
    if (there.cost() <= most && there.is_better_than(start)) return there;
  }
  return {};
}

void PatchMesh::meet_count(const Context& context) {
  if (surplus() != 0) fill_space();
  for (size_t pass = 0; surplus() != 0 && pass < kMostPasses; ++pass) {
    check_cancel(context, "features");
    const int64_t before = surplus();
    std::vector<std::pair<double, uint64_t>> edges = edges_by_length();
    if (before < 0) std::reverse(edges.begin(), edges.end());
    int64_t tries = kMostTriesPerCount * std::abs(before);
    for (size_t i = 0; i < edges.size() && surplus() != 0 && tries > 0; ++i) {
      const auto u = uint32_t(edges[i].second >> 32), v = uint32_t(edges[i].second);
      const bool has_many = before > 0 && around_[u].size() + around_[v].size() > kFewEdges + pass;
      if (!is_edge(u, v) || (has_many && pass < kPassesOfFew)) continue;
      --tries;
      const Cutout cutout = cut_out({u, v}, triangles_around({u, v}));
      if (const std::optional<MeshRegion> there = recounted(cutout.region)) put_back(cutout, *there);
    }
    const int64_t gained = std::abs(before) - std::abs(surplus());
    if (pass >= kPassesOfFew && kLeastShare * gained < std::abs(before)) return;
  }
}

}  // namespace isoshell
