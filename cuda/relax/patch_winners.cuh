// Which of a patch's candidates is nearest to a vertex.
#pragma once

#include "cuda/relax/patch_search.cuh"

namespace isoshell::cuda_relax {

/// Numbers of the winners at kCount vertices, by the 32-bit forms, and what the forms give there.
template <int kCount>
__device__ inline void winners_at(const Winners& winners, int count, const Local (&v)[kCount], int (&best)[kCount],
                                  int32_t (&least)[kCount]) {
#pragma unroll
  for (int i = 0; i < kCount; ++i) best[i] = 0, least[i] = INT32_MAX;
#pragma unroll 1
  for (int c = 0; c < count; ++c) {
    const int4 f = winners.form[c];
#pragma unroll
    for (int i = 0; i < kCount; ++i) {
      const int32_t here = f.x + f.y * v[i].x + f.z * v[i].y + f.w * v[i].z;
      best[i] = here < least[i] ? c : best[i];
      least[i] = min(here, least[i]);
    }
  }
}
template <int kCount>
__device__ inline void winners_at(const Winners& winners, int count, const Local (&v)[kCount], int (&best)[kCount]) {
  int32_t least[kCount];
  winners_at(winners, count, v, best, least);
}

constexpr int32_t kMaxNearPenalty = 1 << 28;  ///< forms and such a penalty stay within 32 bits

/// The same with penalties, for vertices of these normals.
template <int kCount>
__device__ inline void winners_at(const Winners& winners, int count, const Local (&v)[kCount],
                                  const uint32_t (&packed_normal)[kCount], int32_t penalty_q16, int (&best)[kCount],
                                  int32_t (&least)[kCount]) {
#pragma unroll
  for (int i = 0; i < kCount; ++i) best[i] = 0, least[i] = INT32_MAX;
#pragma unroll 1
  for (int c = 0; c < count; ++c) {
    const int4 f = winners.form[c];
    const uint32_t normal = winners.place[c].packed_normal;
#pragma unroll
    for (int i = 0; i < kCount; ++i) {
      const bool pays = __dp4a(int(normal), int(packed_normal[i]), 0) < label::kOpposite;
      const int32_t here = f.x + f.y * v[i].x + f.z * v[i].y + f.w * v[i].z + (pays ? penalty_q16 : 0);
      best[i] = here < least[i] ? c : best[i];
      least[i] = min(here, least[i]);
    }
  }
}

/// A winner and what it costs.
struct NearestWinner {
  int64_t cost;
  int number;
};

/// The winner at a vertex, whatever the distances and penalties.
__device__ inline NearestWinner nearest_winner(const Winners& winners, int count, Local v, Normal8 normal,
                                               int64_t penalty_q16) {
  NearestWinner best{INT64_MAX, 0};
  for (int c = 0; c < count; ++c) {
    const WinnerPlace s = winners.place[c];
    const SeedRecord record{0, 0, 0, s.packed_normal};
    const int64_t here =
        square({v.x - s.x, v.y - s.y, v.z - s.z}) + (dot(normal, record.normal()) < label::kOpposite ? penalty_q16 : 0);
    if (here < best.cost) best = {here, c};
  }
  return best;
}

/// The label itself, from all seeds in reach: for patches with too many candidates. One thread, any vertex.
__device__ inline uint32_t label_directly(const SeedSearch& search, const PatchBox& box, int32_t reach, PointQ8 v,
                                          Normal8 normal) {
  int64_t least = INT64_MAX;
  uint32_t label = kNone;
  const auto consider = [&](uint32_t id) {
    if (!search.may_label(box, id)) return;
    const SeedRecord s = search.seed[id];
    const int64_t here =
        distance_sq_q16(v, s.position()) + (dot(normal, s.normal()) < label::kOpposite ? search.penalty_q16 : 0);
    if (here < least || (here == least && id < label)) least = here, label = id;
  };
  const BucketGrid& g = search.grid;
  const PointQ8 o = box.origin;
  bool has_spilt = false;
  for (int x = g.cell(o.x + box.lo.x - reach, 0); x <= g.cell(o.x + box.hi.x + reach, 0); ++x)
    for (int y = g.cell(o.y + box.lo.y - reach, 1); y <= g.cell(o.y + box.hi.y + reach, 1); ++y)
      for (int z = g.cell(o.z + box.lo.z - reach, 2); z <= g.cell(o.z + box.hi.z + reach, 2); ++z) {
        const SeedBucket& b = search.table.bucket[g.bucket(x, y, z)];
        has_spilt |= b.count > kBucketSeeds;
        for (uint32_t i = 0; i < min(b.count, uint32_t(kBucketSeeds)); ++i) consider(b.id[i]);
      }
  if (has_spilt)
    for (uint32_t i = 0; i < search.table.spill[0]; ++i) consider(search.table.spill[1 + i]);
  return label;
}

}  // namespace isoshell::cuda_relax
