// The triangles that a level set measures to: where each lies, and which of its points count.
#pragma once

#include "geometry/triangle_search.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/leaf.h"

namespace isoshell::level_set_steps {

ISOSHELL_HD inline WorldPoint centre_of(Voxel v) { return {v.x + 0.5, v.y + 0.5, v.z + 0.5}; }

/// A disc that holds a triangle, and is a little larger than that needs. Without a normal, where the triangle has no
/// area to speak of, it is a ball.
struct Disc {
  WorldPoint middle, normal;
  double offset;  ///< of its plane: the normal times a point of it
  double radius;
  bool counts_whole;  ///< all points of the triangle count

  ISOSHELL_HD double height(WorldPoint p) const { return dot(normal, p) - offset; }
  /// False only for what is farther from all of the disc.
  ISOSHELL_HD bool is_within(WorldPoint p, double distance) const {
    const double reach = distance + kSlack, up = height(p), beside_sq = reach * reach - up * up;
    if (beside_sq < 0) return false;
    // Beside the plane: no farther from the middle than the radius and the root of beside_sq.
    const WorldPoint away = p - middle;
    const double rest = dot(away, away) - radius * radius - reach * reach;
    return rest <= 0 || rest * rest <= 4 * radius * radius * beside_sq;
  }
  /// The same for all points of a cube, by its middle.
  ISOSHELL_HD bool is_near_cube(WorldPoint centre, double half_side, double distance) const {
    const double reach = distance + kSlack,
                 tilt = half_side * (std::abs(normal.x) + std::abs(normal.y) + std::abs(normal.z));
    if (std::abs(height(centre)) > reach + tilt) return false;
    const auto outside = [&](double from) { return triangle_search::larger(std::abs(from) - half_side, 0); };
    const WorldPoint away{outside(middle.x - centre.x), outside(middle.y - centre.y), outside(middle.z - centre.z)};
    return dot(away, away) <= (radius + reach) * (radius + reach);
  }

  static constexpr double kSlack = 1e-6;  ///< in voxels: more than rounding can be
};

struct FindDisc {
  View<const WorldPoint> corner;
  int64_t first_of_sheet;
  VoxelSetView near_sheet;
  View<Disc> disc;
  ISOSHELL_HD void operator()(int64_t t) const {
    using triangle_search::larger;
    using triangle_search::smaller;
    const WorldPoint a = corner[3 * t], b = corner[3 * t + 1], c = corner[3 * t + 2];
    const auto radius_at = [&](WorldPoint m) {
      return larger(larger(length(a - m), length(b - m)), length(c - m)) + Disc::kSlack;
    };
    Disc made{};
    made.middle = (1 / 3.0) * (a + b + c);
    made.radius = radius_at(made.middle);
    // An edge's middle is better for triangles with a right or obtuse angle.
    for (const WorldPoint m : {0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)})
      if (const double radius = radius_at(m); radius < made.radius) made.middle = m, made.radius = radius;
    constexpr double kFlat = 1e-10;  // squared sine of an angle: rounding may turn what is flatter
    const WorldPoint ab = b - a, ac = c - a, up = cross(ab, ac);
    const double size_sq = dot(up, up);
    if (size_sq > kFlat * dot(ab, ab) * dot(ac, ac)) made.normal = (1 / std::sqrt(size_sq)) * up;
    made.offset = dot(made.normal, a);
    const WorldPoint low{smaller(smaller(a.x, b.x), c.x), smaller(smaller(a.y, b.y), c.y),
                         smaller(smaller(a.z, b.z), c.z)};
    const WorldPoint high{larger(larger(a.x, b.x), c.x), larger(larger(a.y, b.y), c.y), larger(larger(a.z, b.z), c.z)};
    made.counts_whole = t >= first_of_sheet || is_near(low, high);
    disc[t] = made;
  }

 private:
  /// Whether all voxels of a small box are near the sheet.
  ISOSHELL_HD bool is_near(WorldPoint low, WorldPoint high) const {
    constexpr int64_t kMostVoxels = 512;  // few triangles with larger boxes are in one leaf
    const Voxel first{int32_t(low.x), int32_t(low.y), int32_t(low.z)},
        last{int32_t(high.x), int32_t(high.y), int32_t(high.z)};
    if (int64_t(last.x - first.x + 1) * (last.y - first.y + 1) * (last.z - first.z + 1) > kMostVoxels) return false;
    for (int32_t x = first.x >> 3; x <= last.x >> 3; ++x)
      for (int32_t y = first.y >> 3; y <= last.y >> 3; ++y)
        for (int32_t z = first.z >> 3; z <= last.z >> 3; ++z)
          if (!has_all({x, y, z}, first, last)) return false;
    return true;
  }

  /// Whether all voxels of a box that are in a leaf are near the sheet.
  ISOSHELL_HD bool has_all(Voxel at, Voxel first, Voxel last) const {
    const uint32_t leaf = find_leaf(near_sheet, at);
    if (leaf == kNone) return false;
    const auto from = [](int32_t lo, int32_t of_leaf) { return lo > 8 * of_leaf ? lo - 8 * of_leaf : 0; };
    const auto to = [](int32_t hi, int32_t of_leaf) { return hi < 8 * of_leaf + 7 ? hi - 8 * of_leaf : 7; };
    const uint64_t row = ((2ull << to(last.z, at.z)) - 1) & ~((1ull << from(first.z, at.z)) - 1);
    uint64_t plane = 0;
    for (int y = from(first.y, at.y); y <= to(last.y, at.y); ++y) plane |= row << (8 * y);
    for (int x = from(first.x, at.x); x <= to(last.x, at.x); ++x)
      if (plane & ~near_sheet.mask[leaf].word[x]) return false;
    return true;
  }
};

/// The triangles, and which of their points count.
struct Triangles {
  View<const WorldPoint> corner;  ///< see LevelSetSurface
  View<const Disc> disc;
  VoxelSetView near_sheet;

  ISOSHELL_HD int64_t count() const { return corner.size / 3; }
  ISOSHELL_HD const WorldPoint* of(int64_t t) const { return &corner[3 * t]; }
  ISOSHELL_HD MeshPoint nearest(WorldPoint p, int64_t t) const {
    const WorldPoint* const c = of(t);
    return nearest_of_triangle(p, c[0], c[1], c[2]);
  }
  ISOSHELL_HD bool counts(int64_t t, WorldPoint at) const {
    return disc[t].counts_whole || find_voxel(near_sheet, {int32_t(at.x), int32_t(at.y), int32_t(at.z)}) >= 0;
  }
  ISOSHELL_HD bool counts(int64_t t, const MeshPoint& place) const {
    const WorldPoint* const c = of(t);
    return counts(t, c[0] + place.b_part * (c[1] - c[0]) + place.c_part * (c[2] - c[0]));
  }
};

}  // namespace isoshell::level_set_steps
