#include "cpu/label_lanes.h"

#include <utility>

#include "cpu/vector_versions.h"
#include "voxel/cell_sum.h"

namespace isoshell {
namespace {

constexpr int kLeafVoxels = 512;

/// Vertices of a leaf, from the smallest of their coordinates on, and the best seed of each so far.
struct VertexLanes {
  int32_t x[kLeafVoxels], y[kLeafVoxels], z[kLeafVoxels];
  int32_t normal_x[kLeafVoxels], normal_y[kLeafVoxels], normal_z[kLeafVoxels];
  int32_t least[kLeafVoxels], best[kLeafVoxels];
};

/// What a seed costs: |s|^2 - 2 s.v, its squared distance up to |v|^2, and the penalty where normals oppose.
struct SeedForm {
  int32_t constant, x, y, z;
  int32_t normal_x, normal_y, normal_z;
  int32_t penalty;  ///< 0 for a seed that never pays it
};

ISOSHELL_VECTOR_VERSIONS void compare(VertexLanes& v, int count, const SeedForm* seeds, int seed_count) {
  for (int i = 0; i < count; ++i) v.least[i] = INT32_MAX, v.best[i] = 0;
  for (int s = 0; s < seed_count; ++s) {
    const SeedForm f = seeds[s];
    if (f.penalty == 0)
      for (int i = 0; i < count; ++i) {
        const int32_t here = f.constant + f.x * v.x[i] + f.y * v.y[i] + f.z * v.z[i];
        v.best[i] = here < v.least[i] ? s : v.best[i];
        v.least[i] = here < v.least[i] ? here : v.least[i];
      }
    else
      for (int i = 0; i < count; ++i) {
        const int32_t along = f.normal_x * v.normal_x[i] + f.normal_y * v.normal_y[i] + f.normal_z * v.normal_z[i];
        const int32_t here =
            f.constant + f.x * v.x[i] + f.y * v.y[i] + f.z * v.z[i] + (along < label::kOpposite ? f.penalty : 0);
        v.best[i] = here < v.least[i] ? s : v.best[i];
        v.least[i] = here < v.least[i] ? here : v.least[i];
      }
  }
}

/// The seeds that can win in a leaf, with their costs from `origin` on.
class LeafSeeds {
 public:
  LeafSeeds(const label::Bounds& bounds, int64_t penalty_q16)
      : bounds_(bounds), size_(local(bounds.hi, bounds.lo)), penalty_q16_(penalty_q16) {}

  /// False where costs may not fit 32 bits: forms stay below 3 * 2^28 + 2 * 3 * 2^27, and the penalty below 2^28.
  bool fit(const label::LabelSeed* seeds, int count) const {
    if (!within(size_, 1 << 13) || penalty_q16_ >= 1 << 28) return false;
    for (int s = 0; s < count; ++s)
      if (!within(local(seeds[s].position, bounds_.lo), 1 << 14)) return false;
    return true;
  }

  /// Moves the seed nearest to the middle to the front, and those that cost more everywhere in the box to the end;
  /// returns how many are left.
  int drop_beaten(label::LabelSeed* seeds, int count) const {
    int middle = 0;
    int64_t nearest = INT64_MAX;
    for (int s = 0; s < count; ++s) {
      const Local p = local(seeds[s].position, bounds_.lo);
      const int64_t off = square({2 * p.x - size_.x, 2 * p.y - size_.y, 2 * p.z - size_.z});
      if (off < nearest) nearest = off, middle = s;
    }
    std::swap(seeds[0], seeds[middle]);
    const Local m = local(seeds[0].position, bounds_.lo);
    const int64_t most = square(m) + form(seeds[0]).penalty;
    const auto gain = [](int32_t p, int32_t from, int32_t size) {
      return p > from ? int64_t(p - from) * size : int64_t(0);
    };
    int kept = 1;
    for (int s = 1; s < count; ++s) {
      const Local p = local(seeds[s].position, bounds_.lo);
      const int64_t ahead =
          square(p) - most - 2 * (gain(p.x, m.x, size_.x) + gain(p.y, m.y, size_.y) + gain(p.z, m.z, size_.z));
      if (ahead <= 0) std::swap(seeds[kept++], seeds[s]);
    }
    return kept;
  }

  SeedForm form(const label::LabelSeed& s) const {
    const Local p = local(s.position, bounds_.lo);
    const bool may_pay = label::cost_range(bounds_, s.position, s.normal, penalty_q16_).may_oppose;
    return {p.x * p.x + p.y * p.y + p.z * p.z,  -2 * p.x, -2 * p.y, -2 * p.z, s.normal.x, s.normal.y, s.normal.z,
            may_pay ? int32_t(penalty_q16_) : 0};
  }

 private:
  static bool within(Local p, int32_t limit) {
    return p.x > -limit && p.x < limit && p.y > -limit && p.y < limit && p.z > -limit && p.z < limit;
  }

  const label::Bounds& bounds_;
  const Local size_;
  const int64_t penalty_q16_;
};

struct FindBounds {
  VoxelSetView corners;
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<label::Bounds> out;
  void operator()(int64_t leaf) const {
    label::Bounds bounds = label::empty_bounds();
    for (int64_t v = corners.first[leaf]; v < corners.first[leaf + 1]; ++v)
      label::include(bounds, position[v], normal[v]);
    out[leaf] = bounds;
  }
};

struct LabelLeafInLanes {
  label::LabelLeaf<> plain;
  View<const label::Bounds> leaf_bounds;
  View<const PointQ8> seed_position;
  View<uint32_t> middle;

