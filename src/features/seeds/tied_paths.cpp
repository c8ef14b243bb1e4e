// See tied_paths.h.
#include "features/seeds/tied_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <unordered_map>
#include <utility>

#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

constexpr double kRounding_q8 = 1. / 64;  ///< of positions that are not on the lattice yet
constexpr double WorldPoint::*kAxes[3] = {&WorldPoint::x, &WorldPoint::y, &WorldPoint::z};

/// Where it is on a side, in steps of the rounding.
std::array<int64_t, 2> place_on_side(const WorldPoint& p, size_t axis) {
  const auto whole = [](double at) { return std::llround(at / kRounding_q8); };
  return {whole(p.*kAxes[(axis + 1) % 3]), whole(p.*kAxes[(axis + 2) % 3])};
}

struct EdgeOfPath {
  size_t path, edge;
};

/// The paths of two opposite sides.
class SeedsOfSides {
 public:
  SeedsOfSides(FineMesh& mesh, const std::vector<std::array<uint32_t, 2>>& pairs) : mesh_(mesh) {
    for (const auto& [low, high] : pairs) low_of_[high] = low;
    for (size_t p = 0; p < mesh.paths.size(); ++p)
      for (size_t i = 0; i < mesh.paths[p].edge_count(); ++i)
        edges_[edge_key(mesh.paths[p].vertex[i], mesh.paths[p].edge_end(i))] = {p, i};
  }

  void share() {
    for (CurvePath& path : mesh_.paths)
      if (is_high(path)) path.seeds = seeds_of_low(path);
  }

 private:
  const EdgeOfPath* low_edge(const CurvePath& path, size_t edge) const {
    const auto u = low_of_.find(path.vertex[edge]), v = low_of_.find(path.edge_end(edge));
    if (u == low_of_.end() || v == low_of_.end()) return nullptr;
    const auto found = edges_.find(edge_key(u->second, v->second));
    return found != edges_.end() ? &found->second : nullptr;
  }
  bool is_high(const CurvePath& path) const {
    for (size_t i = 0; i < path.edge_count(); ++i)
      if (!low_edge(path, i)) return false;
    return path.edge_count() > 0;
  }

  std::vector<PathPoint> seeds_of_low(const CurvePath& path) const {
    std::vector<PathPoint> seeds;
    for (size_t i = 0; i < path.edge_count(); ++i) {
      const EdgeOfPath& low = *low_edge(path, i);
      const CurvePath& from = mesh_.paths[low.path];
      const uint32_t begin = low_of_.at(path.vertex[i]);
      const bool is_reversed = from.vertex[low.edge] != begin;
      if (is_seed(from, is_reversed ? low.edge + 1 : low.edge)) seeds.push_back({i, 0});
      std::vector<double> parts;
      for (auto seed = first_on(from, low.edge); seed != from.seeds.end() && seed->edge == low.edge; ++seed)
        if (seed->part > 0) parts.push_back(is_reversed ? 1 - seed->part : seed->part);
      std::sort(parts.begin(), parts.end());
      for (const double part : parts) seeds.push_back({i, part});
    }
    if (!path.is_loop) seeds.push_back({path.edge_count(), 0});
    return seeds;
  }
  static bool is_seed(const CurvePath& path, size_t at) {
    if (path.is_loop && at == path.vertex.size()) at = 0;
    if (!path.is_loop && (at == 0 || at + 1 == path.vertex.size())) return true;
    const auto seed = first_on(path, at);
    return seed != path.seeds.end() && seed->edge == at && seed->part == 0;
  }
  static std::vector<PathPoint>::const_iterator first_on(const CurvePath& path, size_t edge) {
    return std::lower_bound(path.seeds.begin(), path.seeds.end(), edge,
                            [](const PathPoint& seed, size_t of) { return seed.edge < of; });
  }

  FineMesh& mesh_;
  std::unordered_map<uint32_t, uint32_t> low_of_;
  std::unordered_map<uint64_t, EdgeOfPath> edges_;  ///< by their ends
};

}  // namespace

TiedPaths::TiedPaths(const FineMesh& mesh, const WorldPoint& period_q8) {
  for (size_t axis = 0; axis < 3; ++axis) {
    const double period = period_q8.*kAxes[axis];
    if (period == 0) continue;
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const WorldPoint& p : mesh.position)
      low = std::min(low, p.*kAxes[axis]), high = std::max(high, p.*kAxes[axis]);
    const auto is_near = [](double a, double b) { return std::abs(a - b) < kRounding_q8; };
    if (!is_near(high - low, period)) continue;
    std::map<std::array<int64_t, 2>, uint32_t> first;
    std::vector<std::array<uint32_t, 2>>& pairs = pairs_.emplace_back();
    const auto for_each_at = [&](double plane, auto visit) {
      for (const CurvePath& path : mesh.paths)
        for (const uint32_t v : path.vertex)
          if (is_near(mesh.position[v].*kAxes[axis], plane)) visit(v);
    };
    for_each_at(low, [&](uint32_t v) { first[place_on_side(mesh.position[v], axis)] = v; });
    for_each_at(high, [&](uint32_t v) {
      const auto [a, b] = place_on_side(mesh.position[v], axis);
      for (int64_t i = 0; i < 9; ++i) {
        const auto found = first.find({a + i % 3 - 1, b + i / 3 - 1});
        if (found == first.end()) continue;
        pairs.push_back({found->second, v});
        break;
      }
    });
  }
}

void TiedPaths::share_lengths(FineMesh& mesh) const {
  for (size_t round = 0; round < pairs_.size(); ++round)  // vertices of several sides
    for (const auto& pairs : pairs_)
      for (const auto& [low, high] : pairs)
        mesh.edge_length[low] = mesh.edge_length[high] = std::min(mesh.edge_length[low], mesh.edge_length[high]);
}

void TiedPaths::share_seeds(FineMesh& mesh) const {
  for (const auto& pairs : pairs_) SeedsOfSides(mesh, pairs).share();
}

}  // namespace isoshell
