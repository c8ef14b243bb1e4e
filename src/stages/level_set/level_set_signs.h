// Which voxels near the surface are outside: those that paths along the lattice join with the outside first. All of it
// is in bits, a plane of a leaf at a time.
#pragma once

#include "stages/level_set/level_set_beside.h"
#include "stages/level_set/level_set_crossings.h"
#include "stages/level_set/level_set_solid.h"

namespace isoshell {
namespace level_set_steps {

constexpr float kBulge = 0.25f;  ///< a smoothed sheet may leave its solid, by less than this

/// What the solid and the distances say of a candidate.
struct SidesBySolid {
  View<LeafMask> solid, outside, inside;  ///< neither outside nor inside: open, until a path says more
  View<LeafMask> on_surface, near;        ///< less than kOnSurface from the surface, and no more than a step
};

/// What is in the solid and near its boundary is open, as closing and repair have put voxels there that lie outside of
/// the surface; sites are, too, and what a bulge of the surface may hold. All else has the side that the solid says.
struct FindSidesBySolid {
  VoxelSetView candidates, sites, near_sheet;
  RowsOfSolid rows;
  View<const float> distance;
  SidesBySolid sides;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t leaf = i >> 3;
    const int x = int(i & 7);
    const Voxel at = leaf_of_key(candidates.leaf_key[leaf]);
    const LeafMask& mask = candidates.mask[leaf];
    const uint64_t all = mask.word[x], solid = all & rows.plane_at(at, x);
    uint64_t bulge = 0, on_surface = 0, near = 0;
    int64_t voxel = candidates.first[leaf] + rank_of_plane(mask, x);
    for (uint64_t bits = all; bits; bits &= bits - 1, ++voxel) {
      const uint64_t bit = bits & ~(bits - 1);
      if (distance[voxel] < kBulge) bulge |= bit;
      if (distance[voxel] < kOnSurface) on_surface |= bit;
      if (distance[voxel] <= kLongestStep) near |= bit;
    }
    sides.solid[leaf].word[x] = solid;
    sides.outside[leaf].word[x] = all & ~solid & ~bulge;
    sides.inside[leaf].word[x] = solid & ~(solid ? plane_at(near_sheet, at, x) | plane_at(sites, at, x) : 0);
    sides.on_surface[leaf].word[x] = on_surface;
    sides.near[leaf].word[x] = near;
  }
};

/// Numbers up to 7, one for each of 64 voxels.
class BitCounts {
 public:
  ISOSHELL_HD void add(uint64_t one) {
    const uint64_t twos = ones_ & one, fours = twos_ & twos;
    ones_ ^= one;
    twos_ ^= twos;
    fours_ |= fours;
  }
  ISOSHELL_HD uint64_t any() const { return ones_ | twos_ | fours_; }
  ISOSHELL_HD uint64_t larger_than(const BitCounts& other) const {
    const uint64_t ones = ones_ & ~other.ones_, twos = (twos_ & ~other.twos_) | (~(twos_ ^ other.twos_) & ones);
    return (fours_ & ~other.fours_) | (~(fours_ ^ other.fours_) & twos);
  }

 private:
  uint64_t ones_ = 0, twos_ = 0, fours_ = 0;
};

/// A round of the search: an open voxel takes the side that most of its neighbours in reach have; the inside where as
/// many have either.
struct SpreadSides {
  View<const LeafMask> candidates;
  View<const uint32_t> beside;
  View<const LeafMask> outside, inside, blocked;
  View<LeafMask> next_outside, next_inside;
  ISOSHELL_HD void operator()(int64_t i) const {
    const PlaneOfLeaf plane{beside, i >> 3, int(i & 7)};
    const uint64_t was_outside = plane.of(outside), was_inside = plane.of(inside);
    uint64_t to_outside = 0, to_inside = 0;
    if (const uint64_t open = plane.of(candidates) & ~(was_outside | was_inside)) {
      BitCounts outer, inner;
      for (int axis = 0; axis < 3; ++axis) {
        const View<const LeafMask> blocked_along = blocked_steps(blocked, axis);
        const uint64_t ahead = ~plane.of(blocked_along), behind = ~plane.behind(blocked_along, axis);
        outer.add(plane.ahead(outside, axis) & ahead);
        outer.add(plane.behind(outside, axis) & behind);
        inner.add(plane.ahead(inside, axis) & ahead);
        inner.add(plane.behind(inside, axis) & behind);
      }
      to_outside = open & outer.larger_than(inner);
      to_inside = open & (outer.any() | inner.any()) & ~to_outside;
    }
    next_outside[plane.leaf].word[plane.x] = was_outside | to_outside;
    next_inside[plane.leaf].word[plane.x] = was_inside | to_inside;
  }
};

/// What is still open has the side that the solid says.
struct CloseSides {
  View<const LeafMask> candidates, solid, outside;
  View<LeafMask> inside;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t leaf = i >> 3;
    const int x = int(i & 7);
    inside[leaf].word[x] |= candidates[leaf].word[x] & ~outside[leaf].word[x] & solid[leaf].word[x];
  }
};

/// The candidates that are inside.
template <class Exec>
Buffer<LeafMask> find_inside(Exec& exec, const Triangles& triangles, const Lists& lists, const VoxelSetView& candidates,
                             const VoxelSetView& sites, const RowsOfSolid& rows, View<const float> distance,
                             int32_t rounds) {
  const int64_t leaves = candidates.leaf_key.size, planes = 8 * leaves;
  const auto masks = [&](int64_t of_leaf) { return exec.template make<LeafMask>(of_leaf * leaves); };
  Buffer<LeafMask> solid = masks(1), outside = masks(1), inside = masks(1), on_surface = masks(1), near = masks(1);
  exec.for_each("sides by solid", planes,
                FindSidesBySolid{candidates,
                                 sites,
                                 triangles.near_sheet,
                                 rows,
                                 distance,
                                 {solid.view(), outside.view(), inside.view(), on_surface.view(), near.view()}});
  Buffer<uint32_t> beside = exec.template make<uint32_t>(6 * leaves);
  exec.for_each("leaves beside", beside.size(), FindLeavesBeside{candidates, beside.view()});
  Buffer<LeafMask> open_steps = masks(3), blocked = masks(3);
  exec.for_each("open steps", planes,
                FindOpenSteps{candidates.mask, beside.view(), outside.view(), inside.view(), on_surface.view(),
                              near.view(), open_steps.view(), blocked.view()});
  exec.for_each("block steps", leaves,
                BlockSteps{triangles, candidates.leaf_key, lists.first.view(), lists.triangle.view(), open_steps.view(),
                           blocked.view()});
  Buffer<LeafMask> next_outside = masks(1), next_inside = masks(1);
  for (int32_t round = 0; round < rounds; ++round) {
    exec.for_each("spread sides", planes,
                  SpreadSides{candidates.mask, beside.view(), outside.view(), inside.view(), blocked.view(),
                              next_outside.view(), next_inside.view()});
    std::swap(outside, next_outside);
    std::swap(inside, next_inside);
  }
  exec.for_each("close sides", planes, CloseSides{candidates.mask, solid.view(), outside.view(), inside.view()});
  return inside;
}

}  // namespace level_set_steps
}  // namespace isoshell
