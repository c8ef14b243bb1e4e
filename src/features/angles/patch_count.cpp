// How a mesh of patches comes to have as many vertices as asked for (see patch_mesh.h).
#include <algorithm>
#include <cstdlib>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/angles/patch_mesh.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kMostPerCount = 1. / 24;  ///< cost that a change may bring that only keeps the count
constexpr double kMostAtFirst = 0.25;      ///< beyond that, before vertices move
constexpr int64_t kMostTriesPerCount = 64;
constexpr size_t kAhead = 64;       ///< edges that are looked at side by side
constexpr size_t kFewEdges = 11;    ///< of both ends of an edge that is collapsed: 7 are left then
constexpr size_t kPassesOfFew = 3;  ///< over edges, each with one edge more at the ends, before all count
constexpr size_t kMostPasses = 12;
constexpr int64_t kLeastShare = 10;  ///< a pass that meets less than one part in so many is the last

}  // namespace

/// Each edge between vertices off curves, by its length beside the one aimed at there.
std::vector<uint64_t> PatchMesh::edges_by_length() const {
  using Kind = RegionVertex::Kind;
  const EdgeLengths& lengths = lookup_->cut().surface.lengths;
  std::vector<std::pair<double, uint64_t>> out;
  for (const RegionTriangle& t : triangles())
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t.corner[i], v = t.corner[(i + 1) % 3];
      if (u >= v || vertex(u).kind != Kind::free || vertex(v).kind != Kind::free) continue;
      const double aimed_at =
          lengths.at.empty() ? 1 : double(lengths.at[vertex(u).home]) + double(lengths.at[vertex(v).home]);
      out.push_back({distance_sq(vertex(u).position, vertex(v).position) / (aimed_at * aimed_at), edge_key(u, v)});
    }
  std::sort(out.begin(), out.end());
  std::vector<uint64_t> edges;
  for (const auto& [length, edge] : out) edges.push_back(edge);
  return edges;
}

/// With a vertex more or less in the edge between the first two, where that hardly costs.
std::optional<MeshRegion> PatchMesh::recounted(const MeshRegion& start) const {
  const auto what = surplus() > 0 ? Change::collapse : Change::split;
  for (const Change& change : {Change{what, 0, 1}, Change{what, 1, 0}}) {
    MeshRegion there = start;
    there.mark_all_tried();
    if (!make_change(there, change)) continue;
    there.flip_edges();
    const double most = start.cost() + kMostPerCount;
    if (there.cost() > most + kMostAtFirst) continue;
    there.relax(most + kMostAtFirst);
    if (there.cost() <= most && there.is_better_than(start)) return there;
  }
  return {};
}

/// Whether an edge is there, and takes part in a pass.
bool PatchMesh::may_recount(uint64_t edge, size_t pass) const {
  const auto u = uint32_t(edge >> 32), v = uint32_t(edge);
  const bool has_many = surplus() > 0 && around(u).size() + around(v).size() > kFewEdges + pass;
  return is_edge(u, v) && !(has_many && pass < kPassesOfFew);
}

PatchMesh::Recount PatchMesh::recount_at(uint64_t edge) const {
  const auto u = uint32_t(edge >> 32), v = uint32_t(edge);
  Recount out;
  out.cutout = cut_out({u, v}, triangles_around({u, v}));
  out.made = recounted(out.cutout->region);
  return out;
}

/// Whether something around has changed since.
bool PatchMesh::is_stale(const Recount& recount) const {
  const std::vector<RegionVertex>& vertices = recount.cutout->region.vertices();
  return std::any_of(vertices.begin(), vertices.end(),
                     [&](const RegionVertex& v) { return replaced_at_[v.number] == clock_; });
}

/// One edge after the other. What each would become is found ahead, side by side, and found again where another one has
/// changed what is around: the result is that of one thread.
void PatchMesh::recount_edges(const std::vector<uint64_t>& edges, size_t pass, int64_t tries, const Context& context) {
  const size_t ahead = loops_run_alone() ? 1 : kAhead;
  for (size_t begin = 0; begin < edges.size(); begin += ahead) {
    check_cancel(context, "features");
    const size_t count = std::min(ahead, edges.size() - begin);
    std::vector<Recount> recounts(count);
    ++clock_;
    replaced_at_.resize(vertices().size(), 0);
    for_each_index(size_t(0), count, [&](size_t i) {
      if (may_recount(edges[begin + i], pass)) recounts[i] = recount_at(edges[begin + i]);
    });
    for (size_t i = 0; i < count; ++i) {
      if (surplus() == 0 || tries == 0) return;
      if (!may_recount(edges[begin + i], pass)) continue;
      --tries;
      if (!recounts[i].cutout || is_stale(recounts[i])) recounts[i] = recount_at(edges[begin + i]);
      if (recounts[i].made) put_back(*recounts[i].cutout, *recounts[i].made);
    }
  }
}

void PatchMesh::meet_count(const Context& context) {
  if (surplus() != 0) keep_apart(lookup_->cut().longest_edge_q8);
  for (size_t pass = 0; surplus() != 0 && pass < kMostPasses; ++pass) {
    const int64_t before = surplus();
    std::vector<uint64_t> edges = edges_by_length();
    if (before < 0) std::reverse(edges.begin(), edges.end());
    recount_edges(edges, pass, kMostTriesPerCount * std::abs(before), context);
    const int64_t gained = std::abs(before) - std::abs(surplus());
    if (pass >= kPassesOfFew && kLeastShare * gained < std::abs(before)) return;
  }
}

}  // namespace isoshell
