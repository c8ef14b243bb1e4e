// Which steps along the lattice meet the surface.
#pragma once

#include "stages/level_set/level_set_beside.h"
#include "stages/level_set/level_set_lists.h"

namespace isoshell::level_set_steps {

constexpr float kOnSurface = 1e-6f;     ///< a voxel centre so near has no side, and no path goes through it
constexpr float kLongestStep = 1.001f;  ///< what a step meets is no farther from either end

/// Three masks a leaf, one for each axis, all of an axis together: bits of the steps from voxels to larger coordinates.
template <class Mask>
ISOSHELL_HD View<Mask> blocked_steps(View<Mask> steps, int axis) {
  const int64_t leaves = steps.size / 3;
  return steps.part(axis * leaves, leaves);
}

/// Which steps matter, that is those between voxels of which one is open, and may meet a triangle. Steps to and from
/// what lies on the surface are blocked.
struct FindOpenSteps {
  View<const LeafMask> candidates;
  View<const uint32_t> beside;
  View<const LeafMask> outside, inside, on_surface, near;
  View<LeafMask> open_steps, blocked;
  ISOSHELL_HD void operator()(int64_t i) const {
    const PlaneOfLeaf plane{beside, i >> 3, int(i & 7)};
    const uint64_t all = plane.of(candidates), open = all & ~(plane.of(outside) | plane.of(inside)),
                   near_here = plane.of(near), on_surface_here = plane.of(on_surface);
    for (int axis = 0; axis < 3; ++axis) {
      uint64_t steps = near_here, met = 0;
      if (steps) {
        const uint64_t open_ahead =
            plane.ahead(candidates, axis) & ~(plane.ahead(outside, axis) | plane.ahead(inside, axis));
        steps &= plane.ahead(near, axis) & (open | open_ahead);
        met = steps & (on_surface_here | plane.ahead(on_surface, axis));
      }
      blocked_steps(open_steps, axis)[plane.leaf].word[plane.x] = steps & ~met;
      blocked_steps(blocked, axis)[plane.leaf].word[plane.x] = met;
    }
  }
};

/// Coordinates by their axis, which is known when it is compiled.
template <int kAxis, class Point>
ISOSHELL_HD auto along(const Point& p) {
  if constexpr (kAxis % 3 == 0)
    return p.x;
  else if constexpr (kAxis % 3 == 1)
    return p.y;
  else
    return p.z;
}
/// From those along the axis and the two that follow it.
template <int kAxis, class Point, class Number>
ISOSHELL_HD Point from_axis(Number depth, Number u, Number v) {
  if constexpr (kAxis == 0)
    return {depth, u, v};
  else if constexpr (kAxis == 1)
    return {v, depth, u};
  else
    return {u, v, depth};
}

/// From the first to the last, among 0 to 7.
struct Numbers {
  int first, last;
};

/// How a triangle meets a line.
struct Meeting {
  enum class How { none, at_depth, along_depth };
  How how;
  double depth;
};

/// A triangle seen along an axis.
template <int kAxis>
class SeenTriangle {
 public:
  ISOSHELL_HD explicit SeenTriangle(const WorldPoint* corner) {
    for (int i = 0; i < 3; ++i)
      u_[i] = along<kAxis + 1>(corner[i]), v_[i] = along<kAxis + 2>(corner[i]), depth_[i] = along<kAxis>(corner[i]);
  }

  /// How it meets what is seen as the point (u, v). Corners and edges belong to it: the side of a
  /// point from an edge is the same for both triangles there, so nothing slips through between them.
  ISOSHELL_HD Meeting meet(double u, double v) const {
    const double e[3] = {side(1, 2, u, v), side(2, 0, u, v), side(0, 1, u, v)};
    if (!(e[0] >= 0 && e[1] >= 0 && e[2] >= 0) && !(e[0] <= 0 && e[1] <= 0 && e[2] <= 0))
      return {Meeting::How::none, 0};
    const double sum = e[0] + e[1] + e[2];
    if (sum == 0) return {Meeting::How::along_depth, 0};
    return {Meeting::How::at_depth, (e[0] * depth_[0] + e[1] * depth_[1] + e[2] * depth_[2]) / sum};
  }

  /// Voxels of a leaf that begins at `origin` whose centres may be met; and those whose steps may be.
  ISOSHELL_HD Numbers rows(int32_t origin) const { return numbers(u_, origin, 0); }
  ISOSHELL_HD Numbers columns(int32_t origin) const { return numbers(v_, origin, 0); }
  ISOSHELL_HD Numbers steps(int32_t origin) const { return numbers(depth_, origin, 1); }

 private:
  /// Of a point from an edge, with opposite signs for its two directions.
  ISOSHELL_HD double side(int a, int b, double u, double v) const {
    const bool turned = u_[b] < u_[a] || (u_[b] == u_[a] && v_[b] < v_[a]);
    const double pu = turned ? u_[b] : u_[a], pv = turned ? v_[b] : v_[a], qu = turned ? u_[a] : u_[b],
                 qv = turned ? v_[a] : v_[b];
    const double area = (qu - pu) * (v - pv) - (qv - pv) * (u - pu);
    return turned ? -area : area;
  }
  ISOSHELL_HD static Numbers numbers(const double* at, int32_t origin, int length) {
    using triangle_search::larger;
    using triangle_search::smaller;
    constexpr double kSlack = 1e-6;
    const double least = smaller(smaller(at[0], at[1]), at[2]) - kSlack - origin - 0.5 - length,
                 most = larger(larger(at[0], at[1]), at[2]) + kSlack - origin - 0.5;
    return {int(std::ceil(smaller(larger(least, 0), 8))), int(std::floor(larger(smaller(most, 7), -1)))};
  }

