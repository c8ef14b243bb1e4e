// Sums of the clipped cells of one patch, by one warp: the moments that each vertex owns to its label, and what
// triangles between labels move from one to another. Arithmetic is that of voxel/cell_sum.h.
#pragma once

#include "cuda/relax/patch_queue.cuh"

namespace isoshell::cuda_relax {

struct TriangleQueue {
  PackedTriangle triangle[64];
};

constexpr int kStagedTriangles = 256;

struct SumScratch {
  WinnerPlace place[kMaxWinners];
  union {
    PieceExchange exchange;
    LabelSums::Words words;
  };
  alignas(16) uint8_t label[kMaxPatchVertices];
  alignas(16) PatchVertex vertex[kStagedVertices];
  alignas(16) PackedTriangle triangle[kStagedTriangles];
  TriangleQueue split, junction;  ///< triangles in several cells, and of these those in three
  Int128 energy[32];              ///< a lane each
};

/// Sums of a labelled patch's cells.
template <bool kHold>
class PatchSums {
 public:
  __device__ PatchSums(const SheetPass& pass, const Patch& patch, const PatchWinners& winners, SumScratch& scratch)
      : pass_(pass), patch_(patch), winners_(winners), scratch_(scratch), lane_(threadIdx.x & 31) {}

  /// Starts to copy what the sums read; to be waited for before they are made.
  __device__ void start_copies() const {
    const PatchesView& all = pass_.patches;
    start_copy(scratch_.label, pass_.label + patch_.vertex_first, patch_.vertices);
    start_copy(scratch_.vertex, all.vertex + patch_.vertex_first, min(int(patch_.vertices), kStagedVertices));
    start_copy(scratch_.triangle, all.triangle + patch_.triangle_first, min(int(patch_.triangles), kStagedTriangles));
  }
  __device__ void load_owned() {
    const PieceBytes* owned = pass_.patches.owned + patch_.owned_first + lane_;
    if (kHold) {
      first_[0] = owned[0];
      first_[1] = owned[patch_.own > 32 ? 32 : 0];
    } else {
      for (int v = 4 * lane_; v < patch_.own; v += 128)
        asm volatile("prefetch.global.L2 [%0];" ::"l"(owned - lane_ + v));
    }
  }

  /// Adds the sums to the cells, and the lane's part of the energy.
  __device__ void add_to_cells() {
    const PieceBytes* owned = pass_.patches.owned + patch_.owned_first + lane_;
    for (int base = 0; base < winners_.count; base += kLabelsAtOnce) {
      const int count = min(winners_.count - base, kLabelsAtOnce);
      LabelSums sums(base, count);
      if (kHold) {
        sums.add(first_[0], scratch_.label);
        if (patch_.own > 32) sums.add(first_[1], scratch_.label + 32);
      }
#pragma unroll 2
      for (int v = kHold ? 64 : 0; v < patch_.own; v += 32) sums.add(owned[v], scratch_.label + v);
      move_between_labels(sums);
      sums.put(scratch_.words);
      if (lane_ < count) add_sum(LabelSums::sum_of(scratch_.words, lane_), base + lane_);
      __syncwarp();
    }
  }

 private:
  __device__ void add_sum(const PieceSum& s, int winner) const {
    if (s.mass == 0 && s.first_x == 0 && s.first_y == 0 && s.first_z == 0 && s.second == 0) return;
    scratch_.energy[lane_] += in_patch::add_to_cell(pass_.cell[winners_.id[winner]], s, scratch_.place[winner]);
  }

  /// A piece that goes from one label to another.
  struct Moved {
    PieceSum piece;
    uint32_t from, to;
    bool is_two;  ///< of a triangle in two cells
  };

  /// The pieces of triangles that are not in their owner's cell.
  __device__ void move_between_labels(LabelSums& sums) {
    const PackedTriangle* triangle = pass_.patches.triangle + patch_.triangle_first;
    const int count = patch_.triangles;
    int split = 0, junctions = 0;
    // One round more than there are triangles empties the queues.
    for (int base = 0;; base += 32) {
      const bool last = base >= count;
      if (!last) {
        const int i = base + lane_;
        PackedTriangle t{0, 0};  // where there is none, all corners are one
        if (i < count) t = element_of(scratch_.triangle, kStagedTriangles, triangle, i);
        const int a = label(t, 0), b = label(t, 1), c = label(t, 2);
        push(scratch_.split, split, a != b || b != c, t);
      }
      // Cuts first; the junctions among them follow.
      for (;;) {
        Moved moved;
        if (split >= (last ? 1 : 32)) {
          const int now = min(split, 32);
          const PackedTriangle t = take(scratch_.split, split, now);
          moved = cut(t, lane_ < now);
          push(scratch_.junction, junctions, lane_ < now && !moved.is_two, t);
        } else if (junctions >= (last ? 1 : kJunctions)) {
          const int now = min(junctions, kJunctions);
          moved = junction(take(scratch_.junction, junctions, now), now);
        } else {
          break;
        }
        sums.move(moved.piece, moved.from, moved.to, scratch_.exchange);
      }
      if (last) break;
    }
  }

