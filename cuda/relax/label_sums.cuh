// Sums of pieces per label by one warp, on the tensor cores: the product of a matrix of the pieces' bytes and a matrix
// that says which label each piece goes to (1) and which it is taken from (-1). Exact: bytes and their sums are
// integers, and what the bytes of a sum leave of its carries comes back when it is put together.
//
// A piece is eight words of four bytes; a product has the bytes of 32 pieces, one a lane, as its rows, and 8 labels.
#pragma once

#include "voxel/cell_sum.h"

namespace isoshell::cuda_relax {

constexpr int kLabelsAtOnce = 16;  ///< whose sums a warp holds in registers
constexpr uint32_t kNoLabel = 127;

/// Bounds under which sums of a label come back whole: of first moments 48 bits are kept, of the mass 32. A piece
/// counts at most as a few times its triangle, so that the sums of a patch stay within eight times its total (see
/// voxel/cell_sum.h): mass below 2^31, first moments below 2^46, second moments below 2^63.
constexpr int64_t kMaxPatchMass = int64_t(1) << 28;
/// And their bytes' sums stay below 2^31.
constexpr int kMaxPatchTriangles = 4096;

/// Bytes of 32 pieces as the tensor cores take them: `low` holds bytes 0 and 1 of the words, `high` bytes 2 and 3.
struct alignas(16) PieceBytes {
  uint4 low, high;
};

/// How the words of the pieces reach the lanes that hand in their bytes.
struct alignas(16) PieceExchange {
  uint32_t word[8 * 32];
  uint8_t to[32], from[32];
};

namespace label_sums {

/// The four words' bytes 0, bytes 1, bytes 2 and bytes 3.
__device__ inline uint4 transposed(uint4 w) {
  const uint32_t xy = __byte_perm(w.x, w.y, 0x5140), zw = __byte_perm(w.z, w.w, 0x5140),
                 high_xy = __byte_perm(w.x, w.y, 0x7362), high_zw = __byte_perm(w.z, w.w, 0x7362);
  return {__byte_perm(xy, zw, 0x5410), __byte_perm(xy, zw, 0x7632), __byte_perm(high_xy, high_zw, 0x5410),
          __byte_perm(high_xy, high_zw, 0x7632)};
}

/// 1 in each byte that is `label`; bytes and label are below 128.
__device__ inline uint32_t equal(uint32_t labels, uint32_t label) {
  return (~((labels ^ label * 0x01010101u) + 0x7f7f7f7fu) >> 7) & 0x01010101u;
}

/// sum += bytes * ways: 16 rows of 32 bytes, 32 rows of 8 signed bytes.
__device__ inline void multiply_add(int32_t (&sum)[4], const uint4& bytes, uint2 ways) {
#if __CUDA_ARCH__ >= 800
  asm("mma.sync.aligned.m16n8k32.row.col.s32.u8.s8.s32 {%0,%1,%2,%3}, {%4,%5,%6,%7}, {%8,%9}, {%0,%1,%2,%3};"
      : "+r"(sum[0]), "+r"(sum[1]), "+r"(sum[2]), "+r"(sum[3])
      : "r"(bytes.x), "r"(bytes.y), "r"(bytes.z), "r"(bytes.w), "r"(ways.x), "r"(ways.y));
#else
  const auto part = [](int32_t& first, int32_t& second, uint32_t a, uint32_t b) {
    asm("mma.sync.aligned.m8n8k16.row.col.s32.u8.s8.s32 {%0,%1}, {%2}, {%3}, {%0,%1};"
        : "+r"(first), "+r"(second)
        : "r"(a), "r"(b));
  };
  part(sum[0], sum[1], bytes.x, ways.x);
  part(sum[0], sum[1], bytes.z, ways.y);
  part(sum[2], sum[3], bytes.y, ways.x);
  part(sum[2], sum[3], bytes.w, ways.y);
#endif
}

}  // namespace label_sums

/// The warp's pieces, one a lane, as bytes. All lanes call it; none (zero) counts as nothing.
__device__ inline PieceBytes bytes_of(const PieceSum& piece, PieceExchange& exchange) {
  const int lane = threadIdx.x & 31;
  const uint64_t x = uint64_t(piece.first_x), y = uint64_t(piece.first_y), z = uint64_t(piece.first_z);
  const uint32_t word[8] = {uint32_t(piece.mass),
                            uint32_t(piece.second),
                            uint32_t(uint64_t(piece.second) >> 32),
                            uint32_t(x),
                            uint32_t(y),
                            uint32_t(z),
                            __byte_perm(uint32_t(x >> 32), uint32_t(y >> 32), 0x5410),
                            uint32_t(z >> 32) & 0xffff};
  // Every other row is turned by half, so that the reads below spread over the banks.
#pragma unroll
  for (int w = 0; w < 8; ++w) exchange.word[w * 32 + (lane ^ (w & 1) << 4)] = word[w];
  __syncwarp();
  const int row = lane >> 2, column = (lane & 3) * 4, turn = (row & 1) << 4;
  const uint32_t* words = exchange.word + row * 32;
  const uint4 a = label_sums::transposed(*reinterpret_cast<const uint4*>(words + (column ^ turn))),
              b = label_sums::transposed(*reinterpret_cast<const uint4*>(words + (column + 16 ^ turn)));
  return {{a.x, a.y, b.x, b.y}, {a.z, a.w, b.z, b.w}};
}

/// Sums of the labels base .. base + kLabelsAtOnce - 1, of which `count` are wanted.
class LabelSums {
 public:
  __device__ LabelSums(int base, int count) : label_(base + int(threadIdx.x & 31) / 4), two_(count > 8) {}

