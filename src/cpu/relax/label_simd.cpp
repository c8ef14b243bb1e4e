#include "cpu/relax/label_simd.h"

#include "core/vector_versions.h"
#include "voxel/cell_sum.h"

namespace isoshell {
namespace {

constexpr int kMostVertices = VertexBlocks::kMostVertices;

/// Vertices of a block, from the smallest of their coordinates on.
struct VertexSimd {
  alignas(32) int32_t x[kMostVertices], y[kMostVertices], z[kMostVertices];
  alignas(32) int32_t normal_x[kMostVertices], normal_y[kMostVertices], normal_z[kMostVertices];
};

/// What a seed costs: |s|^2 - 2 s.v, its squared distance up to |v|^2, and the penalty where normals oppose.
struct SeedForm {
  int32_t constant, x, y, z;
  int32_t normal_x, normal_y, normal_z;
  int32_t penalty;  ///< 0 for a seed that never pays it
};

using Lanes = int32_t __attribute__((vector_size(32), may_alias));
constexpr int kWidth = 8;
ISOSHELL_INLINE const Lanes& lanes(const int32_t* at) { return *reinterpret_cast<const Lanes*>(at); }

/// For every vertex the first of the seeds that cost least. Works on whole vectors, beyond the count too.
ISOSHELL_VECTOR_VERSIONS void find_cheapest(const VertexSimd& v, int count, const SeedForm* seeds, int seed_count,
                                            int32_t* cheapest) {
  for (int i = 0; i < count; i += kWidth) {
    const Lanes x = lanes(v.x + i), y = lanes(v.y + i), z = lanes(v.z + i);
    Lanes least = Lanes{} + INT32_MAX, best = {};
    for (int s = 0; s < seed_count; ++s) {
      const SeedForm& f = seeds[s];
      Lanes here = f.constant + f.x * x + f.y * y + f.z * z;
      if (f.penalty != 0) {
        const Lanes along = f.normal_x * lanes(v.normal_x + i) + f.normal_y * lanes(v.normal_y + i) +
                            f.normal_z * lanes(v.normal_z + i);
        here += (along < label::kOpposite) & f.penalty;
      }
      best = here < least ? Lanes{} + s : best;
      least = here < least ? here : least;
    }
    *reinterpret_cast<Lanes*>(cheapest + i) = best;
  }
}

/// Seeds near a block, from the smallest of its vertices' coordinates on.
struct NearSeeds {
  static constexpr int kMost = 1024;

  int count = 0;  ///< the first kMost are here
  int32_t x[kMost], y[kMost], z[kMost];
  uint32_t id[kMost];

