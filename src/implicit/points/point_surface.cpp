// From points to a closed surface: normals, indicator function, its level, and a step onto the points.

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "implicit/points/flat_normals.h"
#include "implicit/points/indicator_grid.h"
#include "implicit/points/point_distances.h"
#include "implicit/points/point_support.h"
#include "implicit/points/trim_to_points.h"
#include "implicit/points/unflat_points.h"
#include "implicit/volumes/iso_surface.h"
#include "isoshell/error.h"
#include "isoshell/io/point_file.h"

namespace isoshell {
namespace {

constexpr int64_t kMaxGrid = int64_t(1) << 27;
constexpr int64_t kBytesPerVoxel = 9;   // value and source, and an eighth of them on the next grid; or distances
constexpr double kVoxelSpacings = 1.5;  // noise of a scan is about its spacing: finer voxels make handles of it
constexpr double kLeastLevel = 0.02;    // at that of the rim, 0, and below, the space around would be inside
constexpr double kLineSpacings = 0.01;  // points that keep so near to a line have no side
constexpr size_t kOutlierNeighbours = 8, kFewestForOutliers = 200;
constexpr double kOutlierToNeighbours = 2.2;  // times as far from its neighbours as they, or all points, from theirs
constexpr double kGroupLink = 4;              // what such points are at most apart in a group, in the same distance
constexpr uint32_t kSmallGroup = 12;
constexpr double kMostOutliers = 0.1;  // of all points

/// The different points, and their normals in the same order.
void keep_different(std::vector<WorldPoint>& position, std::vector<WorldPoint>& normal) {
  std::vector<uint32_t> order(position.size());
  std::iota(order.begin(), order.end(), 0u);
  const auto before = [&](uint32_t a, uint32_t b) {
    const WorldPoint &p = position[a], &q = position[b];
    return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z != q.z ? p.z < q.z : a < b;
  };
  std::sort(order.begin(), order.end(), before);
  std::vector<WorldPoint> points, normals;
  for (const uint32_t i : order) {
    if (!points.empty() && distance_sq(points.back(), position[i]) == 0) continue;
    points.push_back(position[i]);
    if (!normal.empty()) normals.push_back(normal[i]);
  }
  position = std::move(points);
  normal = std::move(normals);
}

/// Distance of each point from its eighth neighbour.
std::vector<double> distances_around(const PointTree& tree, const std::vector<WorldPoint>& position) {
  std::vector<double> distance(position.size());
  for_each_index(size_t(0), position.size(), [&](size_t i) {
    std::vector<PointTree::Near> near;
    tree.nearest(position[i], kOutlierNeighbours + 1, near);
    distance[i] = std::sqrt(near.back().first);
  });
  return distance;
}

/// Leaves out points in small groups that are far from all others, and points much farther from their neighbours than
/// those are from theirs. A cloud with many of them is uneven rather than dirty and stays as it is. Returns how many.
int64_t drop_outliers(std::vector<WorldPoint>& position, std::vector<WorldPoint>& normal) {
  const size_t count = position.size();
  if (count < kFewestForOutliers) return 0;
  const PointTree tree(position);
  const std::vector<double> distance = distances_around(tree, position);
  std::vector<double> sorted = distance;
  std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(count / 2), sorted.end());
  const double usual = sorted[count / 2];
  std::vector<uint8_t> is_outlier(count);
  IndexSets sets{int64_t(count)};
  std::vector<uint32_t> sparse;
  for (uint32_t i = 0; i < count; ++i)
    if (distance[i] > kOutlierToNeighbours * usual) sparse.push_back(i);
  std::vector<PointTree::Near> near;
  std::vector<double> around;
  for (const uint32_t i : sparse) {
    tree.nearest(position[i], kOutlierNeighbours + 1, near);
    around.clear();
    for (const auto& [distance_sq, n] : near) {
      if (n == i) continue;
      around.push_back(distance[n]);
      if (distance_sq <= kGroupLink * kGroupLink * usual * usual) sets.unite(i, n);
    }
    std::nth_element(around.begin(), around.begin() + std::ptrdiff_t(around.size() / 2), around.end());
    is_outlier[i] = distance[i] > kOutlierToNeighbours * around[around.size() / 2];
  }
  // A group with a point that is not sparse is no small one: that point has as many others around it.
  std::vector<uint32_t> members(count);
  for (uint32_t i = 0; i < count; ++i)
    members[sets.root(i)] += distance[i] > kOutlierToNeighbours * usual ? 1 : kSmallGroup;
  for (const uint32_t i : sparse)
    if (members[sets.root(i)] < kSmallGroup) is_outlier[i] = 1;
  const int64_t dropped = std::count(is_outlier.begin(), is_outlier.end(), uint8_t(1));
  if (dropped == 0 || double(dropped) > kMostOutliers * double(count)) return 0;
  size_t kept = 0;
  for (size_t i = 0; i < count; ++i) {
    if (is_outlier[i]) continue;
    position[kept] = position[i];
    if (!normal.empty()) normal[kept] = normal[i];
    ++kept;
  }
  position.resize(kept);
  if (!normal.empty()) normal.resize(kept);
  return dropped;
}

/// Squares of distances must neither vanish nor overflow.
void check_extent(const std::vector<WorldPoint>& position) {
  double most = 0;
  for (const WorldPoint& p : position)
    for (int axis = 0; axis < 3; ++axis)
      most = std::max(most, std::abs(coordinate(p, axis) - coordinate(position[0], axis)));
  if (most < 1e-100 || most > 1e100)
    throw Error(ErrorCode::nothing_to_mesh, "points",
                "the points span " + std::to_string(most) + ", which no grid can follow; scale them");
}

/// Whether no point is farther than `reach` from the line through the first point and the one farthest from it.
bool on_a_line(const std::vector<WorldPoint>& position, double reach) {
  const WorldPoint& o = position[0];
  const WorldPoint far = *std::max_element(position.begin(), position.end(), [&](const auto& a, const auto& b) {
    return distance_sq(a, o) < distance_sq(b, o);
  });
  const double x = far.x - o.x, y = far.y - o.y, z = far.z - o.z, length_sq = x * x + y * y + z * z;
  return std::all_of(position.begin(), position.end(), [&](const WorldPoint& p) {
    const double t = (x * (p.x - o.x) + y * (p.y - o.y) + z * (p.z - o.z)) / length_sq;
    return distance_sq(p, {o.x + t * x, o.y + t * y, o.z + t * z}) <= reach * reach;
  });
}

/// On the sides of a sharp body, with vertices on its creases.
TriangleSoup extract_sharp(OrientedPoints& points, std::vector<WorldPoint> normal, const Indicator& indicator,
                           int64_t memory_limit_bytes) {
  points.normal = std::move(normal);
  PointDistances field(points, indicator);
  field.file = "the points";
  field.name = "distance";
  return extract_iso_surface(field, 0, memory_limit_bytes, VolumeCreases::all);
}

TriangleSoup extract_smooth(const GridShape& shape, std::vector<float> value, double level,
                            int64_t memory_limit_bytes) {
  IndicatorField field(shape, std::move(value), level);
  field.file = "the points";
  field.name = "indicator";
  return extract_iso_surface(field, level, memory_limit_bytes);
}

}  // namespace

