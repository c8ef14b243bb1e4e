// Sides of an unsigned distance field by a watershed and a vote.
#include "implicit/volumes/unsigned_field.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/parallel_ranges.h"
#include "implicit/volumes/block_lattice.h"
#include "isoshell/advanced/buffer.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

constexpr int32_t kOneVoxel = 2048;             // distances are integers in this unit
constexpr int32_t kDeepest = 16 * kOneVoxel;    // larger ones are all the same
constexpr int32_t kMostClosed = 8 * kOneVoxel;  // ends of edges with a larger sum are on one side, whatever lies around
constexpr int32_t kLeastPeak = kOneVoxel / 2;   // of a region of its own
constexpr int64_t kBytesPerPoint = 34;          // depth, parent, peak, and up to three edges to sort
constexpr uint32_t kMostBlocks = 1u << 22;
constexpr int kDirections = 6;  // axis, and 3 more for its other end

using Pair = std::pair<uint64_t, int64_t>;  // two regions, the smaller in front, and their score

/// A lattice edge by how deep it lies, then by its place; sorting puts deep ones first.
uint64_t sort_word(int32_t sum, uint32_t node, int direction) {
  return uint64_t(uint16_t(65535 - sum)) << 48 | (uint64_t(node) * kDirections + uint64_t(direction));
}

class SignedField : public ScalarField {
 public:
  SignedField(const ScalarField& of, const BlockLattice& lattice, const std::vector<uint8_t>& inside)
      : of_(of), lattice_(lattice), inside_(inside) {
    file = of.file;
    name = of.name;
    grid_class = "level set";
    background = of.background;
    to_world = of.to_world;
    sides = of.sides;
  }
  std::vector<Voxel> blocks() const override { return lattice_.blocks(); }
  std::vector<FieldTile> tiles() const override { return {}; }
  void copy(Voxel origin, const int size[3], float* to) const override {
    of_.copy(origin, size, to);
    const uint32_t first = lattice_.node_at(origin);
    const bool in_block = lattice_.is_in_block(first);
    for (int x = 0; x < size[0]; ++x)
      for (int y = 0; y < size[1]; ++y)
        for (int z = 0; z < size[2]; ++z)
          if (inside_[first + (in_block ? uint32_t(x * 64 + y * 8 + z) : 0)] &&
              (!sides || sides->hold({origin.x + x, origin.y + y, origin.z + z})))
            turn(to[x * kWindowStride[0] + y * kWindowStride[1] + z]);
  }

 private:
  /// A point inside on the surface itself must stay inside.
  static void turn(float& value) { value = value == 0 ? -std::numeric_limits<float>::min() : -value; }

  const ScalarField& of_;
  const BlockLattice lattice_;
  const std::vector<uint8_t> inside_;
};

class Sides {
 public:
  Sides(const ScalarField& field, double voxel) : field_(field), lattice_(field.blocks()) {
    full_ = rounded(kFullPart * field.background / voxel);
    load(voxel);
  }

  SignedSides find() {
    grow_regions();
    const std::vector<uint8_t> inside = vote();
    SignedSides sides;
    sides.enclosing_part = enclosing_part(inside);
    sides.field = std::make_unique<SignedField>(field_, lattice_, inside);
    return sides;
  }

 private:
  static int32_t rounded(double voxels) {
    return voxels < double(kDeepest) / kOneVoxel ? int32_t(voxels * kOneVoxel + 0.5) : kDeepest;  // also of NaN
  }

  void load(double voxel) {
    const uint32_t nodes = lattice_.node_count();
    depth_.assign(nodes, uint16_t(full_));
    beside_.resize(size_t(lattice_.block_count()) * kDirections);
    each_block([&](uint32_t b) {
      float window[kWindow * kWindow * kWindow];
      const int all[3] = {kFieldBlock, kFieldBlock, kFieldBlock};
      const Voxel o = lattice_.blocks()[b];
      field_.copy(o, all, window);
      for (uint32_t i = 0; i < kBlockPoints; ++i) {
        const int at = int(i >> 6) * kWindowStride[0] + int(i >> 3 & 7) * kWindowStride[1] + int(i & 7);
        depth_[size_t(b) * kBlockPoints + i] = uint16_t(std::min(full_, rounded(double(window[at]) / voxel)));
      }
      for (int d = 0; d < kDirections; ++d) {
        const int32_t step = d < 3 ? kFieldBlock : -kFieldBlock;
        const Voxel next{o.x + (d % 3 == 0 ? step : 0), o.y + (d % 3 == 1 ? step : 0), o.z + (d % 3 == 2 ? step : 0)};
        beside_[size_t(b) * kDirections + size_t(d)] = lattice_.node_at(next);
      }
    });
    parent_ = Buffer<uint32_t>(int64_t(nodes));
    std::iota(parent_.view().data, parent_.view().data + nodes, 0u);
  }