  void operator()(int64_t leaf) const {
    using namespace label;
    const int64_t begin = plain.corners.first[leaf], end = plain.corners.first[leaf + 1];
    const Bounds& bounds = leaf_bounds[leaf];
    LabelSeed seeds[kMaxCandidates];
    int64_t limit;
    int count = middle[leaf] != kNone ? gather_as_far_as(middle[leaf], bounds, limit, seeds)
                                      : plain.gather(bounds, plain.spacing.h_at(uint32_t(begin)), seeds, limit);
    if (count > kMaxCandidates) return plain.label_directly(limit, begin, end);
    const LeafSeeds leaf_seeds(bounds, plain.spacing.penalty_q16);
    if (!leaf_seeds.fit(seeds, count)) return plain.label_from(leaf, seeds, count);
    count = leaf_seeds.drop_beaten(seeds, count);
    middle[leaf] = seeds[0].id;
    LabelLeaf<>::sort_by_id(seeds, count);
    label_by(leaf_seeds, seeds, count, bounds.lo, begin, int(end - begin));
  }

 private:
  static int64_t distance_sq_to(const label::Bounds& b, PointQ8 p) {
    const int64_t x = std::max({b.lo.x - p.x, p.x - b.hi.x, 0}), y = std::max({b.lo.y - p.y, p.y - b.hi.y, 0}),
                  z = std::max({b.lo.z - p.z, p.z - b.hi.z, 0});
    return x * x + y * y + z * z;
  }

  /// Like gather of the plain way; no label costs more than a seed does at most, wherever it is by now.
  int gather_as_far_as(uint32_t seed, const label::Bounds& bounds, int64_t& limit, label::LabelSeed* seeds) const {
    limit = label::cost_range(bounds, seed_position[seed], plain.seed_normal[seed], plain.spacing.penalty_q16).hi;
    int64_t least[label::kMaxCandidates];
    int count = 0;
    plain.for_each_within(bounds, limit, [&](const label::LabelSeed& s) {
      if (distance_sq_to(bounds, s.position) > limit) return;
      const label::CostRange range = label::cost_range(bounds, s.position, s.normal, plain.spacing.penalty_q16);
      if (range.lo > limit) return;
      limit = std::min(limit, range.hi);
      if (count < label::kMaxCandidates) seeds[count] = s, least[count] = range.lo;
      ++count;
    });
    if (count > label::kMaxCandidates) return count;
    int kept = 0;
    for (int s = 0; s < count; ++s)
      if (least[s] <= limit) seeds[kept++] = seeds[s];
    return kept;
  }

  void label_by(const LeafSeeds& leaf_seeds, const label::LabelSeed* seeds, int seed_count, PointQ8 origin,
                int64_t begin, int count) const {
    SeedForm forms[label::kMaxCandidates];
    bool normals_matter = false;
    for (int s = 0; s < seed_count; ++s) {
      forms[s] = leaf_seeds.form(seeds[s]);
      normals_matter |= forms[s].penalty != 0;
    }
    VertexLanes lanes;
    for (int i = 0; i < count; ++i) {
      const Local p = local(plain.position[begin + i], origin);
      lanes.x[i] = p.x, lanes.y[i] = p.y, lanes.z[i] = p.z;
    }
    if (normals_matter)
      for (int i = 0; i < count; ++i) {
        const Normal8 n = plain.normal[begin + i];
        lanes.normal_x[i] = n.x, lanes.normal_y[i] = n.y, lanes.normal_z[i] = n.z;
      }
    compare(lanes, count, forms, seed_count);
    for (int i = 0; i < count; ++i) plain.out[begin + i] = seeds[lanes.best[i]].id;
  }
};

}  // namespace

LabelLanes::LabelLanes(TbbExecutor& exec, const Sheet& sheet, const SeedSpacing& spacing)
    : sheet_(sheet), spacing_(spacing), bounds_(sheet.corners.leaf_count()), middle_(sheet.corners.leaf_count()) {
  exec.fill(middle_.view(), kNone);
  exec.for_each("bounds of leaves", bounds_.size(),
                FindBounds{sheet.corners.view(), sheet.position.view(), sheet.normal.view(), bounds_.view()});
}

void LabelLanes::label(TbbExecutor& exec, const SeedSet& seeds, View<uint32_t> labels) {
  const PointGrid grid = grid_of_seeds(exec, sheet_, seeds, spacing_);
  exec.for_each("label sheet vertices", sheet_.corners.leaf_count(),
                LabelLeafInLanes{{sheet_.corners.view(), sheet_.position.view(), sheet_.normal.view(), grid.view(),
                                  seeds.normal.view(), spacing_, labels},
                                 bounds_.view(),
                                 seeds.position.view(),
                                 middle_.view()});
}

void label_sheet(TbbExecutor& exec, const Sheet& sheet, const SeedSet& seeds, const SeedSpacing& spacing,
                 View<uint32_t> labels) {
  LabelLanes(exec, sheet, spacing).label(exec, seeds, labels);
}

}  // namespace isoshell
