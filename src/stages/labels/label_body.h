// Nearest seed of every vertex of a surface, exact (paper section 3.2, on the surface).
//
// Result: label = minimum of (squared distance + penalty, seed id) over the seeds of the vertex's patch. The penalty,
// 16 h^2, is paid by a seed that sits on the other side of a thin wall (normals at more than about 104 degrees), so
// that each side keeps its own seeds. On borders with fixed seeds the label is prescribed. A block gathers the seeds
// that can win inside its box, each of its octants keeps those that can win inside its own box, and its vertices
// compare those. A seed can win when its smallest cost over the box is not above the smallest of the seeds' largest
// costs.
#pragma once

#include <algorithm>

#include "isoshell/advanced/seed_set.h"
#include "stages/labels/edge_lengths.h"
#include "stages/labels/patch_labels.h"
#include "stages/sparse/point_grid_body.h"

namespace isoshell {

/// Sum of the doubled areas of the surface's triangles, q16.
template <class Exec>
int64_t doubled_area_q16(Exec& exec, const SurfaceMesh& surface);

/// Seed spacing and what follows from it. Where lengths vary it is that of the least length.
struct SeedSpacing {
  int64_t h_sq_q16;     ///< area per seed
  int64_t h_q8;         ///< its square root
  int64_t penalty_q16;  ///< 16 h^2; 16 times the least h times the largest where they vary
  int64_t largest_h_q8;
  int64_t area2_q16;  ///< of the surface, doubled
  EdgeLengthsView lengths;

  ISOSHELL_HD int64_t h_at(uint32_t vertex) const { return lengths.scaled(h_q8, vertex); }
};
template <class Exec>
SeedSpacing seed_spacing(Exec& exec, const SurfaceMesh& surface, int64_t seeds);

namespace label {

constexpr int32_t kOpposite = -127 * 127 / 4;  ///< dot products below this are opposite sides
constexpr int kMaxCandidates = 256;            ///< per block; more take the exact slow path
constexpr int kMembers = 64;                   ///< vertices of an octant that are compared together

/// Smallest and largest of the vertices' positions and normals.
struct Bounds {
  PointQ8 lo, hi;
  Normal8 normal_lo, normal_hi;
};

ISOSHELL_HD inline Bounds empty_bounds() {
  return {{INT32_MAX, INT32_MAX, INT32_MAX}, {INT32_MIN, INT32_MIN, INT32_MIN}, {127, 127, 127}, {-127, -127, -127}};
}
template <class T>
ISOSHELL_HD inline void widen(T& lo, T& hi, T value) {
  if (value < lo) lo = value;
  if (value > hi) hi = value;
}
ISOSHELL_HD inline void include(Bounds& b, PointQ8 p, Normal8 n) {
  widen(b.lo.x, b.hi.x, p.x);
  widen(b.lo.y, b.hi.y, p.y);
  widen(b.lo.z, b.hi.z, p.z);
  widen(b.normal_lo.x, b.normal_hi.x, n.x);
  widen(b.normal_lo.y, b.normal_hi.y, n.y);
  widen(b.normal_lo.z, b.normal_hi.z, n.z);
}

/// Smallest and largest cost of a seed over the bounds.
struct CostRange {
  int64_t lo, hi;
  bool may_oppose;
};
ISOSHELL_HD inline CostRange cost_range(const Bounds& b, PointQ8 p, Normal8 n, int64_t penalty) {
  const auto axis = [](int32_t s, int32_t lo, int32_t hi, int64_t& near_sq, int64_t& far_sq) {
    const int64_t to_lo = int64_t(s) - lo, to_hi = int64_t(hi) - s;
    const int64_t outside = to_lo < 0 ? -to_lo : (to_hi < 0 ? -to_hi : 0);
    const int64_t far = to_lo > to_hi ? to_lo : to_hi;
    near_sq += outside * outside;
    far_sq += far * far;
  };
  int64_t near_sq = 0, far_sq = 0;
  axis(p.x, b.lo.x, b.hi.x, near_sq, far_sq);
  axis(p.y, b.lo.y, b.hi.y, near_sq, far_sq);
  axis(p.z, b.lo.z, b.hi.z, near_sq, far_sq);
  const auto product = [](int8_t s, int8_t lo, int8_t hi, int32_t& least, int32_t& most) {
    const int32_t a = int32_t(s) * lo, c = int32_t(s) * hi;
    least += a < c ? a : c;
    most += a < c ? c : a;
  };
  int32_t least = 0, most = 0;
  product(n.x, b.normal_lo.x, b.normal_hi.x, least, most);
  product(n.y, b.normal_lo.y, b.normal_hi.y, least, most);
  product(n.z, b.normal_lo.z, b.normal_hi.z, least, most);
  const bool may = least < kOpposite;
  return {near_sq + (most < kOpposite ? penalty : 0), far_sq + (may ? penalty : 0), may};
}

/// A seed as labelling compares it.
struct LabelSeed {
  PointQ8 position;
  uint32_t id;
  Normal8 normal;
};

ISOSHELL_HD inline int64_t cost(PointQ8 v, Normal8 n, const LabelSeed& s, int64_t penalty) {
  return distance_sq_q16(v, s.position) + (dot(n, s.normal) < kOpposite ? penalty : 0);
}

/// Labels the vertices of one block.
template <int kCapacity = kMaxCandidates>
struct LabelBlock {
  VertexBlocksView blocks;
  View<const PointQ8> position;
  View<const Normal8> normal;
  PointGridView grid;
  View<const Normal8> seed_normal;
  SeedSpacing spacing;
  View<uint32_t> out;
  PatchesView patches = {};