  void add(Local p, uint32_t seed) {
    if (count < kMost) x[count] = p.x, y[count] = p.y, z[count] = p.z, id[count] = seed;
    ++count;
  }
  Local at(int i) const { return {x[i], y[i], z[i]}; }
};

/// Whether all coordinates lie within the limit, a power of two.
ISOSHELL_VECTOR_VERSIONS bool are_within(int32_t limit, const NearSeeds& seeds) {
  uint32_t bits = 0;
  for (int i = 0; i < seeds.count; ++i)
    bits |= uint32_t(seeds.x[i] + limit) | uint32_t(seeds.y[i] + limit) | uint32_t(seeds.z[i] + limit);
  return (bits & ~uint32_t(2 * limit - 1)) == 0;
}

/// Squared distances from the middle of a box of this size, four times. Doubles hold them, and what follows, exactly.
ISOSHELL_VECTOR_VERSIONS void measure_from_middle(const NearSeeds& seeds, Local size, double* off) {
  const double sx = size.x, sy = size.y, sz = size.z;
  for (int i = 0; i < seeds.count; ++i) {
    const double x = 2.0 * seeds.x[i] - sx, y = 2.0 * seeds.y[i] - sy, z = 2.0 * seeds.z[i] - sz;
    off[i] = x * x + y * y + z * z;
  }
}

/// What seeds cost at least more than |v - m|^2 + extra, over the v of the box.
ISOSHELL_VECTOR_VERSIONS void measure_excess(const NearSeeds& seeds, Local size, Local m, double extra,
                                             double* excess) {
  const double sx = size.x, sy = size.y, sz = size.z, mx = m.x, my = m.y, mz = m.z;
  const double most = mx * mx + my * my + mz * mz + extra;
  for (int i = 0; i < seeds.count; ++i) {
    const double x = seeds.x[i], y = seeds.y[i], z = seeds.z[i];
    const double gain_x = x > mx ? x - mx : 0, gain_y = y > my ? y - my : 0, gain_z = z > mz ? z - mz : 0;
    excess[i] = x * x + y * y + z * z - most - 2 * (gain_x * sx + gain_y * sy + gain_z * sz);
  }
}

/// The places of numbers, no two of them equal, in their order.
ISOSHELL_VECTOR_VERSIONS void rank(const uint32_t* number, int count, uint32_t* place) {
  for (int i = 0; i < count; ++i) place[i] = 0;
  for (int j = 0; j < count; ++j)
    for (int i = 0; i < count; ++i) place[i] += number[j] < number[i] ? 1 : 0;
}

/// The seeds that can win in a block, by their numbers.
class BlockSeeds {
 public:
  BlockSeeds(const label::Bounds& bounds, View<const Normal8> normal, int64_t penalty_q16)
      : bounds_(bounds), size_(local(bounds.hi, bounds.lo)), normal_(normal), penalty_q16_(penalty_q16) {}

  /// False where distances may not fit 32 bits: forms stay below 3 * 2^28 + 2 * 3 * 2^27, the penalty below 2^28.
  bool fit(const NearSeeds& seeds) const {
    constexpr int32_t kLargest = 1 << 13;
    return size_.x < kLargest && size_.y < kLargest && size_.z < kLargest && are_within(1 << 14, seeds);
  }
  /// Takes off from the penalty what does not fit. False where a seed that pays it may win, given that no label costs
  /// more than the limit.
  bool cut_penalty(int64_t limit) {
    constexpr int64_t kMostPenalty = (1 << 28) - 1;
    if (penalty_q16_ > kMostPenalty && limit >= kMostPenalty) return false;
    penalty_q16_ = std::min(penalty_q16_, kMostPenalty);
    return true;
  }
  /// False when they are too many.
  bool take(const NearSeeds& seeds) {
    int winner[NearSeeds::kMost];
    count_ = find_winners(seeds, winner);
    if (count_ > label::kMaxCandidates) return false;
    uint32_t number[label::kMaxCandidates], place[label::kMaxCandidates];
    for (int i = 0; i < count_; ++i) number[i] = seeds.id[winner[i]];
    rank(number, count_, place);
    for (int i = 0; i < count_; ++i) {
      id_[place[i]] = number[i];
      form_[place[i]] = form(seeds.at(winner[i]), number[i]);
    }
    return true;
  }
  /// The one nearest to the middle.
  uint32_t middle() const { return middle_; }

  /// Labels vertex_at(0) to vertex_at(count - 1).
  template <class VerticesAt>
  void label(const label::LabelBlock<>& plain, VerticesAt vertex_at, int count) const {
    bool normals_matter = false;
    for (int s = 0; s < count_; ++s) normals_matter |= form_[s].penalty != 0;
    VertexSimd v;
    for (int i = 0; i < count; ++i) {
      const Local p = local(plain.position[vertex_at(i)], bounds_.lo);
      v.x[i] = p.x, v.y[i] = p.y, v.z[i] = p.z;
    }
    if (normals_matter)
      for (int i = 0; i < count; ++i) {
        const Normal8 n = plain.normal[vertex_at(i)];
        v.normal_x[i] = n.x, v.normal_y[i] = n.y, v.normal_z[i] = n.z;
      }
    for (int i = count; i % kWidth != 0; ++i)
      v.x[i] = v.y[i] = v.z[i] = v.normal_x[i] = v.normal_y[i] = v.normal_z[i] = 0;
    alignas(32) int32_t cheapest[kMostVertices];
    find_cheapest(v, count, form_, count_, cheapest);
    for (int i = 0; i < count; ++i) plain.out[vertex_at(i)] = id_[cheapest[i]];
  }

