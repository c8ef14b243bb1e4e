// halve_segments (see halve_segments.h).
#include "features/halve_segments.h"

#include <utility>

#include "core/copy_product.h"
#include "core/near_points.h"

namespace isoshell {
namespace {

/// Puts a seed at the place nearest to the middle of every segment that has a place near a point. Result: whether there
/// is one.
bool halve(CutCurve& curve, const std::vector<char>& is_near) {
  std::vector<size_t> seeds;
  for (size_t s = 0; s < curve.seeds.size(); ++s) {
    seeds.push_back(curve.seeds[s]);
    const bool is_last = s + 1 == curve.seeds.size();
    if (is_last && !curve.is_loop) break;
    const size_t begin = curve.seeds[s], end = is_last ? curve.place.size() : curve.seeds[s + 1];
    const double middle = (curve.at_q8[begin] + (is_last ? curve.length_q8 : curve.at_q8[end])) / 2;
    bool any = false;
    size_t nearest = begin;
    for (size_t i = begin; i < end; ++i) {
      any = any || is_near[curve.place[i]];
      if (std::abs(curve.at_q8[i] - middle) < std::abs(curve.at_q8[nearest] - middle)) nearest = i;
    }
    if (any && nearest > begin) seeds.push_back(nearest);
  }
  const bool has_more = seeds.size() > curve.seeds.size();
  curve.seeds = std::move(seeds);
  return has_more;
}

}  // namespace

std::optional<CutSurface> halve_segments(const CutSurface& cut, const std::vector<PointQ8>& points, double reach_q8) {
  const NearPoints near(points, reach_q8);
  std::vector<char> is_near(cut.copies_first.size() - 1);
  for (size_t p = 0; p < is_near.size(); ++p)
    is_near[p] = near.holds(cut.surface.position[cut.copies[size_t(cut.copies_first[p])]]);
  std::vector<CutCurve> curves = cut.curves;
  bool any = false;
  for (CutCurve& curve : curves) any = halve(curve, is_near) || any;
  if (!any) return {};
  return CutSurface{host_copy(cut.surface),
                    cut.voxel_size,
                    cut.longest_edge_q8,
                    cut.is_asked,
                    std::move(curves),
                    cut.corner_count,
                    cut.place,
                    cut.copies_first,
                    cut.copies,
                    cut.seeds,
                    cut.source};
}

}  // namespace isoshell
