// Equal positions become one vertex. Corners are dealt by hash into parts whose tables fit the cache; then each part
// finds the first corner of every position on its own.
#include "io/mesh/weld.h"

#include <algorithm>
#include <cstring>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

constexpr int64_t kCornersPerBlock = 1 << 16;
constexpr int kMostPartBits = 10;
constexpr int64_t kCornersPerPart = 1 << 14;

uint64_t bits_of(float value) {
  value += 0.0f;  // -0 becomes 0
  uint32_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

uint64_t bits_of(double value) {
  value += 0.0;
  uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

template <class Real>
bool same(const RawPosition<Real>& a, const RawPosition<Real>& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y) && bits_of(a.z) == bits_of(b.z);
}

template <class Real>
uint64_t hash(const RawPosition<Real>& p) {
  uint64_t h = bits_of(p.x) * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 29) ^ bits_of(p.y)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 32) ^ bits_of(p.z)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

// A position travels with its corner, so that a part is searched without a look outside it.
template <class Real>
struct Entry {
  RawPosition<Real> position;
  uint32_t corner;
};

// Corners by part, ascending within one: entries of part k are [start[k], start[k + 1]).
template <class Real>
struct Parts {
  std::vector<int64_t> start;
  Buffer<Entry<Real>> entries;
};

int64_t block_count_of(int64_t count) { return (count + kCornersPerBlock - 1) / kCornersPerBlock; }

template <class Visit>
void each_in_block(int64_t block, int64_t count, Visit visit) {
  for (int64_t i = block * kCornersPerBlock; i < std::min(count, (block + 1) * kCornersPerBlock); ++i) visit(i);
}

template <class Corners>
Parts<typename Corners::Real> deal(int64_t count, Corners corners) {
  int part_bits = 0;
  while (part_bits < kMostPartBits && count >> part_bits > kCornersPerPart) ++part_bits;
  const int64_t part_count = int64_t(1) << part_bits, block_count = block_count_of(count);
  const auto part_of = [&](int64_t i) { return size_t(hash(corners[i]) >> 54) >> (10 - part_bits); };
  std::vector<int64_t> at(size_t(part_count * block_count), 0);  // block major
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    int64_t* const counts = at.data() + block * part_count;
    each_in_block(block, count, [&](int64_t i) { ++counts[part_of(i)]; });
  });
  Parts<typename Corners::Real> parts;
  int64_t total = 0;
  for (int64_t part = 0; part < part_count; ++part) {
    parts.start.push_back(total);
    for (int64_t block = 0; block < block_count; ++block) {
      int64_t& here = at[size_t(block * part_count + part)];
      total += here;
      here = total - here;
    }
  }
  parts.start.push_back(total);
  parts.entries = Buffer<Entry<typename Corners::Real>>(count);
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    int64_t* const next = at.data() + block * part_count;
    each_in_block(block, count, [&](int64_t i) { parts.entries[next[part_of(i)]++] = {corners[i], uint32_t(i)}; });
  });
  return parts;
}

// first[i]: the first corner at the position of corner i.
template <class Real>
void find_first(const Parts<Real>& parts, Buffer<uint32_t>& first) {
  constexpr uint32_t kNone = 0xffffffff;
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
      first[entries[e].corner] = entries[table[slot]].corner;
    }
  });
}

}  // namespace

RawPosition<float> BinaryStlCorners::operator[](int64_t corner) const {
  constexpr int64_t kFacetBytes = 50, kNormalBytes = 12, kCornerBytes = 12;
  const char* const p = facets + corner / 3 * kFacetBytes + kNormalBytes + corner % 3 * kCornerBytes;
  const auto load = [](const char* at) {  // little-endian, on any machine
    const auto byte = [&](int i) { return uint32_t(static_cast<unsigned char>(at[i])) << 8 * i; };
    const uint32_t bits = byte(0) | byte(1) | byte(2) | byte(3);
    float value;
    std::memcpy(&value, &bits, sizeof value);
    return value;
  };
  return {load(p), load(p + 4), load(p + 8)};
}

template <class Corners>
WeldedCorners weld_corners(const MeshSource& source, int64_t count, Corners corners) {
  if (count > kMaxSoupVertices)
    source.refuse("holds " + std::to_string(count) + " face corners; at most " + std::to_string(kMaxSoupVertices) +
                  " can be read, split the file");
  Buffer<uint32_t> first(count);
  find_first(deal(count, corners), first);

  const int64_t block_count = block_count_of(count);
  std::vector<int64_t> start(size_t(block_count) + 1, 0);
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    int64_t vertices = 0;
    each_in_block(block, count, [&](int64_t i) { vertices += first[i] == i; });
    start[size_t(block) + 1] = vertices;
  });
  for (size_t block = 1; block < start.size(); ++block) start[block] += start[block - 1];
  WeldedCorners welded{VertexTable(source, start.back()), std::vector<Triangle>(size_t((count + 2) / 3))};
  const auto index = [&](int64_t i) -> uint32_t& { return welded.index[size_t(i / 3)][size_t(i % 3)]; };
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    int64_t vertex = start[size_t(block)];
    each_in_block(block, count, [&](int64_t i) {
      if (first[i] != i) return;
      const auto position = corners[i];
      welded.vertices.points[size_t(vertex)] = {position.x, position.y, position.z};
      index(i) = uint32_t(vertex++);
    });
  });
  for_each_index(int64_t(0), block_count, [&](int64_t block) {
    each_in_block(block, count, [&](int64_t i) {
      if (first[i] != i) index(i) = index(first[i]);
    });
  });
  welded.vertices.count_nonfinite();
  return welded;
}

template WeldedCorners weld_corners(const MeshSource&, int64_t, BinaryStlCorners);
template WeldedCorners weld_corners(const MeshSource&, int64_t, CornerArray);
template WeldedCorners weld_corners(const MeshSource&, int64_t, FloatCornerArray);

}  // namespace isoshell
