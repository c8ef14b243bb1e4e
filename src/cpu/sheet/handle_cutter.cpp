#include "cpu/sheet/handle_cutter.h"

#include <algorithm>
#include <cstring>

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

/// Four voxels as they lie, the first one lowest, and what has a one for each of the first three or four.
uint64_t word_of(const uint16_t* cells) {
  static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "the first one is the lowest");
  uint64_t word;
  std::memcpy(&word, cells, sizeof word);
  return word;
}
constexpr uint64_t kThree = 0x000100010001, kFour = 0x0001000100010001;

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
      cells_((size_t(extent_[0] * extent_[1] * extent_[2]) / 4 + 1) * 4),  // words are read beyond the last
      waiting_(kRanks),
      known_(size_t(1) << kKnownBits) {}

void HandleCutter::add(int64_t voxel, int rank) {
  cells_[size_t(voxel)] = uint16_t(rank << kRankShift | (cells_[size_t(voxel)] & 0xff) | kSolid);
}

/// Three voxels along z around a voxel, and one more: nine rows, 3 (x + 1) + y + 1.
const uint16_t* HandleCutter::row(int64_t voxel, int number) const {
  return &cells_[size_t(voxel + ((number / 3 - 1) * extent_[1] + number % 3 - 1) * extent_[2] - 1)];
}

template <class Visit>
void HandleCutter::for_each_around(int64_t voxel, int flags, int of, Visit visit) const {
  for (int n = 0; n < 9; ++n) {
    const uint16_t* three = row(voxel, n);
    const uint64_t differs = (word_of(three) & kThree * uint64_t(of)) ^ kThree * uint64_t(flags);
    uint64_t fits = ~(differs + kThree * 0x7fff) & kThree << 15;
    if (n == 4) fits &= ~(uint64_t(1) << 31);
    for (; fits != 0; fits &= fits - 1) visit(three - cells_.data() + __builtin_ctzll(fits) / 16);
  }
}

uint32_t HandleCutter::grown_around(int64_t voxel) const {
  uint32_t bits = 0;
  for (int n = 0; n < 9; ++n) {
    const uint64_t grown = word_of(row(voxel, n)) / kGrown & kThree;
    bits |= uint32_t((grown | grown >> 15 | grown >> 30) & 7) << 3 * n;
  }
  return bits;
}

/// Whether a voxel is simple. Fronts meet few kinds of neighbourhoods, again and again.
bool HandleCutter::may_grow(int64_t voxel) {
  const uint32_t around = grown_around(voxel);
  uint32_t& known = known_[around * 2654435761u >> (32 - kKnownBits)];
  if (known >> 1 != around) known = around << 1 | (is_simple(around) ? 1 : 0);
  return known & 1;
}

/// Asks early for the memory of what is around a voxel.
void HandleCutter::expect(int64_t voxel) const {
  for (int n = 0; n < 9; ++n) __builtin_prefetch(row(voxel, n));
}

/// Visits the component of a voxel, run by run along z; returns its first of the lowest rank.
int64_t HandleCutter::visit_component(int64_t start) {
  const auto is_left = [&](int64_t v) { return is(v, kSolid, kSolid | kVisited); };
  std::vector<int64_t> stack{start};
  int64_t lowest = start;
  while (!stack.empty()) {
    int64_t first = stack.back(), last = first;
    stack.pop_back();
    if (!is_left(first)) continue;
    while (is_left(first - 1)) --first;
    while (is_left(last + 1)) ++last;
    for (int64_t v = first; v <= last; ++v) {
      set(v, kVisited);
      const int rank = rank_of(v), least = rank_of(lowest);
      if (rank < least || (rank == least && v < lowest)) lowest = v;
    }
    for (int n = 0; n < 9; ++n) {
      const int64_t away = row(start, n) + 1 - &cells_[size_t(start)];
      const int64_t begin = first + away - 1, end = last + away + 1;
      for (int64_t v = begin; v <= end; ++v)
        if (is_left(v) && (v == begin || !is_left(v - 1))) stack.push_back(v);
    }
  }
  return lowest;
}

/// Whatever waited in vain around it gets another chance.
void HandleCutter::add_grown(int64_t voxel) {
  set(voxel, kGrown);
  for_each_around(voxel, kSolid, kSolid | kGrown | kWaiting, [&](int64_t n) {
    set(n, kWaiting);
    const int rank = rank_of(n);
    waiting_[size_t(rank)].voxels.push_back(n);
    lowest_waiting_ = std::min(lowest_waiting_, rank);
  });
}

void HandleCutter::grow_from(int64_t start, const std::function<void()>& check) {
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
    clear(v, kWaiting);
    if (may_grow(v)) add_grown(v);
    if ((++looked_at & 0xffff) == 0) check();
  }
}

/// Calls visit(index) for all voxels with kSolid and without the other flag, ascending; visits may set that.
template <class Visit>
void HandleCutter::for_each_solid_without(int flag, Visit visit) const {
  for (size_t begin = 0; begin < cells_.size(); begin += 4) {
    const uint64_t four = word_of(&cells_[begin]);
    if ((four & ~(four / uint64_t(flag)) & kFour) == 0) continue;
    for (size_t v = begin; v < begin + 4; ++v)
      if (is(int64_t(v), kSolid, kSolid | flag)) visit(int64_t(v));
  }
}

std::vector<int64_t> HandleCutter::cuts() const {
  std::vector<int64_t> out;
  for_each_solid_without(kGrown, [&](int64_t v) { out.push_back(v); });
  return out;
}

/// Voxels that were left out and touch one another.
std::vector<HandleCutter::Cut> HandleCutter::list_cuts() {
  std::vector<Cut> found;
  const std::vector<int64_t> left_out = cuts();
  for (const int64_t v : left_out) set(v, kVisited);
  for (const int64_t start : left_out) {
    if (!is(start, kVisited, kVisited)) continue;
    Cut cut{kRanks, {start}};
    clear(start, kVisited);
    for (size_t i = 0; i < cut.voxels.size(); ++i) {
      cut.rank = std::min(cut.rank, rank_of(cut.voxels[i]));
      for_each_around(cut.voxels[i], kSolid | kVisited, kSolid | kGrown | kVisited, [&](int64_t n) {
        clear(n, kVisited);
        cut.voxels.push_back(n);
      });
    }
    found.push_back(std::move(cut));
  }
  return found;
}

void HandleCutter::close(const Cut& cut) {
  for (const int64_t v : cut.voxels) set(v, kGrown);
}

void HandleCutter::close_cuts_below(int rank) {
  for (const Cut& cut : list_cuts())
    if (cut.rank < rank) close(cut);
}

void HandleCutter::grow(int64_t handles, const std::function<void()>& check) {
  for_each_solid_without(kVisited, [&](int64_t v) { grow_from(visit_component(v), check); });
  if (handles <= 0) return;
  std::vector<Cut> found = list_cuts();
  std::stable_sort(found.begin(), found.end(), [](const Cut& a, const Cut& b) { return a.rank < b.rank; });
  for (size_t i = 0; i < found.size() && int64_t(i) < handles; ++i) close(found[i]);
}

}  // namespace isoshell
