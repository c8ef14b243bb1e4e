#include "cpu/sheet/project_simd.h"

#include <algorithm>

#include "core/vector_versions.h"
#include "cpu/sheet/foot_simd.h"
#include "voxel/exact_int.h"
#include "voxel/point_grid.h"

namespace isoshell {
namespace {

/// What find_voxel knows of rows of voxels, most of which lie in the leaves of those before.
class SiteRows {
 public:
  explicit SiteRows(const VoxelSetView& sites) : sites_(sites) {}

  /// Calls visit(first, last) for ranges of sites that together are those of a row, from z0 to z1.
  template <class Visit>
  void for_each_range(int32_t x, int32_t y, int32_t z0, int32_t z1, Visit visit) {
    for (int32_t z = z0; z <= z1; z = (z | 7) + 1) {
      const Leaf& leaf = leaf_of({x >> 3, y >> 3, z >> 3});
      const uint64_t word = leaf.mask.word[x & 7];
      const int row = (y & 7) << 3, from = row + (z & 7), to = row + std::min(z1 - (z & ~7), 7);
      const uint64_t before = word & ((uint64_t(1) << from) - 1), until = word & (~uint64_t(0) >> (63 - to));
      const int64_t first = leaf.first[x & 7];
      if (before != until) visit(first + popcount64(before), first + popcount64(until));
    }
  }

 private:
  struct Leaf {
    Voxel at = {INT32_MIN, 0, 0};
    LeafMask mask;
    int64_t first[8] = {};  ///< site of each word
  };
  const Leaf& leaf_of(Voxel l) {
    Leaf& leaf = leaf_[(l.x & 3) << 4 | (l.y & 3) << 2 | (l.z & 3)];
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
  Leaf leaf_[64];  ///< those around a run have different places
};

constexpr int kMostNear = 1024;                ///< triangles near a run
constexpr int32_t kFar = 2 * kOneVoxelQ8 - 1;  ///< farther vertices may be bridges
constexpr int32_t kReach = kOneVoxelQ8;        ///< most vertices are nearer to the surface

/// Triangles by the boxes around them.
struct NearTriangles {
  int count = 0;
  int32_t lo_x[kMostNear], lo_y[kMostNear], lo_z[kMostNear], hi_x[kMostNear], hi_y[kMostNear], hi_z[kMostNear];
  uint32_t triangle[kMostNear];
  PointQ8 a[kMostNear], b[kMostNear], c[kMostNear];

  void add(uint32_t t, PointQ8 at_a, PointQ8 at_b, PointQ8 at_c) {
    triangle[count] = t, a[count] = at_a, b[count] = at_b, c[count] = at_c;
    lo_x[count] = std::min({at_a.x, at_b.x, at_c.x}), hi_x[count] = std::max({at_a.x, at_b.x, at_c.x});
    lo_y[count] = std::min({at_a.y, at_b.y, at_c.y}), hi_y[count] = std::max({at_a.y, at_b.y, at_c.y});
    lo_z[count] = std::min({at_a.z, at_b.z, at_c.z}), hi_z[count] = std::max({at_a.z, at_b.z, at_c.z});
    ++count;
  }
};

ISOSHELL_VECTOR_VERSIONS void mark_meeting(const NearTriangles& near, const BoxQ8 box, int32_t* __restrict meets) {
  for (int i = 0; i < near.count; ++i)
    meets[i] = (near.lo_x[i] <= box.hi.x) & (near.hi_x[i] >= box.lo.x) & (near.lo_y[i] <= box.hi.y) &
               (near.hi_y[i] >= box.lo.y) & (near.lo_z[i] <= box.hi.z) & (near.hi_z[i] >= box.lo.z);
}

BoxQ8 widened(const BoxQ8& box, int32_t by) {
  return {{box.lo.x - by, box.lo.y - by, box.lo.z - by}, {box.hi.x + by, box.hi.y + by, box.hi.z + by}};
}
void include(BoxQ8& box, PointQ8 p) {
  box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
  box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
}

/// Vertices in runs that lie together. The triangles near a run are listed once; groups of a run are compared with
/// those whose boxes are within reach, and vertices that are farther from the surface with those within that distance.
class ProjectRuns {
 public:
  explicit ProjectRuns(const sheet_steps::ProjectVertex& step) : step_(step), sites_(step.surface.sites) {}

