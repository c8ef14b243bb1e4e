// Equal positions become one vertex. Corners are dealt by hash into parts whose tables fit the cache; then each part
// finds the first corner of every position on its own.
#include "io/weld.h"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <cstring>

namespace isoshell {
namespace {

constexpr uint32_t kNone = 0xffffffff;
constexpr int64_t kCornersPerBlock = 1 << 16;

uint64_t bits_of(double value) {
  value += 0.0;  // -0 becomes 0
  uint64_t bits;
  std::memcpy(&bits, &value, sizeof bits);
  return bits;
}

bool same(const WorldPoint& a, const WorldPoint& b) {
  return bits_of(a.x) == bits_of(b.x) && bits_of(a.y) == bits_of(b.y) && bits_of(a.z) == bits_of(b.z);
}

uint64_t hash(const WorldPoint& p) {
  uint64_t h = bits_of(p.x) * 0x9e3779b97f4a7c15u;
  h = (h ^ (h >> 29) ^ bits_of(p.y)) * 0xbf58476d1ce4e5b9u;
  h = (h ^ (h >> 32) ^ bits_of(p.z)) * 0x94d049bb133111ebu;
  return h ^ (h >> 31);
}

struct Entry {
  uint32_t corner, hash;
};

// Corners by part, ascending within one: entries of part k are [start[k], start[k + 1]).
struct Parts {
  std::vector<int64_t> start;
  std::vector<Entry> entries;
};

Parts deal(const std::vector<WorldPoint>& corners) {
  const int64_t count = int64_t(corners.size());
  int part_bits = 0;
  while (part_bits < 10 && count >> part_bits > 1 << 14) ++part_bits;
  const int64_t part_count = int64_t(1) << part_bits, block_count = (count + kCornersPerBlock - 1) / kCornersPerBlock;
  const auto part_of = [&](uint64_t h) { return size_t(h >> 54) >> (10 - part_bits); };
  std::vector<int64_t> at(size_t(part_count * block_count), 0);  // block major
  const auto each_corner = [&](int64_t block, auto visit) {
    for (int64_t i = block * kCornersPerBlock; i < std::min(count, (block + 1) * kCornersPerBlock); ++i)
      visit(i, hash(corners[size_t(i)]));
  };
  tbb::parallel_for(int64_t(0), block_count, [&](int64_t block) {
    int64_t* const counts = at.data() + block * part_count;
    each_corner(block, [&](int64_t, uint64_t h) { ++counts[part_of(h)]; });
  });
  Parts parts;
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
  parts.entries.resize(size_t(count));
  tbb::parallel_for(int64_t(0), block_count, [&](int64_t block) {
    int64_t* const next = at.data() + block * part_count;
    each_corner(block, [&](int64_t i, uint64_t h) {
      parts.entries[size_t(next[part_of(h)]++)] = {uint32_t(i), uint32_t(h)};
    });
  });
  return parts;
}

// first[i]: the first corner at the position of corner i.
void find_first(const std::vector<WorldPoint>& corners, const Parts& parts, std::vector<uint32_t>& first) {
  tbb::parallel_for(size_t(0), parts.start.size() - 1, [&](size_t part) {
    const int64_t count = parts.start[part + 1] - parts.start[part];
    size_t slots = 16;
    while (int64_t(slots) < 2 * count) slots *= 2;
    std::vector<Entry> table(slots, Entry{kNone, 0});
    for (int64_t e = parts.start[part]; e < parts.start[part + 1]; ++e) {
      const Entry entry = parts.entries[size_t(e)];
      size_t slot = entry.hash & (slots - 1);
      while (table[slot].corner != kNone &&
             !(table[slot].hash == entry.hash && same(corners[table[slot].corner], corners[entry.corner])))
        slot = (slot + 1) & (slots - 1);
      if (table[slot].corner == kNone) table[slot] = entry;
      first[entry.corner] = table[slot].corner;
    }
  });
}

}  // namespace

WeldedCorners weld_corners(const MeshSource& source, const std::vector<WorldPoint>& corners) {
  const int64_t count = int64_t(corners.size());
  if (count > kMaxSoupVertices)
    source.refuse("holds " + std::to_string(count) + " face corners; at most " + std::to_string(kMaxSoupVertices) +
                  " can be read, split the file");
  std::vector<uint32_t> first(corners.size());
  find_first(corners, deal(corners), first);

  const int64_t block_count = (count + kCornersPerBlock - 1) / kCornersPerBlock;
  const auto each_first = [&](int64_t block, auto visit) {
    for (int64_t i = block * kCornersPerBlock; i < std::min(count, (block + 1) * kCornersPerBlock); ++i)
      if (first[size_t(i)] == i) visit(i);
  };
  std::vector<int64_t> start(size_t(block_count) + 1, 0);
  tbb::parallel_for(int64_t(0), block_count,
                    [&](int64_t block) { each_first(block, [&](int64_t) { ++start[size_t(block) + 1]; }); });
  for (size_t block = 1; block < start.size(); ++block) start[block] += start[block - 1];
  WeldedCorners welded{VertexTable(source, start.back()), std::vector<uint32_t>(corners.size())};
  tbb::parallel_for(int64_t(0), block_count, [&](int64_t block) {
    int64_t vertex = start[size_t(block)];
    each_first(block, [&](int64_t i) {
      welded.vertices.points[size_t(vertex)] = corners[size_t(i)];
      welded.index[size_t(i)] = uint32_t(vertex++);
    });
  });
  tbb::parallel_for(int64_t(0), block_count, [&](int64_t block) {
    for (int64_t i = block * kCornersPerBlock; i < std::min(count, (block + 1) * kCornersPerBlock); ++i)
      if (first[size_t(i)] != i) welded.index[size_t(i)] = welded.index[first[size_t(i)]];
  });
  welded.vertices.count_nonfinite();
  return welded;
}

}  // namespace isoshell
