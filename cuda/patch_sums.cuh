// Sums of the clipped cells of one patch, by one warp: labels of its vertices, its triangles by the number of cells
// that share them, and their pieces added up per candidate. Arithmetic is that of voxel/cell_sum.h.
#pragma once

#include "cuda/pass_end.cuh"
#include "cuda/patch_winners.cuh"
#include "stages/relax_sheet_body.h"

namespace isoshell::cuda_relax {

struct SheetPass {
  PatchesView patches;
  SeedSearch search;
  int32_t* reach;  ///< per patch, from pass to pass
  int32_t reach_slack;
  relax_sheet::CellSum* cell;
  PassState* state;
  PassProgress* progress;
  int shift;
  int32_t tolerance_ppb;
};

/// Pieces on their way from the lanes that cut them to the sums. Lane 5 c + q adds up moment q of winner c, c + 6 ...
struct PieceExchange {
  int64_t piece[32 * 5];  ///< per lane
  unsigned lanes_of[kMaxWinners];
  int64_t sum[kMaxWinners * 5];  ///< per winner
};

struct TriangleQueue {
  uint16_t triangle[64];
};

constexpr int kMaxMany = 256;

struct WarpScratch {
  union {
    Winners winners;
    uint32_t many[kMaxMany];  ///< candidates where winners do not hold them
  };
  union {
    SearchScratch search;
    PieceExchange exchange;
  };
  uint8_t label[kMaxPatchVertices];
  uint32_t used[kMaxMany / 32];
  TriangleQueue whole, cut, junction;  ///< triangles in one cell, in two, in three
};

/// Sums of a patch's pieces per winner, but of the best seed only what the rest does not tell: its cell gets the
/// patch's total less the others' sums, plus `correction` where pieces do not add up to their triangle.
class PatchSums {
 public:
  __device__ PatchSums(const SheetPass& pass, const Patch& patch, const SearchResult& found, WarpScratch& scratch)
      : pass_(pass), patch_(patch), found_(found), scratch_(scratch), lane_(threadIdx.x & 31) {
    for (int i = lane_; i < 5 * found_.count; i += 32) scratch_.exchange.sum[i] = 0;
    scratch_.exchange.lanes_of[lane_] = 0;
  }

  __device__ void label_vertices() {
    const PatchVertex* vertex = pass_.patches.vertex + patch_.vertex_first;
    const uint32_t* normal = pass_.patches.normal + patch_.vertex_first;
    if (!found_.narrow) {
      for (int i = lane_; i < patch_.vertices; i += 32)
        scratch_.label[i] = uint8_t(winner_at(scratch_.winners, found_.count, vertex[i].local(),
                                              SeedRecord{0, 0, 0, normal[i]}.normal(), pass_.search.penalty_q16));
      __syncwarp();
      return;
    }
    constexpr int kAtOnce = 4;
    for (int base = lane_; base < patch_.vertices; base += 32 * kAtOnce) {
      Local v[kAtOnce];
      int best[kAtOnce];
#pragma unroll
      for (int r = 0; r < kAtOnce; ++r)
        v[r] = base + 32 * r < patch_.vertices ? vertex[base + 32 * r].local() : Local{0, 0, 0};
      winners_at(scratch_.winners, found_.count, v, best);
#pragma unroll
      for (int r = 0; r < kAtOnce; ++r)
        if (base + 32 * r < patch_.vertices) scratch_.label[base + 32 * r] = uint8_t(best[r]);
    }
    __syncwarp();
  }

  __device__ void sum_triangles() {
    int whole = 0, cut = 0, junction = 0;
    // One round more than there are triangles empties the queues.
    for (int base = 0; base < patch_.triangles + 32; base += 32) {
      const int t = base + lane_;
      int cells = 0;
      if (t < patch_.triangles) {
        const PackedTriangle triangle = pass_.patches.triangle[patch_.triangle_first + t];
        const int a = label(triangle, 0), b = label(triangle, 1), c = label(triangle, 2);
        if (a == b && b == c)
          cells = a == found_.best ? 0 : 1;
        else
          cells = a == b || b == c || c == a ? 2 : 3;
      }
      push(scratch_.whole, whole, cells == 1, t);
      push(scratch_.cut, cut, cells == 2, t);
      push(scratch_.junction, junction, cells == 3, t);
      const int enough = base < patch_.triangles ? 32 : 1;
      if (whole >= enough) whole = drain<32>(scratch_.whole, whole, [&](int n, int i) { add_whole(n, i); });
      if (cut >= enough) cut = drain<32>(scratch_.cut, cut, [&](int n, int i) { add_cut(n, i); });
      while (junction >= min(enough, kJunctions))
        junction = drain<kJunctions>(scratch_.junction, junction, [&](int n, int i) { add_junctions(n, i); });
    }
  }