  __device__ int label(const PackedTriangle& t, int i) const { return scratch_.label[t.corner(i)]; }

  __device__ void push(TriangleQueue& queue, int& count, bool in, const PackedTriangle& triangle) {
    const unsigned lanes = __ballot_sync(~0u, in);
    if (lanes == 0) return;
    if (in) queue.triangle[count + lanes_before(lanes)] = triangle;
    count += __popc(lanes);
    __syncwarp();
  }

  /// The queue's first triangles, one a lane; the first again where there are no more.
  __device__ PackedTriangle take(TriangleQueue& queue, int& count, int now) {
    const PackedTriangle triangle = queue.triangle[lane_ < now ? lane_ : 0];
    count -= now;
    if (count > 0) {
      const PackedTriangle later = queue.triangle[lane_ < count ? now + lane_ : 0];
      __syncwarp();
      if (lane_ < count) queue.triangle[lane_] = later;  // at most 32 stay
    }
    __syncwarp();
    return triangle;
  }

  __device__ Local corner(const PackedTriangle& t, int i) const {
    return element_of(scratch_.vertex, kStagedVertices, pass_.patches.vertex + patch_.vertex_first, t.corner(i))
        .local();
  }
  __device__ Local seed(int label) const { return scratch_.place[label]; }

  /// Triangles in two cells, one a lane: one corner is alone in its cell.
  __device__ Moved cut(const PackedTriangle& t, bool in) const {
    const int label_of[3] = {label(t, 0), label(t, 1), label(t, 2)};
    const int alone = label_of[1] == label_of[2] ? 0 : label_of[2] == label_of[0] ? 1 : 2;
    const int next = alone == 2 ? 0 : alone + 1, last = alone == 0 ? 2 : alone - 1;
    const Local p = corner(t, alone), q = corner(t, next), r = corner(t, last);
    const int here = in_patch::pick(alone, label_of[0], label_of[1], label_of[2]),
              other = in_patch::pick(next, label_of[0], label_of[1], label_of[2]);
    const bool two = alone != 2 || label_of[0] == label_of[1];
    PieceSum piece = in_patch::corner_piece32(int32_t(t.area2), p, q, r, seed(here), seed(other));
    const bool owner_alone = t.owner() == alone;
    if (owner_alone) piece = in_patch::piece_sum32(int32_t(t.area2), p, q, r) - piece;
    const uint32_t from = owner_alone ? here : other, to = owner_alone ? other : here;
    return {piece, in && two ? from : kNoLabel, in && two ? to : kNoLabel, two};
  }

  static constexpr int kJunctions = 8;  ///< at once, four lanes each

  /// Triangles in three cells (see SplitTriangle::three_cells), by four lanes each. Lane i < 3 of four cuts the piece
  /// of corner i; the last one takes the whole from the owner, and gives it to the corner that gets what the others
  /// leave, if there is one.
  __device__ Moved junction(PackedTriangle t, int count) const {
    t = {__shfl_sync(~0u, t.corners, lane_ >> 2), __shfl_sync(~0u, t.area2, lane_ >> 2)};
    const JunctionLane at = junction_lane(t);
    const int k = separating_corner(at);
    const CornerSides sides = cut_sides(at, k);
    TwoTriangles piece = cut_corner(t, sides);
    if (__any_sync(~0u, k < 0)) meet_inside(t, at, k, sides, piece);
    uint32_t from = k >= 0 ? at.label_of(k) : kNoLabel, to = at.number[0];
    if (k == at.i) from = to = kNoLabel;
    if (!at.has_corner) {
      piece = {at.mine.p[1], at.mine.p[2], piece.at_r, int32_t(t.area2), 0};
      from = at.label_of(t.owner()), to = k >= 0 ? at.label_of(k) : kNoLabel;
      if (from == to) from = to = kNoLabel;
    }
    if (lane_ >> 2 >= count) from = to = kNoLabel;
    return {in_patch::piece_sum32(piece.area2, at.mine.p[0], piece.at_q, piece.inner) +
                in_patch::piece_sum32(piece.second_area2, at.mine.p[0], piece.inner, piece.at_r),
            from, to, false};
  }

  /// A lane's part of a triangle in three cells: the corners from its own on, i, next and last.
  struct JunctionLane {
    int group, i, next, last;  ///< group: the first of the four lanes
    bool has_corner;           ///< the fourth lane has the place of the third, but not its corner
    int number[3];             ///< the corners' labels
    in_patch::Junction mine;
    __device__ uint32_t label_of(int corner) const {
      return uint32_t(corner == i ? number[0] : corner == next ? number[1] : number[2]);
    }
  };
  __device__ JunctionLane junction_lane(const PackedTriangle& t) const {
    const int i = min(lane_ & 3, 2), next = i == 2 ? 0 : i + 1, last = i == 0 ? 2 : i - 1;
    const int number[3] = {label(t, i), label(t, next), label(t, last)};
    return {lane_ & ~3,
            i,
            next,
            last,
            (lane_ & 3) < 3,
            {number[0], number[1], number[2]},
            {{corner(t, i), corner(t, next), corner(t, last)}, {seed(number[0]), seed(number[1]), seed(number[2])}}};
  }

