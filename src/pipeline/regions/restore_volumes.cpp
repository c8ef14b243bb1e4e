// See restore_volumes.h.
#include "pipeline/regions/restore_volumes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <utility>

#include "core/buckets.h"
#include "core/watched.h"
#include "features/mesh/refine_mesh.h"
#include "geometry/box.h"
#include "geometry/wall_pressures.h"
#include "geometry/world_vector.h"
#include "measure/crossings.h"

namespace isoshell {
namespace {

constexpr int kMostMends = 3;          ///< vertices that went back leave the others more to do
constexpr int kMostOffsets = 12;       ///< before each: vertices on curves go less far than their walls
constexpr double kLeastOffset_q8 = 1;  ///< less is lost when positions are rounded
/// What a triangle whose corners stay counts for, of one with a corner that moves: where such walls bound all that
/// others can move, pressures are bounded all the same.
constexpr double kStaying = 0.01;
constexpr double kFarthestOfEdge = 1. / 4;
constexpr double kMostOffset_q8 = 1 << 20;  ///< where walls cannot go far enough, pressures grow without bounds
constexpr uint8_t kAllAxes = 7;
constexpr int32_t kFar = 1 << 30;  ///< beyond the lattice
constexpr int kMostRounds = 16;    ///< in which vertices go back

class WallOffsets {
 public:
  WallOffsets(const CutSurface& cut, const RegionWalls& walls, const JoinedPatches& joined)
      : triangles_(joined.mesh.triangles.view()),
        patch_(joined.features.patch),
        before_(joined.mesh.position.begin(), joined.mesh.position.end()),
        at_(before_),
        may_move_(before_.size(), kAllAxes),
        at_vertices_(sort_into_buckets<uint32_t>(int64_t(before_.size()), triangles_.size, [&](int64_t t, auto put) {
          for (const uint32_t v : corners(t)) put(v, uint32_t(t));
        })) {
    number_pairs(cut, walls);
    keep_sides(cut, walls);
    bound_ways();
  }

  /// Whether vertices moved.
  bool offset() {
    const std::vector<double> offsets = find_offsets();
    const auto is_small = [](double offset) { return std::abs(offset) < kLeastOffset_q8; };
    if (std::all_of(offsets.begin(), offsets.end(), is_small)) return false;
    std::vector<PointQ8> next(at_.size());
    for_each_index(size_t(0), at_.size(), [&](size_t v) { next[v] = may_move_[v] != 0 ? moved(v, offsets) : at_[v]; });
    at_.swap(next);
    return !std::equal(at_.begin(), at_.end(), next.begin(), is_same);
  }

  /// Lets vertices go back where triangles became worse; they stay there.
  void mend(Context& context) {
    for (int round = 0; round < kMostRounds; ++round) {
      std::vector<uint8_t> is_bad(size_t(triangles_.size), 0);
      for_each_index(int64_t(0), triangles_.size, [&](int64_t t) { is_bad[size_t(t)] = is_worse(t); });
      for (const auto& pair : crossing_pairs({at_.data(), int64_t(at_.size())}, triangles_, {}, context.cancel))
        is_bad[pair[0]] = is_bad[pair[1]] = 1;
      check_cancel(context, "features");
      bool went_back = false;
      for (int64_t t = 0; t < triangles_.size; ++t)
        if (is_bad[size_t(t)])
          for (const uint32_t v : corners(t)) {
            went_back |= !is_same(at_[v], before_[v]);
            at_[v] = before_[v];
            may_move_[v] = 0;
          }
      if (!went_back) return;
    }
    at_ = before_;
    std::fill(may_move_.begin(), may_move_.end(), uint8_t(0));
  }

  const std::vector<PointQ8>& positions() const { return at_; }

 private:
  std::array<uint32_t, 3> corners(int64_t t) const {
    const TriangleIndices& of = triangles_[t];
    return {of.a, of.b, of.c};
  }
  static bool is_same(const PointQ8& a, const PointQ8& b) { return a.x == b.x && a.y == b.y && a.z == b.z; }
  static WorldPoint point(const PointQ8& p) { return {double(p.x), double(p.y), double(p.z)}; }
  WorldPoint normal(int64_t t, const std::vector<PointQ8>& at) const {  // as long as twice the area
    const auto [a, b, c] = corners(t);
    return doubled_area(point(at[a]), point(at[b]), point(at[c]));
  }