 private:
  /// Lists those that do not cost more everywhere in the box than the one nearest to its middle.
  int find_winners(const NearSeeds& seeds, int* winner) {
    double measure[NearSeeds::kMost];
    measure_from_middle(seeds, size_, measure);
    const int middle = int(std::min_element(measure, measure + seeds.count) - measure);
    middle_ = seeds.id[middle];
    measure_excess(seeds, size_, seeds.at(middle), may_pay(middle_) ? double(penalty_q16_) : 0, measure);
    int count = 0;
    for (int i = 0; i < seeds.count; ++i) {
      winner[count] = i;
      count += measure[i] <= 0 ? 1 : 0;
    }
    return count;
  }
  bool may_pay(uint32_t seed) const {
    return label::cost_range(bounds_, bounds_.lo, normal_[seed], penalty_q16_).may_oppose;
  }
  SeedForm form(Local p, uint32_t seed) const {
    const Normal8 n = normal_[seed];
    const int32_t penalty = may_pay(seed) ? int32_t(penalty_q16_) : 0;
    return {p.x * p.x + p.y * p.y + p.z * p.z, -2 * p.x, -2 * p.y, -2 * p.z, n.x, n.y, n.z, penalty};
  }

  const label::Bounds& bounds_;
  const Local size_;
  const View<const Normal8> normal_;
  int64_t penalty_q16_;
  uint32_t middle_ = kNone;
  int count_ = 0;
  SeedForm form_[label::kMaxCandidates];
  uint32_t id_[label::kMaxCandidates];
};

struct FindBounds {
  VertexBlocksView blocks;
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<label::Bounds> out;
  void operator()(int64_t block) const {
    label::Bounds bounds = label::empty_bounds();
    for (int64_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v)
      label::include(bounds, position[v], normal[v]);
    out[block] = bounds;
  }
};

/// 0 to 5: the axis that a normal goes along most, and which way.
int side_of(Normal8 n) {
  const int x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x >= y && x >= z) return n.x < 0;
  return y >= z ? 2 + (n.y < 0) : 4 + (n.z < 0);
}

struct LabelBlockSimd {
  label::LabelBlock<> plain;
  View<const label::Bounds> block_bounds;
  View<const PointQ8> seed_position;
  View<uint32_t> middle;

  void operator()(int64_t block) const {
    const label::Bounds& bounds = block_bounds[block];
    const int64_t begin = plain.blocks.first[block], end = plain.blocks.first[block + 1];
    NearSeeds near;
    const int64_t limit = middle[block] == kNone ? gather_first(begin, bounds, near)
                                                 : gather_as_far_as(middle[block], begin, bounds, near);
    BlockSeeds seeds(bounds, plain.seed_normal, plain.spacing.penalty_q16);
    const bool are_few = near.count <= NearSeeds::kMost, fit = are_few && seeds.fit(near) && seeds.cut_penalty(limit);
    if (!fit || !seeds.take(near)) {
      if (limit >= plain.spacing.penalty_q16) return label_by_sides(begin, end);
      return are_few && !fit ? plain(block) : plain.label_directly(limit, begin, end);
    }
    middle[block] = seeds.middle();
    seeds.label(
        plain, [begin](int i) { return begin + i; }, int(end - begin));
  }

