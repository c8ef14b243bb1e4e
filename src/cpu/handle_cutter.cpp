#include "cpu/handle_cutter.h"

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

}  // namespace

VoxelContacts contacts_of(uint32_t solid) {
  solid &= kAll & ~kCentre;
  return {count_parts(solid, solid, with_all_neighbours),
          count_parts(~solid & kShareAnEdge, kFaces, with_face_neighbours)};
}

HandleCutter::HandleCutter(const int32_t extent_vox[3])
    : extent_{extent_vox[0], extent_vox[1], extent_vox[2]},
      flags_(size_t(extent_[0] * extent_[1] * extent_[2])),
      rank_(flags_.size()),
      waiting_(kRanks) {}

void HandleCutter::add(int64_t voxel, int rank) {
  flags_[size_t(voxel)] |= kSolid;
  rank_[size_t(voxel)] = uint8_t(rank);
}

template <class Visit>
void HandleCutter::for_each_around(int64_t voxel, Visit visit) const {
  for (int64_t dx = -1; dx <= 1; ++dx)
    for (int64_t dy = -1; dy <= 1; ++dy)
      for (int64_t dz = -1; dz <= 1; ++dz)
        if (dx || dy || dz) visit(voxel + (dx * extent_[1] + dy) * extent_[2] + dz);
}

uint32_t HandleCutter::grown_around(int64_t voxel) const {
  uint32_t bits = 0;
  int row = 0;
  for (int64_t dx = -1; dx <= 1; ++dx)
    for (int64_t dy = -1; dy <= 1; ++dy, row += 3) {
      const uint8_t* flags = &flags_[size_t(voxel + (dx * extent_[1] + dy) * extent_[2] - 1)];
      for (int z = 0; z < 3; ++z) bits |= uint32_t((flags[z] & kGrown) != 0) << (row + z);
    }
  return bits;
}

/// Visits the component of a voxel; returns its first of the lowest rank.
int64_t HandleCutter::visit_component(int64_t start) {
  std::vector<int64_t> stack{start};
  int64_t lowest = start;
  flags_[size_t(start)] |= kVisited;
  while (!stack.empty()) {
    const int64_t v = stack.back();
    stack.pop_back();
    const int rank = rank_[size_t(v)], least = rank_[size_t(lowest)];
    if (rank < least || (rank == least && v < lowest)) lowest = v;
    for_each_around(v, [&](int64_t n) {
      if (!is(n, kSolid, kSolid | kVisited)) return;
      flags_[size_t(n)] |= kVisited;
      stack.push_back(n);
    });
  }
  return lowest;
}

/// Whatever waited in vain around it gets another chance.
void HandleCutter::add_grown(int64_t voxel) {
  flags_[size_t(voxel)] |= kGrown;
  for_each_around(voxel, [&](int64_t n) {
    if (!is(n, kSolid, kSolid | kGrown | kWaiting)) return;
    flags_[size_t(n)] |= kWaiting;
    const int rank = rank_[size_t(n)];
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
    if (queue.first > kMostLeft && 2 * queue.first > queue.voxels.size()) queue.drop_left();
    flags_[size_t(v)] &= uint8_t(~kWaiting);
    if (is_simple(grown_around(v))) add_grown(v);
    if ((++looked_at & 0xffff) == 0) check();
  }
}

std::vector<int64_t> HandleCutter::cuts() const {
  std::vector<int64_t> out;
  for (int64_t v = 0; v < int64_t(flags_.size()); ++v)
    if (is(v, kSolid, kSolid | kGrown)) out.push_back(v);
  return out;
}

/// Voxels that were left out and touch one another.
std::vector<HandleCutter::Cut> HandleCutter::list_cuts() {
  std::vector<Cut> found;
  const std::vector<int64_t> left_out = cuts();
  for (const int64_t v : left_out) flags_[size_t(v)] |= kVisited;
  for (const int64_t start : left_out) {
    if (!is(start, kVisited, kVisited)) continue;
    Cut cut{kRanks, {start}};
    flags_[size_t(start)] &= uint8_t(~kVisited);
    for (size_t i = 0; i < cut.voxels.size(); ++i) {
      cut.rank = std::min(cut.rank, int(rank_[size_t(cut.voxels[i])]));
      for_each_around(cut.voxels[i], [&](int64_t n) {
        if (!is(n, kSolid | kVisited, kSolid | kGrown | kVisited)) return;
        flags_[size_t(n)] &= uint8_t(~kVisited);
        cut.voxels.push_back(n);
      });
    }
    found.push_back(std::move(cut));
  }
  return found;
}

void HandleCutter::close(const Cut& cut) {
  for (const int64_t v : cut.voxels) flags_[size_t(v)] |= kGrown;
}

void HandleCutter::close_cuts_below(int rank) {
  for (const Cut& cut : list_cuts())
    if (cut.rank < rank) close(cut);
}

void HandleCutter::grow(int64_t handles, const std::function<void()>& check) {
  for (int64_t v = 0; v < int64_t(flags_.size()); ++v)
    if (is(v, kSolid, kSolid | kVisited)) grow_from(visit_component(v), check);
  if (handles <= 0) return;
  std::vector<Cut> found = list_cuts();
  std::stable_sort(found.begin(), found.end(), [](const Cut& a, const Cut& b) { return a.rank < b.rank; });
  for (size_t i = 0; i < found.size() && int64_t(i) < handles; ++i) close(found[i]);
}

}  // namespace isoshell
