// Equal positions become one vertex. Most corners repeat one that came shortly before, which a small table finds. The
// others are dealt by hash into parts whose tables fit the cache; then each part finds the first corner of every
// position on its own.
#include "io/faces/weld.h"

#include <algorithm>
#include <cstring>
#include <numeric>
#include <type_traits>

#include "core/parallel_ranges.h"
#include "io/bytes/byte_order.h"

namespace isoshell {
namespace {

constexpr int64_t kCornersPerBlock = 1 << 16;
constexpr int kMostPartBits = 10;
constexpr int64_t kCornersPerPart = 1 << 15;
constexpr int kMostRecentBits = 12;  // whose table fits the nearest cache
constexpr uint32_t kNone = 0xffffffff;

/// Of one value, whichever sign its zero has.
template <class Real>
uint64_t value_bits(Real value) {
  value += Real(0);
  std::conditional_t<sizeof(Real) == 4, uint32_t, uint64_t> bits;
  std::memcpy(&bits, &value, sizeof value);
  return bits;
}

template <class Real>
bool same(const RawPosition<Real>& a, const RawPosition<Real>& b) {
  return value_bits(a.x) == value_bits(b.x) && value_bits(a.y) == value_bits(b.y) && value_bits(a.z) == value_bits(b.z);
}

// Of a position; its highest bits are the best.
template <class Real>
uint64_t weak_hash(const RawPosition<Real>& p) {
  return value_bits(p.x) * 0x9e3779b97f4a7c15u + value_bits(p.y) * 0xbf58476d1ce4e5b9u +
         value_bits(p.z) * 0x94d049bb133111ebu;
}

uint64_t strong_hash(uint64_t weak) {
  const uint64_t h = (weak ^ (weak >> 32)) * 0xd6e8feb86659fd93u;
  return h ^ (h >> 31);
}

template <class Real>
uint64_t hash(const RawPosition<Real>& p) {
  return strong_hash(weak_hash(p));
}

// A position travels with its corner, so that a part is searched without a look outside it.
template <class Real>
struct Entry {
  RawPosition<Real> position;
  uint32_t corner;
};

int64_t block_count_of(int64_t count) { return (count + kCornersPerBlock - 1) / kCornersPerBlock; }

template <class Visit>
void each_in_block(int64_t block, int64_t count, Visit visit) {
  for (int64_t i = block * kCornersPerBlock; i < std::min(count, (block + 1) * kCornersPerBlock); ++i) visit(i);
}

// The corners of a block that were met last, one a slot.
template <class Corners>
class RecentCorners {
 public:
  RecentCorners(int64_t count, Corners corners) : corners_(corners) {
    while (shift_ > 64 - kMostRecentBits && count >> (64 - shift_) > 0) --shift_;
    slots_.resize(size_t(1) << (64 - shift_));
  }
  // An earlier corner at the same position, which repeats none itself; kNone: not known, and `corner` is from now on.
  uint32_t find(uint64_t weak_hash, const RawPosition<typename Corners::Real>& position, int64_t corner) {
    Slot& slot = slots_[weak_hash >> shift_];
    const auto tag = uint32_t(weak_hash >> 20);
    if (slot.tag == tag && slot.corner != kNone && same(corners_[slot.corner], position)) return slot.corner;
    slot = {tag, uint32_t(corner)};
    return kNone;
  }

 private:
  struct Slot {
    uint32_t tag = 0, corner = kNone;
  };
  Corners corners_;
  int shift_ = 60;
  std::vector<Slot> slots_;
};

// At most, while corners are welded: their earlier ones, those that were dealt, and their entries with tables.
template <class Real>
constexpr int64_t kBytesPerCorner = 12 + int64_t(sizeof(Entry<Real>)) + 4;

// Corners by part, ascending within one: entries of part k are [start[k], start[k + 1]).
template <class Real>
struct Parts {
  std::vector<int64_t> start;
  Buffer<Entry<Real>> entries;
};

struct DealtCorner {
  uint32_t corner, hash;
};
// Per corner an earlier one, or itself, at the same position. That of a corner that is among the `dealt`, ascending in
// each block, is the first of all; that of another is among the dealt of its block.
struct EarlierCorners {
  Buffer<uint32_t> of;
  Buffer<DealtCorner> dealt;         // those of a block begin at its first corner's place
  std::vector<int64_t> dealt_count;  // per block

