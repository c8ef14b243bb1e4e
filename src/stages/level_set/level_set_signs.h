// Which voxels near the surface are outside: those that paths along the lattice join with the outside first.
#pragma once

#include "stages/level_set/level_set_distances.h"
#include "stages/level_set/level_set_solid.h"

namespace isoshell::level_set_steps {

/// The last two are sides until a path says more.
enum Side : uint8_t { kOutside, kInside, kPerhapsInside, kPerhapsOutside };
ISOSHELL_HD inline bool is_open(uint8_t side) { return side >= kPerhapsInside; }

constexpr double kOnSurface = 1e-6;  ///< a voxel centre so near has no side, and no path goes through it
constexpr double kBulge = 0.25;      ///< a smoothed sheet may leave its solid, by less than this

/// What is in the solid and near its boundary is open, as closing and repair have put voxels there that lie outside of
/// the surface; sites are, too, and what a bulge of the surface may hold. All else has the side that the solid says.
struct SideBySolid {
  VoxelSetView candidates, sites, near_sheet;
  RowsOfSolid rows;
  View<const float> distance;
  View<uint8_t> side;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const Voxel at = leaf_of_key(candidates.leaf_key[leaf]);
    const LeafMask solid = rows.leaf_at(at);
    for_each_active(candidates, leaf, [&](int offset, int64_t i) {
      const Voxel v = voxel_at(at, offset);
      if (is_on(solid, offset))
        side[i] = find_voxel(near_sheet, v) >= 0 || find_voxel(sites, v) >= 0 ? kPerhapsInside : kInside;
      else
        side[i] = distance[i] < kBulge ? kPerhapsOutside : kOutside;
    });
  }
};

struct IsOpen {
  View<const uint8_t> side;
  ISOSHELL_HD bool operator()(int64_t i) const { return is_open(side[i]); }
};

/// A triangle seen along an axis.
class SeenTriangle {
 public:
  ISOSHELL_HD SeenTriangle(const WorldPoint* corner, int axis) {
    for (int i = 0; i < 3; ++i) {
      const double at[3] = {corner[i].x, corner[i].y, corner[i].z};
      u_[i] = at[(axis + 1) % 3], v_[i] = at[(axis + 2) % 3], depth_[i] = at[axis];
    }
  }

  /// Whether it meets the closed segment that is seen as the point (u, v), from one depth to a larger one. Corners and
  /// edges belong to it: the side of a point from an edge is the same for both triangles there, so nothing slips
  /// through between them. Of a triangle seen from its side all depths count.
  ISOSHELL_HD bool meets(double u, double v, double from, double to, double& depth) const {
    const double e[3] = {side(1, 2, u, v), side(2, 0, u, v), side(0, 1, u, v)};
    if (!(e[0] >= 0 && e[1] >= 0 && e[2] >= 0) && !(e[0] <= 0 && e[1] <= 0 && e[2] <= 0)) return false;
    const double sum = e[0] + e[1] + e[2];
    const double least = triangle_search::smaller(triangle_search::smaller(depth_[0], depth_[1]), depth_[2]),
                 most = triangle_search::larger(triangle_search::larger(depth_[0], depth_[1]), depth_[2]);
    if (sum == 0) {
      depth = triangle_search::larger(least, from);
      return least <= to && most >= from && is_within_box(u, v);
    }
    depth = (e[0] * depth_[0] + e[1] * depth_[1] + e[2] * depth_[2]) / sum;
    return depth >= from && depth <= to;
  }

 private:
  /// Of a point from an edge, with opposite signs for its two directions.
  ISOSHELL_HD double side(int a, int b, double u, double v) const {
    const bool turned = u_[b] < u_[a] || (u_[b] == u_[a] && v_[b] < v_[a]);
    const int p = turned ? b : a, q = turned ? a : b;
    const double area = (u_[q] - u_[p]) * (v - v_[p]) - (v_[q] - v_[p]) * (u - u_[p]);
    return turned ? -area : area;
  }
  ISOSHELL_HD bool is_within_box(double u, double v) const {
    using triangle_search::larger;
    using triangle_search::smaller;
    return u >= smaller(smaller(u_[0], u_[1]), u_[2]) && u <= larger(larger(u_[0], u_[1]), u_[2]) &&
           v >= smaller(smaller(v_[0], v_[1]), v_[2]) && v <= larger(larger(v_[0], v_[1]), v_[2]);
  }