  ISOSHELL_HD void operator()(int64_t block) const {
    const int64_t begin = blocks.first[block], end = blocks.first[block + 1];
    Bounds bounds = empty_bounds();
    for (int64_t v = begin; v < end; ++v) include(bounds, position[v], normal[v]);
    LabelSeed candidates[kCapacity];
    int64_t limit;
    const int count = gather(begin, bounds, candidates, limit);
    if (count > kCapacity) return label_directly(limit, begin, end);
    label_from(block, candidates, count);
  }

  /// The seeds that can win in the box around a vertex and others of its block, and the limit that no label's cost
  /// exceeds: the smallest of the seeds' largest costs, taken over those in reach; the spacing says how far to look
  /// first. Returns more than kCapacity when they do not fit.
  ISOSHELL_HD int gather(int64_t vertex, const Bounds& bounds, LabelSeed* candidates, int64_t& limit) const {
    const uint32_t patch = patches.at(vertex);
    const int64_t h_q8 = spacing.h_at(uint32_t(vertex));
    const int64_t diagonal = int64_t(isqrt(uint64_t(distance_sq_q16(bounds.lo, bounds.hi))));
    for (int64_t reach = diagonal / 2 + h_q8;; reach *= 2) {
      limit = INT64_MAX;
      int count = 0;
      for_each_within(patch, bounds, reach * reach, [&](const LabelSeed& s) {
        const CostRange range = cost_range(bounds, s.position, s.normal, spacing.penalty_q16);
        if (range.hi < limit) limit = range.hi;
        if (count < kCapacity) candidates[count] = s;
        ++count;
      });
      if (limit == INT64_MAX) continue;
      if (limit <= reach * reach && count <= kCapacity) return keep_winnable(bounds, limit, candidates, count);
      // Reached too short or too far; the limit is a bound all the same, and says how far to look.
      count = 0;
      for_each_within(patch, bounds, limit, [&](const LabelSeed& s) {
        if (cost_range(bounds, s.position, s.normal, spacing.penalty_q16).lo > limit) return;
        if (count < kCapacity) candidates[count] = s;
        ++count;
      });
      return count;
    }
  }