  template <class Work>
  void each_block(Work work) const {
    for_each_index(uint32_t(0), lattice_.block_count(), work);
  }

  /// The other end of a block's edge: along an axis, or against it.
  uint32_t other_end(uint32_t node, int direction) const {
    const int shift = 6 - 3 * (direction % 3);
    const uint32_t along = node >> shift & 7, step = 1u << shift;
    if (direction < 3 && along < 7) return node + step;
    if (direction >= 3 && along > 0) return node - step;
    const uint32_t next = beside_[size_t(node / kBlockPoints) * kDirections + size_t(direction)];
    if (!lattice_.is_in_block(next)) return next;
    return next + ((node & (kBlockPoints - 1)) ^ 7u * step);
  }

  /// Calls visit(node, direction, other node) once for every edge that begins or ends in a block.
  template <class Visit>
  void each_edge(uint32_t block, Visit visit) const {
    const uint32_t first = block * kBlockPoints;
    for (uint32_t node = first; node < first + kBlockPoints; ++node)
      for (int d = 0; d < kDirections; ++d) {
        if (d >= 3 && (node >> (6 - 3 * (d - 3)) & 7) != 0) continue;  // that edge begins at its other end
        const uint32_t other = other_end(node, d);
        if (d < 3 || !lattice_.is_in_block(other)) visit(node, d, other);
      }
  }
  int32_t sum(uint32_t a, uint32_t b) const { return int32_t(depth_[a]) + depth_[b]; }
  bool is_one_side(uint32_t a, uint32_t b) const { return sum(a, b) > kMostClosed || sum(a, b) == 2 * full_; }

  void grow_regions() {
    const View<uint32_t> parent = parent_.view();
    lattice_.each_touching_gap([&](uint32_t a, uint32_t b) { join(parent, a, b); });
    std::vector<size_t> first(size_t(lattice_.block_count()) + 1);
    each_block([&](uint32_t b) {
      each_edge(b, [&](uint32_t node, int, uint32_t other) {
        if (is_one_side(node, other))
          join(parent, node, other);
        else
          ++first[b + 1];
      });
    });
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<uint64_t> edges(first.back());
    each_block([&](uint32_t b) {
      size_t at = first[b];
      each_edge(b, [&](uint32_t node, int direction, uint32_t other) {
        if (!is_one_side(node, other)) edges[at++] = sort_word(sum(node, other), node, direction);
      });
    });
    tbb::parallel_sort(edges.begin(), edges.end());
    std::vector<uint16_t> peak(depth_.size());
    for (uint32_t node = 0; node < lattice_.node_count(); ++node) {
      uint16_t& of_root = peak[find_root(parent, node)];
      of_root = std::max(of_root, uint16_t(depth_[node] < full_ ? depth_[node] : kDeepest));  // nobody knows how deep
    }
    for (const uint64_t word : edges) {
      const uint64_t place = word & ((uint64_t(1) << 48) - 1);
      const uint32_t node = uint32_t(place / kDirections);
      meet(peak, find_root(parent, node), find_root(parent, other_end(node, int(place % kDirections))),
           65535 - int32_t(word >> 48));
    }
  }

  /// Joins two regions unless both have a peak a quarter above the place where they meet.
  void meet(std::vector<uint16_t>& peak, uint32_t a, uint32_t b, int32_t sum) {
    if (a == b) return;
    const int32_t lower = std::min(peak[a], peak[b]);
    if (lower >= kLeastPeak && 8 * lower >= 5 * sum) return;
    join(parent_.view(), a, b);
    peak[std::min(a, b)] = std::max(peak[a], peak[b]);
  }