  double u_[3], v_[3], depth_[3];
};

/// Which of the three steps from a voxel to a larger coordinate meet the surface, a bit each. Only steps between voxels
/// of which one is open matter.
struct BlockSteps {
  Triangles triangles;
  VoxelSetView candidates;
  View<const int64_t> first;
  View<const uint32_t> listed;
  View<const float> distance;
  View<const uint8_t> side;
  View<uint8_t> blocked;

  ISOSHELL_HD void operator()(int64_t leaf) const {
    const Voxel at = leaf_of_key(candidates.leaf_key[leaf]);
    for_each_active(candidates, leaf, [&](int offset, int64_t i) {
      const Voxel v = voxel_at(at, offset);
      unsigned looked_at = 0, met = 0;  // steps that may meet the surface, and that do
      for (int axis = 0; axis < 3; ++axis) {
        const int64_t next = find_voxel(candidates, next_along(v, axis, 1));
        if (next < 0 || (!is_open(side[i]) && !is_open(side[next]))) continue;
        constexpr float kStep = 1.001f;  // what a step meets is no farther from either end
        if (distance[i] > kStep || distance[next] > kStep) continue;
        const bool is_on_surface = distance[i] < kOnSurface || distance[next] < kOnSurface;
        (is_on_surface ? met : looked_at) |= 1u << axis;
      }
      blocked[i] = uint8_t(met | (looked_at != 0 ? met_of(looked_at, leaf, v) : 0));
    });
  }

  ISOSHELL_HD static Voxel next_along(Voxel v, int axis, int by) {
    return {v.x + (axis == 0 ? by : 0), v.y + (axis == 1 ? by : 0), v.z + (axis == 2 ? by : 0)};
  }

 private:
  ISOSHELL_HD unsigned met_of(unsigned left, int64_t leaf, Voxel v) const {
    const WorldPoint p = centre_of(v);
    unsigned met = 0;
    for (int64_t k = first[leaf]; k < first[leaf + 1] && left != 0; ++k) {
      const int64_t t = listed[k];
      if (!triangles.sphere[t].is_within(p, 1)) continue;
      for (int axis = 0; axis < 3; ++axis)
        if (left >> axis & 1 && meets(t, p, axis)) met |= 1u << axis, left &= ~(1u << axis);
    }
    return met;
  }

  ISOSHELL_HD bool meets(int64_t t, WorldPoint p, int axis) const {
    double at[3] = {p.x, p.y, p.z}, depth;
    if (!SeenTriangle(triangles.of(t), axis)
             .meets(at[(axis + 1) % 3], at[(axis + 2) % 3], at[axis], at[axis] + 1, depth))
      return false;
    at[axis] = depth;
    return triangles.counts(t, WorldPoint{at[0], at[1], at[2]});
  }
};

/// A round of the search: an open voxel takes the side that most of its neighbours in reach have; the inside where as
/// many have either.
struct SpreadSides {
  VoxelSetView candidates;
  View<const uint32_t> open;
  View<const uint8_t> side, blocked;
  View<uint8_t> found;
  ISOSHELL_HD void operator()(int64_t n) const {
    const int64_t i = open[n];
    found[n] = side[i];
    if (!is_open(side[i])) return;
    const Voxel v = voxel_of_index(candidates, i);
    int count[4] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const int64_t up = find_voxel(candidates, BlockSteps::next_along(v, axis, 1)),
                    down = find_voxel(candidates, BlockSteps::next_along(v, axis, -1));
      if (up >= 0 && !(blocked[i] >> axis & 1)) ++count[side[up]];
      if (down >= 0 && !(blocked[down] >> axis & 1)) ++count[side[down]];
    }
    if (count[kOutside] + count[kInside] > 0) found[n] = count[kOutside] > count[kInside] ? kOutside : kInside;
  }
};

struct TakeSides {
  View<const uint32_t> open;
  View<const uint8_t> found;
  View<uint8_t> side;
  ISOSHELL_HD void operator()(int64_t n) const { side[open[n]] = found[n]; }
};

}  // namespace isoshell::level_set_steps
