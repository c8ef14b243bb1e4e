// See next_cut.h.
#include "pipeline/patches/next_cut.h"

#include <algorithm>
#include <utility>

#include "features/seeds/requested_lengths.h"
#include "geometry/near_points.h"

namespace isoshell {
namespace {

std::optional<NextCut> with_fewer_creases(const CutSurface& cut, const std::vector<PointQ8>& wrong) {
  std::optional<Paths> paths = drop_creases(*cut.fine, wrong);
  if (!paths) return {};
  return NextCut{std::move(*paths), {}};
}

std::optional<NextCut> with_shorter_edges(const CutSurface& cut, const std::vector<PointQ8>& wrong) {
  const FineMesh& fine = *cut.fine;
  const double reach_q8 = cut.longest_edge_q8 / 2, least = cut.longest_edge_q8 / kMostLengthRatio;
  std::optional<Paths> paths = halve_segments(fine, wrong, reach_q8);
  bool has_changed = paths.has_value();
  NextCut next{paths.value_or(fine.paths), fine.edge_length};
  const NearPoints near(wrong, reach_q8);
  for (size_t v = 0; v < fine.position.size(); ++v) {
    double& length = next.edge_length[v];
    if (length <= least || !near.holds(rounded(fine.position[v]))) continue;
    length = std::max(least, length / 2);
    has_changed = true;
  }
  if (!has_changed) return {};
  return next;
}

}  // namespace

std::optional<NextCut> next_cut(const CutSurface& cut, const std::vector<PointQ8>& wrong) {
  return cut.regions ? with_shorter_edges(cut, wrong) : with_fewer_creases(cut, wrong);
}

}  // namespace isoshell