  /// Labels from all the candidates; sorts them.
  ISOSHELL_HD void label_from(int64_t block, LabelSeed* candidates, int count) const {
    if (count == 1) {
      for (int64_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v) out[v] = candidates[0].id;
      return;
    }
    sort_by_id(candidates, count);
    label_octants(block, candidates, count);
  }

  ISOSHELL_HD static void sort_by_id(LabelSeed* c, int count) {
    for (int i = 1; i < count; ++i) {
      const LabelSeed here = c[i];
      int j = i;
      for (; j > 0 && c[j - 1].id > here.id; --j) c[j] = c[j - 1];
      c[j] = here;
    }
  }

  /// The exact path without lists, where too many seeds can win somewhere in the block: each vertex looks around itself
  /// until no seed farther away can cost less. No label costs more than the limit.
  ISOSHELL_HD void label_directly(int64_t limit, int64_t begin, int64_t end) const {
    const uint32_t patch = patches.at(begin);
    for (int64_t v = begin; v < end; ++v) {
      CheapestSeed cheapest{*this, position[v], normal[v], patch, limit};
      visit_around(grid, BoxQ8{position[v], position[v]}, cheapest);
      out[v] = cheapest.id;
    }
  }

  /// Labels some of a block's vertices, around which the bounds are. Seeds may be far from all of them, as where a thin
  /// tube has lost its own: a search from each vertex would pass all the empty cells between.
  ISOSHELL_HD void label_members(const Bounds& bounds, const int64_t* member, int members) const {
    LabelSeed candidates[kCapacity];
    int64_t limit;
    const int count = gather(member[0], bounds, candidates, limit);
    if (count > kCapacity) {
      for (int m = 0; m < members; ++m) label_directly(limit, member[m], member[m] + 1);
      return;
    }
    sort_by_id(candidates, count);
    for (int m = 0; m < members; m += kMembers)
      label_octant(member + m, members - m < kMembers ? members - m : kMembers, candidates, count);
  }

  /// Keeps the smallest (cost, id) of the patch's seeds that it is shown.
  struct CheapestSeed {
    const LabelBlock& block;
    PointQ8 position;
    Normal8 normal;
    uint32_t patch;
    int64_t limit;
    int64_t best = INT64_MAX;
    uint32_t id = kNone;

    ISOSHELL_HD int64_t bound_q16() const { return best < limit ? best : limit; }
    ISOSHELL_HD void operator()(const GridPoint& p) {
      if (!block.patches.has(patch, p.id)) return;
      const int64_t c = cost(position, normal, {p.position, p.id, block.seed_normal[p.id]}, block.spacing.penalty_q16);
      if (c < best || (c == best && p.id < id)) best = c, id = p.id;
    }
  };

  /// Calls visit(LabelSeed) for every seed of the patch whose squared distance to the box is at most the limit, and for
  /// some more of the patch.
  template <class Visit>
  ISOSHELL_HD void for_each_within(uint32_t patch, const Bounds& b, int64_t limit_sq, Visit visit) const {
    const int32_t r = int32_t(isqrt(uint64_t(limit_sq))) + 1;
    const auto visit_point = [&](const GridPoint& p) {
      if (patches.has(patch, p.id)) visit(LabelSeed{p.position, p.id, seed_normal[p.id]});
    };
    visit_box(grid, {{b.lo.x - r, b.lo.y - r, b.lo.z - r}, {b.hi.x + r, b.hi.y + r, b.hi.z + r}}, visit_point);
  }

 private:
  ISOSHELL_HD int keep_winnable(const Bounds& bounds, int64_t limit, LabelSeed* candidates, int count) const {
    int kept = 0;
    for (int c = 0; c < count; ++c)
      if (cost_range(bounds, candidates[c].position, candidates[c].normal, spacing.penalty_q16).lo <= limit)
        candidates[kept++] = candidates[c];
    return kept;
  }