  void project(int64_t begin, int64_t end) {
    while (begin < end) {
      take_run(begin, end);
      if (!list_near()) {  // of fewer vertices, that will not be as many
        if (count_ == 1) step_(begin++);
        most_ = std::max(1, count_ / 2);
        continue;
      }
      project_run();
      begin += count_;
      most_ = std::min(2 * most_, kMost);
    }
  }

 private:
  static constexpr int kMost = 128;  ///< vertices of a run
  static constexpr int32_t kWidest = 10 * kOneVoxelQ8, kGroupShift = kFractionBits + 1, kGroups = 8;
  static constexpr uint32_t kSeen = 1024;

  void take_run(int64_t begin, int64_t end) {
    begin_ = begin, count_ = 0;
    const PointQ8 first = step_.smooth[begin];
    BoxQ8 box = {first, first};
    for (; count_ < most_ && begin + count_ < end; ++count_) {
      BoxQ8 wider = box;
      include(wider, step_.smooth[begin + count_]);
      const PointQ8 lo = wider.lo, hi = wider.hi;
      if (std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z}) > kWidest) break;
      box = wider;
      best_[count_] = {};
    }
    box_ = box;
  }

  /// Lists what may be the nearest triangle of a vertex that is not far. Returns whether all of it fits.
  bool list_near() {
    near_.count = 0;
    std::fill(seen_, seen_ + kSeen, kNone);
    const BoxQ8 box = widened(box_, kFar + 1);
    bool fits = true;
    for (int32_t x = box.lo.x >> kFractionBits; x <= box.hi.x >> kFractionBits; ++x)
      for (int32_t y = box.lo.y >> kFractionBits; y <= box.hi.y >> kFractionBits && fits; ++y)
        sites_.for_each_range(x, y, box.lo.z >> kFractionBits, box.hi.z >> kFractionBits,
                              [&](int64_t first, int64_t last) { fits = fits && add_sites(first, last); });
    return fits;
  }
  /// Neighbours in a row have their lists one after the other.
  bool add_sites(int64_t first, int64_t last) {
    const SitedSurfaceView& surface = step_.surface;
    for (int64_t i = surface.site_first[first]; i < surface.site_first[last]; ++i) {
      const uint32_t t = surface.site_triangles[i];
      uint32_t& seen = seen_[t % kSeen];
      if (seen == t) continue;
      seen = t;
      if (near_.count == kMostNear) return false;
      const TriangleIndices& corner = surface.triangles[t];
      near_.add(t, surface.points[corner.a], surface.points[corner.b], surface.points[corner.c]);
    }
    return true;
  }

  void project_run() {
    sort_into_groups();
    for (int begin = 0, end; begin < count_; begin = end) {
      BoxQ8 box = {at(order_[begin]), at(order_[begin])};
      for (end = begin + 1; end < count_ && group_[order_[end]] == group_[order_[begin]]; ++end)
        include(box, at(order_[end]));
      choose_meeting(widened(box, kReach));
      for (int k = begin; k < end; ++k) compare_chosen(order_[k]);
    }
    flush();
    for (int i = 0; i < count_; ++i) {
      const int64_t far_sq = best_[i].distance_sq_q16;
      if (far_sq > int64_t(kFar) * kFar || far_sq <= (kReach - 1) * (kReach - 1)) continue;
      choose_meeting(widened({at(i), at(i)}, int32_t(isqrt(uint64_t(far_sq))) + 2));
      compare_chosen(i);
    }
    flush();
    for (int i = 0; i < count_; ++i) {
      const int64_t v = begin_ + i;
      if (best_[i].distance_sq_q16 > int64_t(kFar) * kFar)
        step_(v);
      else
        step_.position[v] = best_[i].point, step_.source_triangle[v] = best_[i].triangle;
    }
  }
  PointQ8 at(int i) const { return step_.smooth[begin_ + i]; }