  /// The corner whose seed keeps the other two apart, or -1.
  __device__ static int separating_corner(const JunctionLane& at) {
    const unsigned separating = __ballot_sync(~0u, at.has_corner && at.mine.separates()) >> at.group & 7;
    return separating ? __ffs(int(separating)) - 1 : -1;
  }

  /// Where bisectors cut the sides of a corner: with the neighbours' seeds, or both with the one in between.
  struct CornerSides {
    int32_t on_q, on_r;
    Local at_q, at_r;
  };
  __device__ static CornerSides cut_sides(const JunctionLane& at, int k) {
    const in_patch::Junction& mine = at.mine;
    const Local other_q = k == at.last ? mine.s[2] : mine.s[1], other_r = k == at.next ? mine.s[1] : mine.s[2];
    const int32_t on_q = crossing(mine, other_q, 1), on_r = crossing(mine, other_r, 2);
    return {on_q, on_r, between_32(mine.p[0], mine.p[1], on_q), between_32(mine.p[0], mine.p[2], on_r)};
  }

  /// The piece of the corner p: the triangles (p, at_q, inner) and (p, inner, at_r), of which the second may be
  /// nothing.
  struct TwoTriangles {
    Local at_q, inner, at_r;
    int32_t area2, second_area2;
  };
  __device__ static TwoTriangles cut_corner(const PackedTriangle& t, const CornerSides& sides) {
    return {sides.at_q, sides.at_r, sides.at_r, part_of(t.area2, sides.on_q * sides.on_r >> 15), 0};
  }

  /// Where no corner keeps the others apart, the cells meet inside. All lanes of the warp call it.
  __device__ void meet_inside(const PackedTriangle& t, const JunctionLane& at, int k, const CornerSides& sides,
                              TwoTriangles& piece) const {
    using in_patch::pick;
    const int32_t weight = meeting_weight(at.mine, at.group, at.i);
    const int32_t weight_1 = __shfl_sync(~0u, weight, at.group + 1), weight_2 = __shfl_sync(~0u, weight, at.group + 2);
    if (k >= 0) return;
    const int32_t x[3] = {kOneQ15 - weight_1 - weight_2, weight_1, weight_2};
    piece.inner = meeting_point(t, weight_1, weight_2);
    piece.area2 = part_of(t.area2, sides.on_q * pick(at.last, x[0], x[1], x[2]) >> 15);
    piece.second_area2 = part_of(t.area2, sides.on_r * pick(at.next, x[0], x[1], x[2]) >> 15);
  }

  /// Where the bisector of its first seed with another crosses the side to corner `end`.
  __device__ static int32_t crossing(const in_patch::Junction& j, Local other, int end) {
    return in_patch::crossing32(bisector_value(j.p[0], j.s[0], other), bisector_value(j.p[end], j.s[0], other));
  }

  /// SplitTriangle::meeting_point, of which lane i of four gives the weight of corner i.
  __device__ static int32_t meeting_weight(const in_patch::Junction& j, int group, int i) {
    // The seeds in the triangle's order.
    const Local s0 = in_patch::pick(i, j.s[0], j.s[2], j.s[1]), s1 = in_patch::pick(i, j.s[1], j.s[0], j.s[2]),
                s2 = in_patch::pick(i, j.s[2], j.s[1], j.s[0]);
    const double f1 = double(bisector_value(j.p[1], s0, s1)), g1 = double(bisector_value(j.p[1], s0, s2)),
                 f2 = double(bisector_value(j.p[2], s0, s1)), g2 = double(bisector_value(j.p[2], s0, s2));
    double w = f1 * g2 - f2 * g1;
    const auto total = [&] {
      const double w0 = __shfl_sync(~0u, w, group), w1 = __shfl_sync(~0u, w, group + 1),
                   w2 = __shfl_sync(~0u, w, group + 2);
      return w0 + w1 + w2;
    };
    const double before = total();
    w = before != 0 ? w / before : 1.0 / 3;
    if (!(w > 0)) w = 0;
    return int32_t(w / total() * kOneQ15);
  }

  __device__ Local meeting_point(const PackedTriangle& t, int32_t weight_1, int32_t weight_2) const {
    const Local a = corner(t, 0), b = corner(t, 1), c = corner(t, 2);
    const auto at = [&](int32_t a, int32_t b, int32_t c) {
      return a + int32_t((int64_t(b - a) * weight_1 + int64_t(c - a) * weight_2 + kOneQ15 / 2) >> 15);
    };
    return {at(a.x, b.x, c.x), at(a.y, b.y, c.y), at(a.z, b.z, c.z)};
  }

  const SheetPass& pass_;
  const Patch& patch_;
  const PatchWinners& winners_;
  SumScratch& scratch_;
  const int lane_;
  PieceBytes first_[2];  ///< moments of the first vertices
};

}  // namespace isoshell::cuda_relax
