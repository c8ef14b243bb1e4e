#include "cpu/sheet/project_simd.h"

#include <algorithm>
#include <cstdlib>

#include "cpu/sheet/foot_simd.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace {

/// What find_voxel knows of rows of voxels, most of which lie in the leaves of those before.
class SiteRows {
 public:
  explicit SiteRows(const VoxelSetView& sites) : sites_(sites) {}

  /// Calls visit(z, site) for the sites of a row, from z0 to z1.
  template <class Visit>
  void for_each(int32_t x, int32_t y, int32_t z0, int32_t z1, Visit visit) {
    for (int32_t z = z0; z <= z1; z = (z | 7) + 1) {
      const Leaf& leaf = leaf_of({x >> 3, y >> 3, z >> 3});
      const int32_t base = z & ~7, last = z1 - base < 7 ? z1 - base : 7;
      const uint64_t word = leaf.mask.word[x & 7];
      const int row = (y & 7) << 3;
      for (uint32_t bits = uint32_t(word >> row) & ((2u << last) - (1u << (z & 7))); bits; bits &= bits - 1) {
        const int at = __builtin_ctz(bits);
        visit(base + at, leaf.first[x & 7] + popcount64(word & ((uint64_t(1) << (row + at)) - 1)));
      }
    }
  }

 private:
  struct Leaf {
    Voxel at = {INT32_MIN, 0, 0};
    LeafMask mask;
    int64_t first[8];  ///< site of each word
  };
  const Leaf& leaf_of(Voxel l) {
    Leaf& leaf = leaf_[(l.x & 1) << 2 | (l.y & 1) << 1 | (l.z & 1)];
    if (leaf.at != l) load(l, leaf);
    return leaf;
  }
  void load(Voxel l, Leaf& leaf) const {
    leaf.at = l;
    leaf.mask = {};
    const uint32_t number = find_leaf(sites_, l);
    if (number == kNone) return;
    leaf.mask = sites_.mask[number];
    int64_t first = sites_.first[number];
    for (int x = 0; x < 8; ++x) {
      leaf.first[x] = first;
      first += popcount64(leaf.mask.word[x]);
    }
  }

  const VoxelSetView sites_;
  Leaf leaf_[8];  ///< neighbours have different places
};

/// Some vertices, one after the other in their order. The triangles of the eight voxels around the nearest lattice
/// corner say how far to look, those of the voxels as near as that which is the nearest.
class ProjectRun {
 public:
  static constexpr int kVertices = 256;

  ProjectRun(const sheet_steps::ProjectVertex& step, int64_t begin, int64_t end)
      : step_(step), begin_(begin), count_(int(end - begin)), sites_(step.surface.sites) {}

  void project() {
    for (int i = 0; i < count_; ++i) {
      const PointQ8 p = step_.smooth[begin_ + i];
      const Voxel corner = nearest_corner(p);
      take(i, [&] {
        for (int n = 0; n < 4; ++n)
          sites_.for_each(corner.x - (n >> 1), corner.y - (n & 1), corner.z - 1, corner.z,
                          [&](int32_t, int64_t site) { add_site(site, p); });
      });
    }
    settle();
    for (int i = 0; i < count_; ++i) {
      const PointQ8 p = step_.smooth[begin_ + i];
      const int64_t far_sq = best_[i].distance_sq_q16;
      if (far_sq > kFar * kFar || far_sq <= sure_sq(p)) continue;
      take(i, [&] { add_within(p, int32_t(far_sq)); });
    }
    settle();
    for (int i = 0; i < count_; ++i) {
      const int64_t v = begin_ + i;
      if (best_[i].distance_sq_q16 > kFar * kFar)
        step_(v);
      else
        step_.position[v] = best_[i].point, step_.source_triangle[v] = best_[i].triangle;
    }
  }

 private:
  static constexpr int kMostNear = 32;  ///< triangles that a vertex may have in lanes
  static constexpr uint32_t kSeen = 16;
  static constexpr int64_t kFar = 2 * kOneVoxelQ8 - 1;  ///< farther vertices may be bridges