  void number_pairs(const CutSurface& cut, const RegionWalls& walls) {
    std::map<int32_t, uint32_t> region;
    for (const auto& [label, volume] : walls.spanned_volume_q8) {
      region.emplace(label, uint32_t(wanted_.size()));
      wanted_.push_back(volume);
    }
    std::map<std::array<uint32_t, 2>, uint32_t> numbers;
    for (const auto& [inside, outside] : labels_of_patches(cut)) {
      const std::array<uint32_t, 2> pair{region.at(inside), region.at(outside)};
      const auto [at, is_new] = numbers.emplace(pair, uint32_t(pairs_.size()));
      if (is_new) pairs_.push_back({pair, 0});
      pair_of_patch_.push_back(at->second);
    }
  }

  /// Patches that lie at sides of the volume are flat: along an axis they have one place, and their vertices move along
  /// the others alone. Patches lie there in part where creases were too small to cut them.
  void keep_sides(const CutSurface& cut, const RegionWalls& walls) {
    const std::vector<uint8_t>& side = walls.regions.side;
    std::vector<uint8_t> stays(pair_of_patch_.size(), 0);  // of a patch at a periodic side, as those opposite, that
    std::vector<WorldBox> boxes(pair_of_patch_.size(), box_of_none());
    is_side_.resize(boxes.size(), side.empty() ? 0 : 1);
    for (size_t t = 0; t < cut.fine->triangles.size() && !side.empty(); ++t) {
      const uint32_t patch = cut.surface.patch[cut.corner[3 * t]];
      const uint8_t of = side[cut.fine->source_face[t]];
      if (of == 0) is_side_[patch] = 0;
      if (walls.regions.is_periodic_side(of)) stays[patch] = of;
      for (const uint32_t v : cut.fine->triangles[t]) stretch(boxes[patch], cut.fine->position[v]);
    }
    for (int64_t t = 0; t < triangles_.size; ++t) {
      if (!is_side(t)) continue;
      const PointQ8 low = rounded(boxes[patch_[size_t(t)]].min), high = rounded(boxes[patch_[size_t(t)]].max);
      const uint8_t of = stays[patch_[size_t(t)]];
      if (of > 0) {
        const size_t axis = size_t(of - 1) / 2;
        (of % 2 == 1 ? period_min_ : period_max_)[axis] = std::array{low.x, low.y, low.z}[axis];
      }
      const bool is_oblique = low.x != high.x && low.y != high.y && low.z != high.z;
      for (const uint32_t v : corners(t)) {
        if (is_oblique || of > 0) may_move_[v] = 0;
        if (low.x == high.x) at_[v].x = low.x, may_move_[v] &= uint8_t(~1);
        if (low.y == high.y) at_[v].y = low.y, may_move_[v] &= uint8_t(~2);
        if (low.z == high.z) at_[v].z = low.z, may_move_[v] &= uint8_t(~4);
      }
    }
  }
  bool is_side(int64_t t) const { return is_side_[patch_[size_t(t)]] != 0; }

  /// A part of the edges there are at each vertex, as their triangles have area.
  void bound_ways() {
    farthest_q8_.resize(at_.size());
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const View<const uint32_t> around = at_vertices_.in(int64_t(v));
      double doubled_area = 0;
      for (const uint32_t t : around) doubled_area += length(normal(t, before_));
      const double mean = doubled_area / double(std::max<int64_t>(around.size, 1));
      farthest_q8_[v] = int32_t(kFarthestOfEdge * std::sqrt(mean / (std::sqrt(3.) / 2)));
    });
  }

