#include "implicit/points/unflat_points.h"

#include <algorithm>

#include "core/parallel_ranges.h"
#include "implicit/points/plane_fit.h"

namespace isoshell {
namespace {

// Few neighbours see one side of a thin body; more are flatter where noise is as large as the spacing. Even the most of
// them are no plane in a fluid that is four particles deep.
constexpr size_t kNeighbours[] = {256, 32, 8};
constexpr size_t kPointsPerNeighbour = 8;  // of all points, so that no neighbourhood is most of a small body
constexpr size_t kFewest = 64;             // points that have eight neighbours then
constexpr size_t kTried = 2000;
constexpr double kFlat = 0.07;  // part of the scatter that is off a plane: of half a ball, as at a fluid's side, .13

bool is_flat(const std::vector<WorldPoint>& position, const PointTree& tree, size_t i) {
  const size_t most = position.size() / kPointsPerNeighbour;
  std::vector<PointTree::Near> near;
  tree.nearest(position[i], std::min(kNeighbours[0], most) + 1, near);
  for (const size_t count : kNeighbours) {
    near.resize(std::min(near.size(), count + 1));
    if (fit_plane(position, near).off < kFlat) return true;
  }
  return false;
}

}  // namespace

double unflat_part(const std::vector<WorldPoint>& position, const PointTree& tree) {
  if (position.size() < kFewest) return 0;
  const size_t stride = (position.size() + kTried - 1) / kTried, tried = (position.size() + stride - 1) / stride;
  std::vector<uint8_t> unflat(tried);
  for_each_index(size_t(0), tried, [&](size_t i) { unflat[i] = !is_flat(position, tree, i * stride); });
  return double(std::count(unflat.begin(), unflat.end(), uint8_t(1))) / double(tried);
}

}  // namespace isoshell