  explicit EarlierCorners(int64_t count) : of(count), dealt(count), dealt_count(size_t(block_count_of(count)), 0) {}
  View<const DealtCorner> dealt_of(size_t block) const {
    return {dealt.data() + int64_t(block) * kCornersPerBlock, dealt_count[block]};
  }
  uint32_t first_of(int64_t i) const { return of[of[i]]; }
};

// The corners of a block that repeat no recent one are to be dealt.
template <class Corners>
void find_recent(int64_t block, int64_t count, Corners corners, EarlierCorners& earlier) {
  RecentCorners recent(count, corners);
  int64_t dealt = block * kCornersPerBlock;
  each_in_block(block, count, [&](int64_t i) {
    const auto position = corners[i];
    const uint64_t weak = weak_hash(position);
    const uint32_t found = recent.find(weak, position, i);
    earlier.of[i] = found;
    if (found == kNone) earlier.dealt[dealt++] = {uint32_t(i), uint32_t(strong_hash(weak) >> 32)};
  });
  earlier.dealt_count[size_t(block)] = dealt - block * kCornersPerBlock;
}

template <class Corners>
Parts<typename Corners::Real> deal(Corners corners, const EarlierCorners& earlier) {
  int64_t total = std::accumulate(earlier.dealt_count.begin(), earlier.dealt_count.end(), int64_t(0));
  int part_bits = 0;
  while (part_bits < kMostPartBits && total >> part_bits > kCornersPerPart) ++part_bits;
  const size_t part_count = size_t(1) << part_bits, block_count = earlier.dealt_count.size();
  const auto part_of = [=](const DealtCorner& dealt) { return uint64_t(dealt.hash) >> (32 - part_bits); };
  std::vector<int64_t> at(part_count * block_count, 0);  // block major
  for_each_index(size_t(0), block_count, [&](size_t block) {
    int64_t* const counts = at.data() + block * part_count;
    for (const DealtCorner& dealt : earlier.dealt_of(block)) ++counts[part_of(dealt)];
  });
  Parts<typename Corners::Real> parts{{}, Buffer<Entry<typename Corners::Real>>(total)};
  total = 0;
  for (size_t part = 0; part < part_count; ++part) {
    parts.start.push_back(total);
    for (size_t block = 0; block < block_count; ++block) {
      int64_t& here = at[block * part_count + part];
      total += here;
      here = total - here;
    }
  }
  parts.start.push_back(total);
  for_each_index(size_t(0), block_count, [&](size_t block) {
    int64_t* const next = at.data() + block * part_count;
    for (const DealtCorner& dealt : earlier.dealt_of(block))
      parts.entries[next[part_of(dealt)]++] = {corners[dealt.corner], dealt.corner};
  });
  return parts;
}

// For those that were dealt.
template <class Real>
void find_first(const Parts<Real>& parts, EarlierCorners& earlier) {
  for_each_index(size_t(0), parts.start.size() - 1, [&](size_t part) {
    const Entry<Real>* const entries = parts.entries.data() + parts.start[part];
    const uint32_t count = uint32_t(parts.start[part + 1] - parts.start[part]);
    size_t slots = 16;
    while (slots < 2 * size_t(count)) slots *= 2;
    std::vector<uint32_t> table(slots, kNone);
    for (uint32_t e = 0; e < count; ++e) {
      size_t slot = hash(entries[e].position) & (slots - 1);
      while (table[slot] != kNone && !same(entries[table[slot]].position, entries[e].position))
        slot = (slot + 1) & (slots - 1);
      if (table[slot] == kNone) table[slot] = e;
      earlier.of[entries[e].corner] = entries[table[slot]].corner;
    }
  });
}

template <class Corners>
EarlierCorners earlier_corners(int64_t count, Corners corners) {
  EarlierCorners earlier(count);
  for_each_index(int64_t(0), block_count_of(count),
                 [&](int64_t block) { find_recent(block, count, corners, earlier); });
  find_first(deal(corners, earlier), earlier);
  return earlier;
}

RawPosition<float> load_position(const char* p) {
  return {load_little_endian<float>(p), load_little_endian<float>(p + 4), load_little_endian<float>(p + 8)};
}

}  // namespace

RawPosition<float> BinaryStlCorners::operator[](int64_t corner) const {
  constexpr int64_t kFacetBytes = 50, kNormalBytes = 12, kCornerBytes = 12;
  return load_position(facets + corner / 3 * kFacetBytes + kNormalBytes + corner % 3 * kCornerBytes);
}

RawPosition<float> StridedCorners::operator[](int64_t corner) const { return load_position(first + corner * stride); }

template <class Corners>
void weld_corners(const MeshSource& source, int64_t count, Corners corners, VertexTable& vertices, uint32_t* index) {
  if (count > kMaxSoupVertices)
    source.refuse("holds " + std::to_string(count) + " face corners; at most " + std::to_string(kMaxSoupVertices) +
                  " can be read, split the file");
  const HeldBytes held(source, count * kBytesPerCorner<typename Corners::Real>);
  const EarlierCorners earlier = earlier_corners(count, corners);
  const int64_t block_count = block_count_of(count);
  std::vector<int64_t> start(size_t(block_count) + 1, int64_t(vertices.points.size()));
  std::vector<int64_t> nonfinite(start.size() - 1, 0);
  for_each_index(size_t(0), size_t(block_count), [&](size_t block) {
    const View<const DealtCorner> dealt = earlier.dealt_of(block);
    start[block + 1] = std::count_if(dealt.begin(), dealt.end(),
                                     [&](const DealtCorner& d) { return earlier.of[d.corner] == d.corner; });
  });
  std::partial_sum(start.begin(), start.end(), start.begin());
  resize_counted(source, vertices.points, size_t(start.back()));
  std::vector<std::vector<uint32_t>> later(start.size() - 1);  // corners whose first one is of another block
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    int64_t vertex = start[size_t(block)];
    each_in_block(block, count, [&](int64_t i) {
      const uint32_t first = earlier.first_of(i);
      if (first == i) {
        const auto position = corners[i];
        WorldPoint& point = vertices.points[size_t(vertex)] = {position.x, position.y, position.z};
        nonfinite[size_t(block)] += !is_finite(point);
        index[i] = uint32_t(vertex++);
      } else if (first >= block * kCornersPerBlock) {
        index[i] = index[first];
      } else {
        later[size_t(block)].push_back(uint32_t(i));
      }
    });
  });
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    for (const uint32_t i : later[size_t(block)]) index[i] = index[earlier.first_of(i)];
  });
  vertices.nonfinite += std::accumulate(nonfinite.begin(), nonfinite.end(), int64_t(0));
}

template <class Corners>
WeldedCorners weld_corners(const MeshSource& source, int64_t count, Corners corners) {
  WeldedCorners welded{VertexTable(source, 0), {}};
  resize_counted(source, welded.index, size_t((count + 2) / 3));
  weld_corners(source, count, corners, welded.vertices, reinterpret_cast<uint32_t*>(welded.index.data()));
  return welded;
}

template WeldedCorners weld_corners(const MeshSource&, int64_t, BinaryStlCorners);
template WeldedCorners weld_corners(const MeshSource&, int64_t, CornerArray);
template void weld_corners(const MeshSource&, int64_t, FloatCornerArray, VertexTable&, uint32_t*);
template void weld_corners(const MeshSource&, int64_t, StridedCorners, VertexTable&, uint32_t*);

}  // namespace isoshell