  /// Of each pair of regions that of its walls, in 1/256 voxel. A wall counts as much as it can move.
  std::vector<double> find_offsets() {
    std::vector<uint64_t> lacking = wanted_;
    for (WallsBetween& pair : pairs_) pair.area = 0;
    for (int64_t t = 0; t < triangles_.size; ++t) {
      const auto [a, b, c] = corners(t);
      WallsBetween& pair = pairs_[pair_of_patch_[patch_[size_t(t)]]];
      const uint64_t volume = spanned_volume(at_[a], at_[b], at_[c]);
      lacking[pair.region[0]] -= volume;
      lacking[pair.region[1]] += volume;
      const int moving = is_side(t) ? 0 : (may_move_[a] != 0) + (may_move_[b] != 0) + (may_move_[c] != 0);
      pair.area += (moving + kStaying) * length(normal(t, at_));  // of volumes six times
    }
    std::vector<double> volumes, offsets;
    for (const uint64_t of : lacking) volumes.push_back(double(int64_t(of)));
    const std::vector<double> pressure = pressures_of_regions(pairs_, std::move(volumes));
    for (const WallsBetween& pair : pairs_)
      offsets.push_back(
          std::clamp(pressure[pair.region[0]] - pressure[pair.region[1]], -kMostOffset_q8, kMostOffset_q8));
    return offsets;
  }

  /// By the mean of the offsets of the walls at a vertex that are not at sides, weighted by area.
  PointQ8 moved(size_t v, const std::vector<double>& offsets) const {
    WorldPoint way{0, 0, 0};
    double area = 0;
    for (const uint32_t t : at_vertices_.in(int64_t(v))) {
      if (is_side(t)) continue;
      const WorldPoint n = normal(t, at_);
      way = way + offsets[pair_of_patch_[patch_[t]]] * n;
      area += length(n);
    }
    if (area == 0) return at_[v];
    const auto along = [&](int axis, int32_t at, int32_t from, double by) {
      if ((may_move_[v] >> axis & 1) == 0) return at;
      const int32_t less = std::min(farthest_q8_[v], (from - period_min_[size_t(axis)]) / 2),
                    more = std::min(farthest_q8_[v], (period_max_[size_t(axis)] - from) / 2);
      return std::clamp(at + int32_t(std::floor(by / area + 0.5)), from - less, from + more);
    };
    const PointQ8 &p = at_[v], &from = before_[v];
    return {along(0, p.x, from.x, way.x), along(1, p.y, from.y, way.y), along(2, p.z, from.z, way.z)};
  }

  bool is_worse(int64_t t) const {
    const auto [a, b, c] = corners(t);
    if (is_same(at_[a], before_[a]) && is_same(at_[b], before_[b]) && is_same(at_[c], before_[c])) return false;
    if (dot(normal(t, at_), normal(t, before_)) <= 0) return true;
    const double sine = smallest_sine(point(at_[a]), point(at_[b]), point(at_[c]));
    return sine < kPoorSine && sine < smallest_sine(point(before_[a]), point(before_[b]), point(before_[c]));
  }

  View<const TriangleIndices> triangles_;
  const std::vector<uint32_t>& patch_;  ///< per triangle
  const std::vector<PointQ8> before_;
  std::vector<PointQ8> at_;
  std::vector<uint8_t> may_move_;     ///< per vertex a bit for each axis along which it may
  std::vector<int32_t> farthest_q8_;  ///< per vertex, along each of them
  Buckets<uint32_t> at_vertices_;     ///< triangles
  std::vector<uint64_t> wanted_;      ///< per region six times its volume, modulo 2^64
  std::vector<WallsBetween> pairs_;
  std::vector<uint32_t> pair_of_patch_;
  std::vector<uint8_t> is_side_;                                                           ///< per patch
  std::array<int32_t, 3> period_min_{-kFar, -kFar, -kFar}, period_max_{kFar, kFar, kFar};  ///< that all stay within
};

}  // namespace

void restore_volumes(const CutSurface& cut, const RegionWalls& walls, JoinedPatches& joined, Context& context) {
  run_with_threads(context, [&] {
    WallOffsets walls_of_result(cut, walls, joined);
    walls_of_result.mend(context);
    for (int mend = 0; mend < kMostMends; ++mend) {
      int offsets = 0;
      while (offsets < kMostOffsets && walls_of_result.offset()) ++offsets;
      if (offsets == 0) break;
      walls_of_result.mend(context);
    }
    const std::vector<PointQ8>& at = walls_of_result.positions();
    std::copy(at.begin(), at.end(), joined.mesh.position.begin());
  });
}

}  // namespace isoshell