  /// Adds the sums to the cells; returns the lane's part of the energy.
  __device__ Int128 flush() {
    int64_t* sums = scratch_.exchange.sum;
    if (lane_ < 5) {
      const PieceSum& t = patch_.total;
      int64_t rest = lane_ == 0   ? t.mass
                     : lane_ == 1 ? t.first_x
                     : lane_ == 2 ? t.first_y
                     : lane_ == 3 ? t.first_z
                                  : t.second;
      for (int c = 0; c < found_.count; ++c) rest += c == found_.best ? sums[c * 5 + lane_] : -sums[c * 5 + lane_];
      sums[found_.best * 5 + lane_] = rest;
    }
    __syncwarp();
    if (lane_ >= found_.count) return 0;
    const PieceSum s = {sums[lane_ * 5], sums[lane_ * 5 + 1], sums[lane_ * 5 + 2], sums[lane_ * 5 + 3],
                        sums[lane_ * 5 + 4]};
    if (s.mass == 0 && s.first_x == 0 && s.first_y == 0 && s.first_z == 0 && s.second == 0) return 0;
    return relax_sheet::add_to_cell(pass_.cell[scratch_.winners.id[lane_]], s, scratch_.winners.place[lane_]);
  }

 private:
  __device__ int label(const PackedTriangle& t, int i) const { return scratch_.label[t.corner(i)]; }

  __device__ void push(TriangleQueue& queue, int& count, bool in, int triangle) {
    const unsigned lanes = __ballot_sync(~0u, in);
    if (in) queue.triangle[count + __popc(lanes & ((1u << lane_) - 1))] = uint16_t(triangle);
    count += __popc(lanes);
    __syncwarp();
  }

  /// Works on up to kMost triangles of the queue, one a lane; returns how many are left.
  template <int kMost, class Work>
  __device__ int drain(TriangleQueue& queue, int count, Work work) {
    const int now = min(count, kMost);
    const int triangle = queue.triangle[lane_ < now ? lane_ : 0];
    const int later = lane_ < count - now ? queue.triangle[now + lane_] : 0;
    __syncwarp();
    if (lane_ < count - now) queue.triangle[lane_] = uint16_t(later);  // at most 32 stay
    work(now, triangle);
    __syncwarp();
    return count - now;
  }

  struct Corners {
    Local p[3];
    int label[3];
    uint32_t area2;
  };
  __device__ PackedTriangle packed(int triangle) const {
    return pass_.patches.triangle[patch_.triangle_first + triangle];
  }
  __device__ Corners corners(const PackedTriangle& t) const {
    Corners c;
    c.area2 = t.area2;
#pragma unroll
    for (int i = 0; i < 3; ++i) {
      c.p[i] = pass_.patches.vertex[patch_.vertex_first + t.corner(i)].local();
      c.label[i] = label(t, i);
    }
    return c;
  }
  __device__ SplitTriangle split(const Corners& c) const {
    const Local* s = scratch_.winners.place;
    return {{c.p[0], c.p[1], c.p[2]}, {s[c.label[0]], s[c.label[1]], s[c.label[2]]}, c.area2};
  }

  __device__ void add_whole(int count, int triangle) {
    const Corners c = corners(packed(triangle));
    exchange(lane_ < count, c.label[0], piece_sum(c.area2, c.p[0], c.p[1], c.p[2]));
  }

  __device__ void add_cut(int count, int triangle) {
    const PackedTriangle t = packed(triangle);
    const int a = label(t, 0), b = label(t, 1);
    // From the corner that is alone on: which corner comes first changes no piece.
    const Corners c = corners(t.from_corner(b == label(t, 2) ? 0 : a == b ? 2 : 1));
    PieceSum one{}, rest{};
    split(c).two_cells(0, [&](int corner, const PieceSum& piece) {
      if (corner == 0)
        one = piece;
      else
        rest = piece;
    });
    const bool in = lane_ < count, one_best = c.label[0] == found_.best;
    exchange(in, one_best ? c.label[1] : c.label[0], one_best ? rest : one);
    const bool both = in && !one_best && c.label[1] != found_.best;
    if (__any_sync(~0u, both)) exchange(both, c.label[1], rest);
  }

  static constexpr int kJunctions = 8;  ///< at once, four lanes each