  double u_[3], v_[3], depth_[3];
};

/// Lines of voxels of a leaf along an axis, by the coordinates along the two axes that follow it.
template <int kAxis>
class LinesOfLeaf {
 public:
  ISOSHELL_HD explicit LinesOfLeaf(const LeafMask& mask) : mask_(mask) {
    if constexpr (kAxis == 0)
      for (const uint64_t word : mask.word) all_ |= word;
  }
  /// Whether the mask has a voxel of the line.
  ISOSHELL_HD bool any(int u, int v) const {
    if constexpr (kAxis == 0)
      return (all_ >> (8 * u + v) & 1) != 0;
    else if constexpr (kAxis == 1)
      return (mask_.word[v] >> u & 0x0101010101010101ull) != 0;
    else
      return (mask_.word[u] >> (8 * v) & 255) != 0;
  }

 private:
  const LeafMask& mask_;
  uint64_t all_ = 0;
};

/// Finds the open steps of a leaf that its triangles meet.
struct BlockSteps {
  Triangles triangles;
  View<const uint64_t> leaf_key;
  View<const int64_t> first;
  View<const uint32_t> listed;
  View<const LeafMask> open_steps;
  View<LeafMask> blocked;

  ISOSHELL_HD void operator()(int64_t leaf) const {
    const unsigned axes = open_axes(leaf);
    if (axes == 0) return;
    const Voxel origin = voxel_at(leaf_of_key(leaf_key[leaf]), 0);
    for (int64_t k = first[leaf]; k < first[leaf + 1]; ++k)
      if (may_meet(origin, listed[k])) block(leaf, origin, axes, listed[k]);
  }

  /// Along which axes the leaf has open steps, a bit each.
  ISOSHELL_HD unsigned open_axes(int64_t leaf) const {
    unsigned axes = 0;
    for (int axis = 0; axis < 3; ++axis) {
      uint64_t any = 0;
      for (const uint64_t word : blocked_steps(open_steps, axis)[leaf].word) any |= word;
      if (any) axes |= 1u << axis;
    }
    return axes;
  }

  /// Whether a triangle may meet steps of the leaf.
  ISOSHELL_HD bool may_meet(Voxel origin, int64_t t) const {
    constexpr double kFarthest = 1.5;  // from voxel centres to what their steps meet, and more than rounding
    return triangles.disc[t].is_near_cube({origin.x + 4.0, origin.y + 4.0, origin.z + 4.0}, 3.5, kFarthest);
  }

  /// The steps that one triangle meets; of `parts` calls, each looks at its part.
  ISOSHELL_HD void block(int64_t leaf, Voxel origin, unsigned axes, int64_t t, int part = 0, int parts = 1) const {
    if (axes & 1) block_along<0>(leaf, origin, t, part, parts);
    if (axes & 2) block_along<1>(leaf, origin, t, part, parts);
    if (axes & 4) block_along<2>(leaf, origin, t, part, parts);
  }

 private:
  template <int kAxis>
  ISOSHELL_HD void block_along(int64_t leaf, Voxel origin, int64_t t, int part, int parts) const {
    const int32_t from = along<kAxis>(origin), from_u = along<kAxis + 1>(origin), from_v = along<kAxis + 2>(origin);
    const SeenTriangle<kAxis> seen(triangles.of(t));
    const Numbers rows = seen.rows(from_u), columns = seen.columns(from_v), steps = seen.steps(from);
    if (steps.first > steps.last || rows.first > rows.last || columns.first > columns.last) return;
    const int across = columns.last - columns.first + 1, lines = (rows.last - rows.first + 1) * across;
    const LinesOfLeaf<kAxis> open(blocked_steps(open_steps, kAxis)[leaf]);
    for (int line = part; line < lines; line += parts) {
      const int u = rows.first + line / across, v = columns.first + line % across;
      if (!open.any(u, v)) continue;
      const Meeting met = seen.meet(from_u + u + 0.5, from_v + v + 0.5);
      if (met.how == Meeting::How::none) continue;
      Numbers may = steps;
      if (met.how == Meeting::How::at_depth) {
        const int begins = int(std::floor(met.depth - from - 0.5));
        if (may.first < begins - 1) may.first = begins - 1;
        if (may.last > begins + 1) may.last = begins + 1;
      }
      for (int step = may.first; step <= may.last; ++step)
        block_step<kAxis>(leaf, from_axis<kAxis, Voxel>(from + step, from_u + u, from_v + v), t, met);
    }
  }

  template <int kAxis>
  ISOSHELL_HD void block_step(int64_t leaf, Voxel voxel, int64_t t, const Meeting& met) const {
    const int offset = offset_in_leaf(voxel);
    if (!is_on(blocked_steps(open_steps, kAxis)[leaf], offset)) return;
    const WorldPoint p = centre_of(voxel);
    const double from = along<kAxis>(p), u = along<kAxis + 1>(p), v = along<kAxis + 2>(p);
    bool is_met;
    if (met.how == Meeting::How::at_depth) {
      is_met = met.depth >= from && met.depth <= from + 1 &&
               triangles.counts(t, from_axis<kAxis, WorldPoint>(met.depth, u, v));
    } else {  // The step lies in the triangle's plane.
      const MeshPoint place = triangles.nearest(from_axis<kAxis, WorldPoint>(from + 0.5, u, v), t);
      is_met = place.distance_sq <= 0.25 && triangles.counts(t, place);
    }
    uint64_t& word = blocked_steps(blocked, kAxis)[leaf].word[offset >> 6];
    if (is_met) atomic_or(word, uint64_t(1) << (offset & 63));
  }
};

}  // namespace isoshell::level_set_steps