  /// Adds pieces to their labels, which lie in 32 bytes at a multiple of 4.
  __device__ void add(const PieceBytes& bytes, const uint8_t* label) {
    const uint32_t* four = reinterpret_cast<const uint32_t*>(label) + (threadIdx.x & 3);
    const uint2 to = {four[0], four[4]};
    multiply_add(bytes, 0, {label_sums::equal(to.x, label_), label_sums::equal(to.y, label_)});
    if (two_) multiply_add(bytes, 1, {label_sums::equal(to.x, label_ + 8), label_sums::equal(to.y, label_ + 8)});
  }

  /// Moves each lane's piece from one label to another; either may be kNoLabel.
  __device__ void move(const PieceSum& piece, uint32_t from, uint32_t to, PieceExchange& exchange) {
    const int lane = threadIdx.x & 31;
    exchange.to[lane] = uint8_t(to);
    exchange.from[lane] = uint8_t(from);
    const PieceBytes bytes = bytes_of(piece, exchange);
    const uint32_t* to_four = reinterpret_cast<const uint32_t*>(exchange.to) + (lane & 3);
    const uint32_t* from_four = reinterpret_cast<const uint32_t*>(exchange.from) + (lane & 3);
    const uint2 t = {to_four[0], to_four[4]}, f = {from_four[0], from_four[4]};
    __syncwarp();
    multiply_add(bytes, 0, {way(f.x, t.x, label_), way(f.y, t.y, label_)});
    if (two_) multiply_add(bytes, 1, {way(f.x, t.x, label_ + 8), way(f.y, t.y, label_ + 8)});
  }

  /// Words of the sums for `sum_of`.
  struct alignas(16) Words {
    int2 word[kLabelsAtOnce][10];  ///< 8 are used; sums of bytes 0 and 1, of bytes 2 and 3
  };
  __device__ void put(Words& out) const {
    const int lane = threadIdx.x & 31, row = lane >> 2, column = lane & 3;
#pragma unroll
    for (int group = 0; group < 2; ++group) {
      const int32_t(&low)[4] = sum_[2 * group], (&high)[4] = sum_[2 * group + 1];
      if (group && !two_) break;
#pragma unroll
      for (int second = 0; second < 2; ++second)
        out.word[8 * group + 2 * column + second][row] = {low[second] + 256 * low[second + 2],
                                                          high[second] + 256 * high[second + 2]};
    }
    __syncwarp();
  }
  __device__ static PieceSum sum_of(const Words& words, int label) {
    const int2* w = words.word[label];
    const auto word = [&](int i) { return uint64_t(int64_t(w[i].x)) + (uint64_t(int64_t(w[i].y)) << 16); };
    const auto first = [](uint64_t low, int32_t high) {
      return int64_t(low + (uint64_t(uint32_t(high)) << 32) << 16) >> 16;
    };
    return {int32_t(word(0)), first(word(3), w[6].x), first(word(4), w[6].y), first(word(5), w[7].x),
            int64_t(word(1) + (word(2) << 32))};
  }

 private:
  __device__ static uint32_t way(uint32_t from, uint32_t to, uint32_t label) {
    return label_sums::equal(to, label) + 0xff * label_sums::equal(from, label);
  }
  __device__ void multiply_add(const PieceBytes& bytes, int group, uint2 ways) {
    label_sums::multiply_add(sum_[2 * group], bytes.low, ways);
    label_sums::multiply_add(sum_[2 * group + 1], bytes.high, ways);
  }

  const uint32_t label_;
  const bool two_;
  int32_t sum_[4][4] = {};
};

}  // namespace isoshell::cuda_relax
