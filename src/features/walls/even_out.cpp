// even_out (see even_out.h).
#include "features/walls/even_out.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/walls/coarsen.h"
#include "features/walls/wall_blocks.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr int kRounds = 16;
constexpr int kLastRounds = 3;          ///< in which shapes alone count
constexpr double kCostOfValence = 0.3;  ///< of those before: .1 and 1 leave worse triangles of maps of brains
constexpr int kRoundsToSplit = 4;       ///< edges are split in every one of so many
constexpr double kLong = 1.35;          ///< mean edges: longer ones are split
constexpr int64_t kMostSplits = 16;     ///< one vertex in so many, at once

/// In a block.
class Evening {
 public:
  Evening(WallMesh& mesh, const WallBlocks& blocks, size_t block)
      : mesh_(mesh), places_(mesh.lookup()), blocks_(blocks), block_(block) {}

  void flip_edges(double cost_of_valence) {
    for (const uint32_t v : blocks_.vertices_of(block_)) {
      if (!is_here(v)) continue;
      around_ = mesh_.around(v);
      for (const uint32_t t : around_)
        for (size_t i = 0; i < 3; ++i) {
          const auto& corner = mesh_.triangles()[t].corner;
          if (corner[i] == v && is_here(corner[(i + 1) % 3])) mesh_.flip(t, i, cost_of_valence, scratch_);
        }
    }
  }
  void move_vertices() {
    for (const uint32_t v : blocks_.vertices_of(block_)) {
      if (!is_here(v)) continue;
      if (mesh_.vertex(v).kind == RegionVertex::Kind::free) move_free(v);
      if (mesh_.vertex(v).kind == RegionVertex::Kind::on_curve) move_along(v);
    }
  }

 private:
  bool is_here(uint32_t v) const { return blocks_.holds_around(block_, v); }
  bool move(uint32_t v, const RegionVertex& to) {
    return blocks_.holds(block_, to.position) && mesh_.move(v, to, scratch_);
  }

  void move_free(uint32_t v) {
    WorldPoint sum{0, 0, 0};
    double areas = 0;
    for (const uint32_t t : mesh_.around(v)) {
      const auto& c = mesh_.triangles()[t].corner;
      const double area = triangle_area(mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2]));
      sum = sum + (area / 3) * (mesh_.at(c[0]) + mesh_.at(c[1]) + mesh_.at(c[2]));
      areas += area;
    }
    if (!(areas > 0)) return;
    const WorldPoint from = mesh_.at(v), way = (1 / areas) * sum - from;
    for (const double part : {1., .5, .25}) {
      const std::optional<RegionVertex> there = places_.on_surface_near(mesh_.vertex(v), from + part * way);
      if (there && move(v, *there)) return;
    }
  }
  void move_along(uint32_t v) {
    mesh_.list_targets(v, ends_);
    if (ends_.size() != 2) return;
    const RegionVertex from = mesh_.vertex(v);
    const double way =
        (places_.way_between(from, mesh_.vertex(ends_[0])) + places_.way_between(from, mesh_.vertex(ends_[1]))) / 2;
    for (const double part : {1., .5})
      if (move(v, places_.along(from, part * way))) return;
  }

  WallMesh& mesh_;
  const CutLookup& places_;
  const WallBlocks& blocks_;
  size_t block_;
  std::vector<uint32_t> ends_, around_;
  MeshChange scratch_;
};

template <class Work>
void in_blocks(WallMesh& mesh, double side_q8, bool is_shifted, const Context& context, Work work) {
  const WallBlocks blocks(mesh, side_q8, is_shifted);
  for_each_index(size_t(0), blocks.size(), [&](size_t b) {
    check_cancel(context, "features");
    Evening here(mesh, blocks, b);
    work(here);
  });
}

/// The longest first, in terms of the length aimed at, but those between settled vertices.
std::vector<uint64_t> long_edges(const WallMesh& mesh) {
  std::vector<std::pair<double, uint64_t>> edges;
  for (const RegionTriangle& t : mesh.triangles())
    for (size_t i = 0; i < 3 && !t.is_gone(); ++i) {
      const auto [u, v] = std::minmax(t.corner[i], t.corner[(i + 1) % 3]);
      if (mesh.vertex(u).is_settled && mesh.vertex(v).is_settled) continue;
      const double aimed_at = mesh.aimed_at(u) + mesh.aimed_at(v);
      edges.push_back({-std::sqrt(distance_sq(mesh.at(u), mesh.at(v))) / aimed_at, uint64_t(u) << 32 | v});
    }
  std::sort(edges.begin(), edges.end());
  edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
  double sum = 0;
  for (const auto& edge : edges) sum += edge.first;
  std::vector<uint64_t> out;
  for (const auto& edge : edges)
    if (edge.first < kLong * sum / double(edges.size())) out.push_back(edge.second);
  return out;
}

bool split_edge(WallMesh& mesh, uint32_t u, uint32_t v, MeshChange& scratch) {
  const std::optional<uint32_t> curve = mesh.curve_between(u, v);
  if (!curve) return false;
  using Kind = RegionVertex::Kind;
  const Kind kind = *curve == kNone ? Kind::free : Kind::on_curve;
  if (mesh.vertex(u).kind != kind) std::swap(u, v);
  if (mesh.vertex(u).kind != kind) return false;
  const RegionVertex& from = mesh.vertex(u);
  const CutLookup& places = mesh.lookup();
  std::optional<RegionVertex> middle = kind == Kind::free
                                           ? places.on_surface_near(from, 0.5 * (mesh.at(u) + mesh.at(v)))
                                           : places.along(from, places.way_between(from, mesh.vertex(v)) / 2);
  if (!middle) return false;
  middle->is_settled = false;
  return mesh.split(u, v, *middle, scratch);
}

void split_long_edges(WallMesh& mesh, int64_t most) {
  MeshChange scratch;
  for (const uint64_t edge : long_edges(mesh)) {
    if (most == 0) return;
    most -= split_edge(mesh, uint32_t(edge >> 32), uint32_t(edge), scratch) ? 1 : 0;
  }
}

}  // namespace

void even_out(WallMesh& mesh, int64_t vertices, const Context& context) {
  const double side_q8 = side_of_blocks_q8(mesh, vertices);
  for (int round = 0; round < kRounds; ++round) {
    const double cost_of_valence = round < kRounds - kLastRounds ? kCostOfValence : 0;
    in_blocks(mesh, side_q8, round % 2 != 0, context, [&](Evening& here) {
      here.flip_edges(cost_of_valence);
      here.move_vertices();
    });
    if (round % kRoundsToSplit != 0) continue;
    if (mesh.vertex_count() <= vertices) split_long_edges(mesh, vertices / kMostSplits);
    coarsen(mesh, vertices, context);
  }
  for (const bool is_shifted : {false, true})
    in_blocks(mesh, side_q8, is_shifted, context, [](Evening& here) { here.flip_edges(0); });
}

}  // namespace isoshell
