#include "cpu/sheet/handle_cutter.h"

#include <algorithm>

namespace isoshell {
namespace {

// Of the 27 bits: those with y or z of -1 and of +1, and kinds of neighbours.
constexpr uint32_t kAll = 0x7ffffff, kCentre = 1u << 13;
constexpr uint32_t kLowY = 0x7 | 0x7 << 9 | 0x7 << 18, kHighY = kLowY << 6;
constexpr uint32_t kLowZ = 0x1249249, kHighZ = kLowZ << 2;
constexpr uint32_t kFaces = 1u << 4 | 1u << 22 | 1u << 10 | 1u << 16 | 1u << 12 | 1u << 14;
constexpr uint32_t kCorners = 0x145 | 0x145 << 18;
constexpr uint32_t kShareAnEdge = kAll & ~kCorners & ~kCentre;

uint32_t along_x(uint32_t m) { return (m << 9 & kAll) | m >> 9; }
uint32_t along_y(uint32_t m) { return (m << 3 & kAll & ~kLowY) | (m >> 3 & ~kHighY); }
uint32_t along_z(uint32_t m) { return (m << 1 & kAll & ~kLowZ) | (m >> 1 & ~kHighZ); }

uint32_t with_face_neighbours(uint32_t m) { return m | along_x(m) | along_y(m) | along_z(m); }
uint32_t with_all_neighbours(uint32_t m) {
  m |= along_z(m);
  m |= along_y(m);
  return m | along_x(m);
}

/// Connected parts of `among` that hold a bit of `starts`.
template <class Widen>
int count_parts(uint32_t among, uint32_t starts, Widen widen) {
  int count = 0;
  for (uint32_t left = among & starts; left; ++count) {
    uint32_t part = left & (~left + 1);
    for (uint32_t before = 0; part != before;) {
      before = part;
      part = widen(part) & among;
    }
    left &= ~part;
  }
  return count;
}

constexpr int kKnownBits = 14;
constexpr size_t kAhead = 8;  ///< voxels that wait between asking for memory and using it

}  // namespace

VoxelContacts contacts_of(uint32_t solid) {
  solid &= kAll & ~kCentre;
  return {count_parts(solid, solid, with_all_neighbours),
          count_parts(~solid & kShareAnEdge, kFaces, with_face_neighbours)};
}

HandleCutter::HandleCutter(const int32_t extent_vox[3])
    : extent_{extent_vox[0], extent_vox[1], extent_vox[2]},
      solid_(extent_[0] * extent_[1] * extent_[2]),
      grown_(extent_[0] * extent_[1] * extent_[2]),
      left_(extent_[0] * extent_[1] * extent_[2]),
      rank_(size_t(extent_[0] * extent_[1] * extent_[2])),
      waiting_(kRanks),
      known_(size_t(1) << kKnownBits) {
  for (int n = 0; n < 9; ++n) row_[n] = ((n / 3 - 1) * extent_[1] + n % 3 - 1) * extent_[2];
}

void HandleCutter::add(int64_t voxel, int rank) {
  solid_.set(voxel);
  rank_[size_t(voxel)] = uint8_t(rank);
}

uint32_t HandleCutter::around(const BitPlane& plane, int64_t voxel) const {
  uint32_t bits = 0;
  for (int n = 0; n < 9; ++n) bits |= uint32_t(plane.from(row(voxel, n) - 1) & 7) << 3 * n;
  return bits;
}

template <class Visit>
void HandleCutter::take_around(int64_t voxel, Visit visit) {
  for (uint32_t bits = around(left_, voxel) & ~kCentre; bits; bits &= bits - 1) {
    const int bit = __builtin_ctz(bits);
    const int64_t at = row(voxel, bit / 3) + bit % 3 - 1;
    left_.clear(at);
    visit(at);
  }
}

/// Whether a voxel is simple. Fronts meet few kinds of neighbourhoods, again and again.
bool HandleCutter::may_grow(int64_t voxel) {
  const uint32_t grown = around(grown_, voxel);
  uint32_t& known = known_[grown * 2654435761u >> (32 - kKnownBits)];
  if (known >> 1 != grown) known = grown << 1 | (is_simple(grown) ? 1 : 0);
  return known & 1;
}

/// Takes the component of a voxel out of `left_`, run by run along z; returns its first of the lowest rank.
int64_t HandleCutter::visit_component(int64_t start) {
  std::vector<int64_t> stack{start};
  int64_t lowest = start;
  while (!stack.empty()) {
    int64_t first = stack.back(), last = first;
    stack.pop_back();
    if (!left_[first]) continue;
    while (left_[first - 1]) --first;
    while (left_[last + 1]) ++last;
    for (int64_t v = first; v <= last; ++v) {
      left_.clear(v);
      const int rank = rank_of(v), least = rank_of(lowest);
      if (rank < least || (rank == least && v < lowest)) lowest = v;
    }
    for (int n = 0; n < 9; ++n) {
      const int64_t away = row(start, n) - start, end = last + away + 1;
      for (int64_t v = first + away - 1; v <= end; v += 64) {
        const int64_t beyond = std::max<int64_t>(0, v + 63 - end);
        const uint64_t run = left_.from(v) << beyond >> beyond;
        for (uint64_t starts = run & ~(run << 1); starts; starts &= starts - 1)
          stack.push_back(v + __builtin_ctzll(starts));
      }
    }
  }
  return lowest;
}

/// Asks early for the ranks around a voxel, which no cache holds all of.
void HandleCutter::expect(int64_t voxel) const {
  for (int n = 0; n < 9; ++n) __builtin_prefetch(&rank_[size_t(row(voxel, n))]);
}

/// Whatever waited in vain around it gets another chance.
void HandleCutter::add_grown(int64_t voxel) {
  grown_.set(voxel);
  take_around(voxel, [&](int64_t n) {
    const int rank = rank_of(n);
    waiting_[size_t(rank)].voxels.push_back(uint32_t(n));
    lowest_waiting_ = std::min(lowest_waiting_, rank);
  });
}

void HandleCutter::grow_from(int64_t start, const std::function<void()>& check) {
  left_.clear(start);
  add_grown(start);
  int64_t looked_at = 0;
  for (lowest_waiting_ = 0; lowest_waiting_ < kRanks;) {
    Queue& queue = waiting_[size_t(lowest_waiting_)];
    if (queue.first == queue.voxels.size()) {
      queue = {};
      ++lowest_waiting_;
      continue;
    }
    const int64_t v = queue.voxels[queue.first++];
    if (queue.first + kAhead < queue.voxels.size()) expect(queue.voxels[queue.first + kAhead]);
    if (queue.first > kMostLeft && 2 * queue.first > queue.voxels.size()) queue.drop_left();
    if (may_grow(v))
      add_grown(v);
    else
      left_.set(v);
    if ((++looked_at & 0xffff) == 0) check();
  }
}

std::vector<int64_t> HandleCutter::cuts() const {
  std::vector<int64_t> out;
  for (size_t w = 0; w < solid_.words().size(); ++w)
    for (uint64_t bits = solid_.words()[w] & ~grown_.words()[w]; bits; bits &= bits - 1)
      out.push_back(int64_t(w) * 64 + __builtin_ctzll(bits));
  return out;
}

/// Voxels that were left out and touch one another.
std::vector<HandleCutter::Cut> HandleCutter::list_cuts() {
  std::vector<Cut> found;
  for (const int64_t start : cuts()) {
    if (!left_[start]) continue;
    Cut cut{kRanks, {start}};
    left_.clear(start);
    for (size_t i = 0; i < cut.voxels.size(); ++i) {
      cut.rank = std::min(cut.rank, rank_of(cut.voxels[i]));
      take_around(cut.voxels[i], [&](int64_t n) { cut.voxels.push_back(n); });
    }
    found.push_back(std::move(cut));
  }
  for (const Cut& cut : found)
    for (const int64_t v : cut.voxels) left_.set(v);
  return found;
}

void HandleCutter::close(const Cut& cut) {
  for (const int64_t v : cut.voxels) {
    grown_.set(v);
    left_.clear(v);
  }
}

void HandleCutter::close_cuts_below(int rank) {
  for (const Cut& cut : list_cuts())
    if (cut.rank < rank) close(cut);
}

void HandleCutter::grow(int64_t handles, const std::function<void()>& check) {
  left_.become(solid_);
  std::vector<int64_t> starts;
  for (size_t w = 0; w < left_.words().size(); ++w)
    while (left_.words()[w]) starts.push_back(visit_component(int64_t(w) * 64 + __builtin_ctzll(left_.words()[w])));
  left_.become(solid_);
  for (const int64_t start : starts) grow_from(start, check);
  if (handles <= 0) return;
  std::vector<Cut> found = list_cuts();
  std::stable_sort(found.begin(), found.end(), [](const Cut& a, const Cut& b) { return a.rank < b.rank; });
  for (size_t i = 0; i < found.size() && int64_t(i) < handles; ++i) close(found[i]);
}

}  // namespace isoshell