TriangleSoup surface_of_points(const PointCloud& cloud, int64_t memory_limit_bytes, PointSurfaceInfo& info,
                               VolumeCreases creases, bool keep_open) {
  std::vector<WorldPoint> position = cloud.position, normal = cloud.normal;
  keep_different(position, normal);
  info.points = int64_t(position.size());
  info.normals_given = !normal.empty();
  if (info.points < 4)
    throw Error(ErrorCode::nothing_to_mesh, "points",
                "only " + std::to_string(info.points) + " different points; a surface needs at least 4");
  check_extent(position);
  info.outliers = drop_outliers(position, normal);
  const PointTree tree(position);
  OrientedPoints points = orient_points(position, std::move(normal), tree);
  if (on_a_line(points.position, kLineSpacings * points.spacing))
    throw Error(ErrorCode::nothing_to_mesh, "points", "all points lie on a line; a surface needs some beside it");
  info.spacing_world = points.spacing;
  info.normals_turned = points.turned;
  info.normals_ignored = points.ignored;
  if (!info.normals_given || points.ignored) info.unflat_part = unflat_part(position, tree);
  int64_t most = kMaxGrid;
  if (memory_limit_bytes > 0) most = std::min(most, memory_limit_bytes / 2 / kBytesPerVoxel);
  if (most < 1 << 15)
    throw Error(ErrorCode::out_of_memory, "points", "the memory limit leaves no room for a grid; raise --max-memory");
  const GridShape shape = shape_around(points.position, kVoxelSpacings * points.spacing, most);
  info.voxel_size_world = shape.voxel_size;
  std::vector<float> value = solve_indicator(points, shape);
  const double level = std::max(level_at_points(points, shape, value), kLeastLevel);
  std::vector<WorldPoint> flat;
  if (creases != VolumeCreases::none) flat = find_flat_normals(points, tree);
  info.sharp = !flat.empty();
  TriangleSoup soup = info.sharp ? extract_sharp(points, std::move(flat), {shape, value, level}, memory_limit_bytes)
                                 : extract_smooth(shape, std::move(value), level, memory_limit_bytes);
  const PointsOfSurface around{points, tree, shape.voxel_size};
  drop_unsupported(around, soup);
  info.held_part = held_part(around, soup);
  if (soup.triangles.empty())
    throw Error(ErrorCode::nothing_to_mesh, "points",
                "the points enclose nothing: they lie on a line, or too far apart to be one surface");
  const std::vector<uint8_t> supported = info.sharp ? find_supported(around, soup) : pull_to_points(around, soup);
  const int64_t held = std::accumulate(supported.begin(), supported.end(), int64_t(0));
  info.open_part = 1 - double(held) / double(soup.vertices.size());
  if (keep_open) trim_to_points(around, soup);
  soup.faces_in_file = 0;
  soup.dirt = cloud.dirt;
  return soup;
}

}  // namespace isoshell