 private:
  /// Where a block holds both sides of walls, seeds of either may win far beyond the wall, so many can. For one side at
  /// a time they are few, also where walls lie close together.
  void label_by_sides(int64_t begin, int64_t end) const {
    for (int side = 0; side < 6; ++side) {
      label::Bounds bounds = label::empty_bounds();
      int64_t member[kMostVertices];
      int count = 0;
      for (int64_t v = begin; v < end; ++v)
        if (side_of(plain.normal[v]) == side) {
          label::include(bounds, plain.position[v], plain.normal[v]);
          member[count++] = v;
        }
      if (count > 0) label_side(bounds, member, count);
    }
  }
  void label_side(const label::Bounds& bounds, const int64_t* member, int count) const {
    NearSeeds near;
    const int64_t limit = gather_first(member[0], bounds, near);
    BlockSeeds seeds(bounds, plain.seed_normal, plain.spacing.penalty_q16);
    if (near.count <= NearSeeds::kMost && seeds.fit(near) && seeds.cut_penalty(limit) && seeds.take(near))
      return seeds.label(
          plain, [member](int i) { return member[i]; }, count);
    plain.label_members(bounds, member, count);
  }

  // Both take a vertex in the bounds, and return a limit that no label's cost exceeds.

  int64_t gather_first(int64_t vertex, const label::Bounds& bounds, NearSeeds& near) const {
    label::LabelSeed seeds[label::kMaxCandidates];
    int64_t limit;
    const int count = plain.gather(vertex, bounds, seeds, limit);
    if (count > label::kMaxCandidates)
      near.count = NearSeeds::kMost + 1;
    else
      for (int s = 0; s < count; ++s) near.add(local(seeds[s].position, bounds.lo), seeds[s].id);
    return limit;
  }
  /// No label costs more than a seed of the patch does at most, wherever it is by now.
  int64_t gather_as_far_as(uint32_t seed, int64_t vertex, const label::Bounds& bounds, NearSeeds& near) const {
    const uint32_t patch = plain.patches.at(vertex);
    const int64_t limit =
        label::cost_range(bounds, seed_position[seed], plain.seed_normal[seed], plain.spacing.penalty_q16).hi;
    const int32_t r = int32_t(isqrt(uint64_t(limit))) + 1;
    const auto add = [&](const GridPoint& p) {
      if (plain.patches.has(patch, p.id)) near.add(local(p.position, bounds.lo), p.id);
    };
    visit_box(
        plain.grid,
        {{bounds.lo.x - r, bounds.lo.y - r, bounds.lo.z - r}, {bounds.hi.x + r, bounds.hi.y + r, bounds.hi.z + r}},
        add);
    return limit;
  }
};

}  // namespace

LabelSimd::LabelSimd(CpuExecutor& exec, const SurfaceMesh& surface, const SeedSpacing& spacing)
    : surface_(surface), spacing_(spacing), bounds_(surface.blocks.count()), middle_(surface.blocks.count()) {
  exec.fill(middle_.view(), kNone);
  exec.for_each("bounds of blocks", bounds_.size(),
                FindBounds{surface.blocks.view(), surface.position.view(), surface.normal.view(), bounds_.view()});
}

void LabelSimd::label(CpuExecutor& exec, const SeedSet& seeds, View<uint32_t> labels) {
  const PointGrid grid = grid_of_seeds(exec, surface_, seeds, spacing_);
  const Buffer<uint32_t> patch_of_seed = find_patches_of_seeds(exec, surface_, seeds);
  exec.for_each("label sheet vertices", surface_.blocks.count(),
                LabelBlockSimd{{surface_.blocks.view(),
                                surface_.position.view(),
                                surface_.normal.view(),
                                grid.view(),
                                seeds.normal.view(),
                                spacing_,
                                labels,
                                {surface_.patch.view(), patch_of_seed.view()}},
                               bounds_.view(),
                               seeds.position.view(),
                               middle_.view()});
  prescribe_labels(exec, seeds.fixed, labels);
}

}  // namespace isoshell