  /// By cubes of two voxels, which a surface leaves a few vertices each.
  void sort_into_groups() {
    uint8_t end[kGroups * kGroups * kGroups + 1] = {};
    for (int i = 0; i < count_; ++i) {
      const PointQ8 p = at(i);
      group_[i] = uint16_t(((p.x - box_.lo.x) >> kGroupShift) * kGroups * kGroups +
                           ((p.y - box_.lo.y) >> kGroupShift) * kGroups + ((p.z - box_.lo.z) >> kGroupShift));
      ++end[group_[i] + 1];
    }
    for (int g = 0; g < kGroups * kGroups * kGroups; ++g) end[g + 1] = uint8_t(end[g] + end[g + 1]);
    for (int i = 0; i < count_; ++i) order_[end[group_[i]]++] = uint8_t(i);
  }

  void choose_meeting(const BoxQ8& box) {
    mark_meeting(near_, box, meets_);
    chosen_count_ = 0;
    for (int t = 0; t < near_.count; ++t) {
      chosen_[chosen_count_] = t;
      chosen_count_ += meets_[t];
    }
  }
  void compare_chosen(int vertex) {
    const PointQ8 p = at(vertex);
    for (int k = 0; k < chosen_count_; ++k) {
      if (feet_ == FootSimd::kLanes) flush();
      const int t = chosen_[k];
      vertex_[feet_] = vertex, triangle_[feet_] = near_.triangle[t];
      lanes_.p.set(feet_, p);
      lanes_.a.set(feet_, near_.a[t]);
      lanes_.b.set(feet_, near_.b[t]);
      lanes_.c.set(feet_, near_.c[t]);
      ++feet_;
    }
  }
  static bool is_less(int64_t distance_sq, uint32_t triangle, const NearestTriangle& best) {
    return (distance_sq < best.distance_sq_q16) | ((distance_sq == best.distance_sq_q16) & (triangle < best.triangle));
  }
  void flush() {
    lanes_.find(feet_);
    for (int k = 0; k < feet_;) {
      const int vertex = vertex_[k];
      NearestTriangle best;
      int at = k;
      for (; k < feet_ && vertex_[k] == vertex; ++k) {  // by choices: branches would be guessed wrong most of the time
        const auto d = int64_t(lanes_.distance_sq[k]);
        const bool is_nearer = is_less(d, triangle_[k], best);
        best.distance_sq_q16 = is_nearer ? d : best.distance_sq_q16;
        best.triangle = is_nearer ? triangle_[k] : best.triangle;
        at = is_nearer ? k : at;
      }
      best.point = lanes_.foot.at(at);
      if (is_less(best.distance_sq_q16, best.triangle, best_[vertex])) best_[vertex] = best;
    }
    feet_ = 0;
  }

  const sheet_steps::ProjectVertex step_;
  SiteRows sites_;
  int64_t begin_ = 0;
  int count_ = 0, most_ = kMost;
  BoxQ8 box_ = {};
  NearestTriangle best_[kMost];
  uint16_t group_[kMost];
  uint8_t order_[kMost];
  NearTriangles near_;
  uint32_t seen_[kSeen];  ///< most triangles would be met again at once
  int32_t meets_[kMostNear];
  int chosen_[kMostNear + 1], chosen_count_ = 0;
  FootSimd lanes_;
  int vertex_[FootSimd::kLanes], feet_ = 0;
  uint32_t triangle_[FootSimd::kLanes];
};

}  // namespace

void ProjectLanes::run(CpuExecutor& exec, const VoxelSetView&, const sheet_steps::ProjectVertex& step) {
  constexpr int64_t kChunk = 2048;
  const int64_t vertices = step.position.size;
  exec.for_each("project", (vertices + kChunk - 1) / kChunk, [&step, vertices](int64_t chunk) {
    ProjectRuns(step).project(chunk * kChunk, std::min(vertices, (chunk + 1) * kChunk));
  });
}

}  // namespace isoshell