  /// The eight octants around the block's centre in turn, so many of their vertices at a time.
  ISOSHELL_HD void label_octants(int64_t block, const LabelSeed* candidates, int count) const {
    const PointQ8 centre = blocks.centre[block];
    for (int octant = 0; octant < 8; ++octant) {
      int64_t member[kMembers];
      int members = 0;
      for (int64_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v) {
        if (octant_of(position[v], centre) != octant) continue;
        member[members++] = v;
        if (members < kMembers) continue;
        label_octant(member, members, candidates, count);
        members = 0;
      }
      if (members) label_octant(member, members, candidates, count);
    }
  }
  ISOSHELL_HD static int octant_of(PointQ8 p, PointQ8 centre) {
    return (p.x >= centre.x) * 4 + (p.y >= centre.y) * 2 + (p.z >= centre.z);
  }

  ISOSHELL_HD void label_octant(const int64_t* member, int members, const LabelSeed* candidates, int count) const {
    Bounds bounds = empty_bounds();
    for (int m = 0; m < members; ++m) include(bounds, position[member[m]], normal[member[m]]);
    int64_t least[kCapacity];
    int64_t limit = INT64_MAX;
    bool may_oppose = false;
    for (int c = 0; c < count; ++c) {
      const LabelSeed& s = candidates[c];
      const CostRange range = cost_range(bounds, s.position, s.normal, spacing.penalty_q16);
      least[c] = range.lo;
      if (range.hi < limit) limit = range.hi;
      may_oppose |= range.may_oppose;
    }
    const PointQ8 origin = bounds.lo;
    // Differences below 2^15 keep squared distances below 3 * 2^30: 32 bits do.
    const bool narrow = !may_oppose && limit < int64_t(1) << 29 && bounds.hi.x - origin.x < 1 << 13 &&
                        bounds.hi.y - origin.y < 1 << 13 && bounds.hi.z - origin.z < 1 << 13;
    if (narrow)
      label_narrow(member, members, candidates, count, least, limit, origin);
    else
      label_wide(member, members, candidates, count, least, limit);
  }

  ISOSHELL_HD void label_wide(const int64_t* member, int members, const LabelSeed* candidates, int count,
                              const int64_t* least, int64_t limit) const {
    for (int m = 0; m < members; ++m) {
      int64_t best = INT64_MAX;
      uint32_t id = kNone;
      for (int c = 0; c < count; ++c) {
        if (least[c] > limit) continue;
        const int64_t here = cost(position[member[m]], normal[member[m]], candidates[c], spacing.penalty_q16);
        if (here < best) best = here, id = candidates[c].id;
      }
      out[member[m]] = id;
    }
  }