  static int32_t nearest_corner(int32_t c) { return (c + kOneVoxelQ8 / 2) >> kFractionBits; }
  static Voxel nearest_corner(PointQ8 p) { return {nearest_corner(p.x), nearest_corner(p.y), nearest_corner(p.z)}; }
  /// Within this all lies in the eight voxels around the nearest corner, less one for the rounding of closest points.
  static int64_t sure_sq(PointQ8 p) {
    const auto off = [](int32_t c) { return std::abs(c - nearest_corner(c) * kOneVoxelQ8); };
    const int64_t sure = kOneVoxelQ8 - std::max({off(p.x), off(p.y), off(p.z)}) - 1;
    return sure * sure;
  }
  /// Distance along an axis to a voxel, which is widened by the rounding of closest points.
  static int32_t gap_sq(int32_t p, int32_t voxel) {
    const int32_t to_lo = voxel * kOneVoxelQ8 - 1 - p, to_hi = p - (voxel + 1) * kOneVoxelQ8 - 1;
    const int32_t gap = std::max({to_lo, to_hi, 0});
    return gap * gap;
  }

  /// Lists the triangles of vertex i by add().
  template <class Add>
  void take(int i, Add add) {
    if (feet_ + kMostNear > FootSimd::kLanes) settle();
    near_ = 0;
    std::fill(seen_, seen_ + kSeen, kNone);
    add();
    if (near_ > kMostNear) {
      best_[i] = {};  // left to the step
      return;
    }
    vertex_[vertices_] = i, first_[vertices_] = feet_;
    ++vertices_;
    feet_ += near_;
  }
  /// The triangles of the voxels within a distance, those around the nearest corner apart.
  void add_within(PointQ8 p, int32_t far_sq) {
    const Voxel corner = nearest_corner(p);
    const auto r = int32_t(isqrt(uint64_t(far_sq)));
    const auto first = [r](int32_t c) { return (c - r - 2) >> kFractionBits; };
    const auto last = [r](int32_t c) { return (c + r + 1) >> kFractionBits; };
    for (int32_t x = first(p.x); x <= last(p.x); ++x) {
      const int32_t left_x = far_sq - gap_sq(p.x, x);
      for (int32_t y = first(p.y); y <= last(p.y); ++y) {
        const int32_t left = left_x - gap_sq(p.y, y);
        if (left < 0) continue;
        const bool is_by_corner = (uint32_t(corner.x - x) | uint32_t(corner.y - y)) <= 1;
        sites_.for_each(x, y, first(p.z), last(p.z), [&](int32_t z, int64_t site) {
          if (gap_sq(p.z, z) <= left && !(is_by_corner && uint32_t(corner.z - z) <= 1)) add_site(site, p);
        });
      }
    }
  }
  void add_site(int64_t site, PointQ8 p) {
    const SitedSurfaceView& surface = step_.surface;
    for (int64_t i = surface.site_first[site]; i < surface.site_first[site + 1]; ++i) {
      const uint32_t t = surface.site_triangles[i];
      uint32_t& seen = seen_[t % kSeen];
      if (seen == t) continue;
      seen = t;
      if (near_ >= kMostNear) {
        near_ = kMostNear + 1;
        return;
      }
      const TriangleIndices& corners = surface.triangles[t];
      const int at = feet_ + near_++;
      triangle_[at] = t;
      lanes_.p.set(at, p);
      lanes_.a.set(at, surface.points[corners.a]);
      lanes_.b.set(at, surface.points[corners.b]);
      lanes_.c.set(at, surface.points[corners.c]);
    }
  }

  void settle() {
    lanes_.find(feet_);
    first_[vertices_] = feet_;
    for (int w = 0; w < vertices_; ++w) {
      NearestTriangle& best = best_[vertex_[w]];
      for (int k = first_[w]; k < first_[w + 1]; ++k) {
        const auto d = int64_t(lanes_.distance_sq[k]);
        if ((d < best.distance_sq_q16) | ((d == best.distance_sq_q16) & (triangle_[k] < best.triangle)))
          best = {d, triangle_[k], lanes_.foot.at(k)};
      }
    }
    vertices_ = feet_ = 0;
  }

  const sheet_steps::ProjectVertex step_;
  const int64_t begin_;
  const int count_;
  SiteRows sites_;
  NearestTriangle best_[kVertices];
  FootSimd lanes_;
  uint32_t triangle_[FootSimd::kLanes];
  uint32_t seen_[kSeen];  ///< voxels share triangles: most would be met again at once
  int vertices_ = 0, feet_ = 0, near_ = 0;
  int vertex_[kVertices], first_[kVertices + 1];
};

}  // namespace

void ProjectLanes::run(CpuExecutor& exec, const sheet_steps::ProjectVertex& step) {
  const int64_t vertices = step.position.size;
  exec.for_each("project", (vertices + ProjectRun::kVertices - 1) / ProjectRun::kVertices,
                [&step, vertices](int64_t run) {
                  const int64_t begin = run * ProjectRun::kVertices;
                  ProjectRun(step, begin, std::min(vertices, begin + ProjectRun::kVertices)).project();
                });
}

}  // namespace isoshell