  /// Pairs of regions in contact. Above 0 the edges between them say that they are two sides.
  std::vector<Pair> contacts() {
    const View<uint32_t> parent = parent_.view();
    std::vector<std::vector<Pair>> of_block(lattice_.block_count());
    each_block([&](uint32_t b) {
      each_edge(b, [&](uint32_t node, int, uint32_t other) {
        const uint64_t p = find_root(parent, node), q = find_root(parent, other);
        if (p != q)
          of_block[b].push_back({std::min(p, q) << 32 | std::max(p, q), sum(node, other) > kOneVoxel ? -1 : 1});
      });
      add_up(of_block[b]);
    });
    std::vector<Pair> all;
    for (const auto& some : of_block) all.insert(all.end(), some.begin(), some.end());
    add_up(all);
    return all;
  }
  static void add_up(std::vector<Pair>& pairs) {
    std::sort(pairs.begin(), pairs.end());
    size_t kept = 0;
    for (size_t i = 0; i < pairs.size(); ++i) {
      if (kept > 0 && pairs[kept - 1].first == pairs[i].first)
        pairs[kept - 1].second += pairs[i].second;
      else
        pairs[kept++] = pairs[i];
    }
    pairs.resize(kept);
  }

  /// 1 for nodes on the other side than the outside.
  std::vector<uint8_t> vote() {
    std::vector<Pair> pairs = contacts();
    std::sort(pairs.begin(), pairs.end(), [](const Pair& a, const Pair& b) {
      return std::abs(a.second) != std::abs(b.second) ? std::abs(a.second) > std::abs(b.second) : a.first < b.first;
    });
    const View<uint32_t> region = parent_.view();
    const uint32_t nodes = lattice_.node_count();
    // Twins: 2 r is region r on its side, 2 r + 1 its opposite. Only regions are ever looked at.
    std::vector<uint32_t> of_region(nodes), roots;
    for (uint32_t node = 0; node < nodes; ++node)
      if (find_root(region, node) == node) of_region[node] = uint32_t(roots.size()), roots.push_back(node);
    Buffer<uint32_t> twins{int64_t(2 * roots.size())};
    std::iota(twins.view().data, twins.view().data + 2 * roots.size(), 0u);
    for (const Pair& pair : pairs) {
      if (pair.second == 0) continue;
      const uint32_t a = 2 * of_region[pair.first >> 32], b = 2 * of_region[uint32_t(pair.first)];
      const uint32_t differ = pair.second > 0;
      if (find_root(twins.view(), a) == find_root(twins.view(), b ^ 1 ^ differ)) continue;  // said otherwise before
      join(twins.view(), a, b ^ differ);
      join(twins.view(), a ^ 1, b ^ 1 ^ differ);
    }
    const uint32_t opposite = find_root(twins.view(), 2 * of_region[find_root(region, lattice_.outside())] + 1);
    std::vector<uint8_t> inside(nodes);
    for (uint32_t node = 0; node < nodes; ++node)
      inside[node] = find_root(twins.view(), 2 * of_region[find_root(region, node)]) == opposite;
    return inside;
  }

  /// Edges between the sides, by those that a surface of the same area cuts on average: 3 of 2 points in half a voxel.
  double enclosing_part(const std::vector<uint8_t>& inside) const {
    std::vector<int64_t> cut(lattice_.block_count()), near(lattice_.block_count());
    each_block([&](uint32_t b) {
      each_edge(b, [&](uint32_t node, int, uint32_t other) { cut[b] += inside[node] != inside[other]; });
      for (uint32_t i = 0; i < kBlockPoints; ++i) near[b] += 2 * depth_[size_t(b) * kBlockPoints + i] <= kOneVoxel;
    });
    const double cuts = double(std::accumulate(cut.begin(), cut.end(), int64_t(0)));
    const double points = double(std::accumulate(near.begin(), near.end(), int64_t(0)));
    return points > 0 ? std::min(1.0, cuts / (1.5 * points)) : 1;
  }

  const ScalarField& field_;
  const BlockLattice lattice_;
  int32_t full_ = kDeepest;       // depth where the band ends
  std::vector<uint16_t> depth_;   // per node
  std::vector<uint32_t> beside_;  // per block and direction the first node of the next block, or its gap
  Buffer<uint32_t> parent_;       // per node, of its region
};

}  // namespace

SignedSides find_sides(const ScalarField& field, double voxel, int64_t memory_limit_bytes) {
  const int64_t blocks = int64_t(field.blocks().size()), bytes = blocks * kBlockPoints * kBytesPerPoint;
  if (blocks > kMostBlocks || (memory_limit_bytes > 0 && bytes > memory_limit_bytes))
    throw Error(ErrorCode::out_of_memory, "memory",
                field.title() + ": finding the sides of its zero set takes " + std::to_string(bytes >> 20) +
                    " MiB for " + std::to_string(blocks) + " blocks, more than the limit; resample it coarser" +
                    (blocks > kMostBlocks ? "" : " or raise --max-memory"));
  return Sides(field, voxel).find();
}

}  // namespace isoshell