  ISOSHELL_HD void label_narrow(const int64_t* member, int members, const LabelSeed* candidates, int count,
                                const int64_t* least, int64_t limit, PointQ8 origin) const {
    uint32_t x[kMembers], y[kMembers], z[kMembers], best[kMembers], id[kMembers];
    for (int m = 0; m < members; ++m) {
      const PointQ8 p = position[member[m]];
      x[m] = uint32_t(p.x - origin.x);
      y[m] = uint32_t(p.y - origin.y);
      z[m] = uint32_t(p.z - origin.z);
      best[m] = UINT32_MAX;
      id[m] = kNone;
    }
    for (int c = 0; c < count; ++c) {
      if (least[c] > limit) continue;
      const LabelSeed& s = candidates[c];
      const uint32_t sx = uint32_t(s.position.x - origin.x), sy = uint32_t(s.position.y - origin.y),
                     sz = uint32_t(s.position.z - origin.z), seed = s.id;
      for (int m = 0; m < members; ++m) {
        const uint32_t dx = x[m] - sx, dy = y[m] - sy, dz = z[m] - sz;
        const uint32_t here = dx * dx + dy * dy + dz * dz;
        id[m] = here < best[m] ? seed : id[m];
        best[m] = here < best[m] ? here : best[m];
      }
    }
    for (int m = 0; m < members; ++m) out[member[m]] = id[m];
  }
};

struct DoubledArea {
  View<const PointQ8> position;
  View<const TriangleIndices> triangles;
  ISOSHELL_HD int64_t operator()(int64_t t) const {
    const TriangleIndices i = triangles[t];
    const Vec64 n = cross(difference(position[i.b], position[i.a]), difference(position[i.c], position[i.a]));
    return int64_t(isqrt(uint64_t(dot(n, n))));
  }
};

struct ShareOfSeeds {
  DoubledArea area;
  EdgeLengthsView lengths;
  ISOSHELL_HD int64_t operator()(int64_t t) const { return lengths.share_of_seeds(area(t), area.triangles[t]); }
};

}  // namespace label

template <class Exec>
int64_t doubled_area_q16(Exec& exec, const SurfaceMesh& surface) {
  return exec.sum(surface.triangles.size(), label::DoubledArea{surface.position.view(), surface.triangles.view()});
}

template <class Exec>
SeedSpacing seed_spacing(Exec& exec, const SurfaceMesh& surface, int64_t seeds) {
  const EdgeLengthsView lengths = lengths_of(surface);
  const int64_t area2 = doubled_area_q16(exec, surface);
  const int64_t shares =
      lengths.vary() ? exec.sum(surface.triangles.size(),
                                label::ShareOfSeeds{{surface.position.view(), surface.triangles.view()}, lengths})
                     : area2;
  const int64_t h_sq = shares / 2 / (seeds > 0 ? seeds : 1), h = int64_t(isqrt(uint64_t(h_sq))) + 1;
  if (!lengths.vary()) return {h_sq, h, 16 * h_sq, h, area2, lengths};
  constexpr int64_t kMostPenalty = (int64_t(1) << 28) - 1;  // beyond, labels take slower ways
  const int64_t largest = h * lengths.largest / lengths.least;
  return {h_sq, h, std::min(16 * h * largest, kMostPenalty), largest, area2, lengths};
}

/// Grid of the current seeds, with cells about as wide as seeds are apart; twice that where lengths vary.
template <class Exec>
PointGrid grid_of_seeds(Exec& exec, const SurfaceMesh& surface, const SeedSet& seeds, const SeedSpacing& spacing) {
  const int64_t edge_q8 = std::min(2 * spacing.h_q8, spacing.largest_h_q8);
  const int64_t spacing_vox = (edge_q8 + kOneVoxelQ8 - 1) / kOneVoxelQ8;
  PointGrid grid = make_point_grid(exec, surface.extent_vox, spacing_vox, seeds.size());
  fill_point_grid(exec, grid, seeds.position.view());
  return grid;
}

/// Labels of all vertices for the current seeds. Cost: O(vertices) for seeds of even spacing. Throws: usage for a patch
/// without a seed.
struct PlainLabelSheet {
  template <class Exec>
  static void run(Exec& exec, const SurfaceMesh& surface, const SeedSet& seeds, const SeedSpacing& spacing,
                  View<uint32_t> labels) {
    const PointGrid grid = grid_of_seeds(exec, surface, seeds, spacing);
    const Buffer<uint32_t> patch_of_seed = find_patches_of_seeds(exec, surface, seeds);
    exec.for_each("label sheet vertices", surface.blocks.count(),
                  label::LabelBlock<>{surface.blocks.view(),
                                      surface.position.view(),
                                      surface.normal.view(),
                                      grid.view(),
                                      seeds.normal.view(),
                                      spacing,
                                      labels,
                                      {surface.patch.view(), patch_of_seed.view()}});
    prescribe_labels(exec, seeds.fixed, labels);
  }
};

}  // namespace isoshell
