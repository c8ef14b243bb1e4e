// The input triangle nearest to a position, searched among the sites around it.
#pragma once

#include "isoshell/advanced/site_set.h"
#include "voxel/closest_point.h"
#include "voxel/leaf.h"

namespace isoshell {

/// The surface as its sites see it.
struct SitedSurfaceView {
  View<const PointQ8> points;
  View<const TriangleIndices> triangles;
  VoxelSetView sites;
  View<const int64_t> site_first;  ///< see SiteSamples::first
  View<const uint32_t> site_triangles;
};

/// Smallest (squared distance, triangle) found so far.
struct NearestTriangle {
  int64_t distance_sq_q16 = INT64_MAX;
  uint32_t triangle = kNone;
  PointQ8 point = {0, 0, 0};
};

/// Looks at every site in a cube of voxels around a position, nearest voxels first, and skips those that cannot matter.
class NearestTriangleSearch {
 public:
  ISOSHELL_HD NearestTriangleSearch(const SitedSurfaceView& surface, PointQ8 p) : surface_(surface), p_(p) {
    for (uint32_t& t : seen_) t = kNone;
  }

  ISOSHELL_HD const NearestTriangle& best() const { return best_; }

  /// Searches the cube of (2 reach + 1)^3 voxels around the position's. Returns whether best() is now the nearest
  /// triangle of the whole surface: what lies beyond the cube is farther. Reaches must grow.
  ISOSHELL_HD bool search(int32_t reach) {
    const Voxel at = {p_.x >> kFractionBits, p_.y >> kFractionBits, p_.z >> kFractionBits};
    const Range x = within_best(p_.x, at.x, reach), y = within_best(p_.y, at.y, reach),
                z = within_best(p_.z, at.z, reach);
    const int32_t farthest = x.farthest() + y.farthest() + z.farthest();
    const bool anew = x.farthest() > searched_ || y.farthest() > searched_ || z.farthest() > searched_;
    for (int32_t ring = searched_ + 1; anew && ring <= farthest; ++ring)
      for (int32_t i = x.lo; i <= x.hi; ++i) {
        const int32_t left = ring - (i < 0 ? -i : i);
        if (left < 0) continue;
        for (int32_t j = y.lo; j <= y.hi; ++j) {
          const int32_t k = left - (j < 0 ? -j : j);
          if (k < 0 || k > z.farthest() || is_searched(i, j, k)) continue;
          if (-k >= z.lo) look_at({at.x + i, at.y + j, at.z - k});
          if (k > 0 && k <= z.hi) look_at({at.x + i, at.y + j, at.z + k});
        }
      }
    searched_ = reach;
    const int64_t sure = margin_q8(reach);
    return best_.distance_sq_q16 <= sure * sure;
  }

 private:
  /// Distance within which everything lies in the cube, less one for the rounding of closest points.
  ISOSHELL_HD int64_t margin_q8(int32_t reach) const {
    int64_t margin = kOneVoxelQ8;
    const int32_t c[3] = {p_.x & (kOneVoxelQ8 - 1), p_.y & (kOneVoxelQ8 - 1), p_.z & (kOneVoxelQ8 - 1)};
    for (const int32_t f : c) {
      margin = margin < f ? margin : f;
      margin = margin < kOneVoxelQ8 - f ? margin : kOneVoxelQ8 - f;
    }
    return margin + int64_t(reach) * kOneVoxelQ8 - 1;
  }
  /// Distance along an axis to a voxel, which is widened by the rounding of closest points.
  ISOSHELL_HD static int32_t gap(int32_t p, int32_t voxel) {
    const int32_t lo = voxel * kOneVoxelQ8 - 1, hi = (voxel + 1) * kOneVoxelQ8 + 1;
    return p < lo ? lo - p : p > hi ? p - hi : 0;
  }
  /// Steps along an axis from the position's voxel to those that the cube has and that are not farther than best().
  struct Range {
    int32_t lo, hi;
    ISOSHELL_HD int32_t farthest() const { return -lo > hi ? -lo : hi; }
  };
  ISOSHELL_HD Range within_best(int32_t p, int32_t voxel, int32_t reach) const {
    Range range = {-reach, reach};
    while (range.lo < 0 && is_beyond_best(gap(p, voxel + range.lo))) ++range.lo;
    while (range.hi > 0 && is_beyond_best(gap(p, voxel + range.hi))) --range.hi;
    return range;
  }
  ISOSHELL_HD bool is_beyond_best(int32_t distance) const { return distance * distance > best_.distance_sq_q16; }
  /// Whether a search before had the voxel in its cube.
  ISOSHELL_HD bool is_searched(int32_t i, int32_t j, int32_t k) const {
    return i >= -searched_ && i <= searched_ && j >= -searched_ && j <= searched_ && k <= searched_;
  }
  /// Squared distance to a voxel of a cube. Cubes reach 16 voxels, so 32 bits hold it.
  ISOSHELL_HD int64_t distance_sq_to(Voxel v) const {
    const int32_t x = gap(p_.x, v.x), y = gap(p_.y, v.y), z = gap(p_.z, v.z);
    return x * x + y * y + z * z;
  }
  ISOSHELL_HD void look_at(Voxel v) {
    if (distance_sq_to(v) > best_.distance_sq_q16) return;
    const int64_t site = find_voxel(surface_.sites, v);
    if (site < 0) return;
    for (int64_t i = surface_.site_first[site]; i < surface_.site_first[site + 1]; ++i)
      look_at_triangle(surface_.site_triangles[i]);
  }
  ISOSHELL_HD void look_at_triangle(uint32_t t) {
    uint32_t& seen = seen_[t % kSeen];
    if (seen == t) return;
    seen = t;
    const TriangleIndices& corner = surface_.triangles[t];
    const PointQ8 q =
        closest_point_on_triangle(p_, surface_.points[corner.a], surface_.points[corner.b], surface_.points[corner.c]);
    const int64_t d = distance_sq_q16(p_, q);
    if (d < best_.distance_sq_q16 || (d == best_.distance_sq_q16 && t < best_.triangle)) best_ = {d, t, q};
  }

  static constexpr uint32_t kSeen = 16;
  SitedSurfaceView surface_;
  PointQ8 p_;
  NearestTriangle best_;
  int32_t searched_ = -1;  ///< reach of the largest cube that was searched
  uint32_t seen_[kSeen];   ///< triangles share voxels: most would be met again at once
};

}  // namespace isoshell