  /// Lane i < 3 of four cuts the piece of corner i; the last one gives the best seed what the pieces do not add up to.
  __device__ void add_junctions(int count, int triangle) {
    triangle = __shfl_sync(~0u, triangle, lane_ >> 2);
    const bool in = lane_ >> 2 < count;
    const int i = lane_ & 3, group = lane_ & ~3;
    const Corners c = corners(packed(triangle));
    const SplitTriangle whole = split(c), mine = from_corner(whole, i);
    const unsigned separating = __ballot_sync(~0u, i < 3 && mine.separates(0)) >> group & 7;
    const int k = separating ? __ffs(int(separating)) - 1 : -1;  // the corner whose seed keeps the other two apart
    int64_t* slot = scratch_.exchange.piece + lane_ * 5;
    if (k >= 0) {
      const Local other = i == (k + 1) % 3 ? mine.s[2] : mine.s[1];
      put(slot, SplitTriangle{{mine.p[0], mine.p[1], mine.p[2]}, {mine.s[0], other, other}, mine.area2}.corner(0, 1));
    } else {
      const SplitTriangle::Barycentric x = whole.meeting_point();
      const Local meet = whole.point_at(x);
      const int32_t x_mine[3] = {pick(i, x.x[0], x.x[1], x.x[2]), pick(i, x.x[1], x.x[2], x.x[0]),
                                 pick(i, x.x[2], x.x[0], x.x[1])};
      put(slot, mine.around_meeting(0, meet, {{x_mine[0], x_mine[1], x_mine[2]}}));
    }
    __syncwarp();
    const int64_t* of_group = scratch_.exchange.piece + group * 5;
    PieceSum sum = whole.total();
    if (k >= 0 && i == k)
      sum = sum - piece_at(of_group + (k + 1) % 3 * 5) - piece_at(of_group + (k + 2) % 3 * 5);
    else if (i == 3)
      sum = piece_at(of_group) + piece_at(of_group + 5) + piece_at(of_group + 10) - sum;
    __syncwarp();
    if (i == k || i == 3) put(slot, sum);
    const int label = i == 3 ? found_.best : pick(i, c.label[0], c.label[1], c.label[2]);
    add_slots(in && (i == 3 ? k < 0 : label != found_.best), label);
  }

  template <class T>
  __device__ static T pick(int i, T a, T b, T c) {
    return i == 0 ? a : i == 1 ? b : c;
  }
  __device__ static Local pick(int i, Local a, Local b, Local c) {
    return {pick(i, a.x, b.x, c.x), pick(i, a.y, b.y, c.y), pick(i, a.z, b.z, c.z)};
  }
  /// The same triangle from corner i on; any for i = 3.
  __device__ static SplitTriangle from_corner(const SplitTriangle& t, int i) {
    return {{pick(i, t.p[0], t.p[1], t.p[2]), pick(i, t.p[1], t.p[2], t.p[0]), pick(i, t.p[2], t.p[0], t.p[1])},
            {pick(i, t.s[0], t.s[1], t.s[2]), pick(i, t.s[1], t.s[2], t.s[0]), pick(i, t.s[2], t.s[0], t.s[1])},
            t.area2};
  }

  __device__ static void put(int64_t* to, const PieceSum& piece) {
    to[0] = piece.mass, to[1] = piece.first_x, to[2] = piece.first_y, to[3] = piece.first_z, to[4] = piece.second;
  }
  __device__ static PieceSum piece_at(const int64_t* from) { return {from[0], from[1], from[2], from[3], from[4]}; }

  /// Adds each lane's piece to its winner.
  __device__ void exchange(bool in, int label, const PieceSum& piece) {
    if (in) put(scratch_.exchange.piece + lane_ * 5, piece);
    add_slots(in, label);
  }

  /// Sum of the lane's moment over the pieces of some lanes.
  __device__ int64_t sum_from(unsigned lanes) const {
    int64_t sum = 0;
    for (; lanes; lanes &= lanes - 1) sum += scratch_.exchange.piece[(__ffs(int(lanes)) - 1) * 5 + lane_ % 5];
    return sum;
  }

  /// The same for pieces that lie in the lanes' slots.
  __device__ void add_slots(bool in, int label) {
    PieceExchange& x = scratch_.exchange;
    const unsigned active = __ballot_sync(~0u, in);
    if (in) x.lanes_of[label] = __match_any_sync(active, label);
    __syncwarp();
    if (found_.count <= 3) {
      // Room for two lanes a moment, one for each half of the warp.
      const unsigned half = lane_ < 15 ? 0x0000ffffu : lane_ < 30 ? 0xffff0000u : 0;
      int64_t sum = sum_from(x.lanes_of[lane_ / 5 % 3] & half);
      sum += __shfl_down_sync(~0u, sum, 15);
      if (lane_ < 5 * found_.count) x.sum[lane_] += sum;
    } else if (lane_ < 30) {
      for (int c = lane_ / 5; c < found_.count; c += 6) x.sum[5 * c + lane_ % 5] += sum_from(x.lanes_of[c]);
    }
    __syncwarp();
    if (in) x.lanes_of[label] = 0;
    __syncwarp();
  }

  const SheetPass& pass_;
  const Patch& patch_;
  const SearchResult& found_;
  WarpScratch& scratch_;
  const int lane_;
};

}  // namespace isoshell::cuda_relax
