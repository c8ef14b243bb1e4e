// See absorb_islands.h.
#include "implicit/labels/absorb_islands.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <numeric>
#include <set>
#include <unordered_map>
#include <utility>

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int kMostRounds = 8;  ///< islands among islands wait for those around them
constexpr int64_t kRowsBetweenLooks = 256;

/// Voxels of one label in a row.
struct Run {
  int32_t begin, end;  ///< along x
  int32_t label;
};

/// The runs of a volume, row by row, and which of them are connected.
class Islands {
 public:
  Islands(const LabelVolume& volume, const Context& context) : volume_(volume), context_(context) {
    const int64_t rows = int64_t(size(1)) * size(2);
    first_.push_back(0);
    for (int64_t row = 0; row < rows; ++row) {
      look_for_cancel(row);
      const int32_t* const label = volume.labels.data() + row * size(0);
      for (int32_t x = 0; x < size(0);) {
        int32_t end = x + 1;
        while (end < size(0) && label[end] == label[x]) ++end;
        runs_.push_back({x, end, label[x]});
        x = end;
      }
      first_.push_back(runs_.size());
    }
    parent_.resize(runs_.size());
    std::iota(parent_.begin(), parent_.end(), size_t(0));
    each_touching([&](size_t a, size_t b) {
      if (runs_[a].label == runs_[b].label) join(a, b);
    });
    measure();
  }

  /// Calls visit(run, island) for those of small islands.
  template <class Visit>
  void each_small(Visit visit) {
    for (size_t r = 0; r < runs_.size(); ++r)
      if (const size_t island = root(r); is_small_[island]) visit(r, island);
  }

  /// Result: what small islands become, by their first runs.
  std::unordered_map<size_t, int32_t> labels_around() {
    std::unordered_map<size_t, std::map<int32_t, int64_t>> faces;
    const auto vote = [&](size_t of, size_t beside, int64_t count) {
      const size_t island = root(of), other = root(beside);
      if (is_small_[island] && !is_small_[other]) faces[island][runs_[beside].label] += count;
    };
    each_touching([&](size_t a, size_t b) {
      const int64_t count = std::min(runs_[a].end, runs_[b].end) - std::max(runs_[a].begin, runs_[b].begin);
      const int64_t shared = std::max<int64_t>(count, 1);  // along x they share one face
      vote(a, b, shared);
      vote(b, a, shared);
    });
    each_small([&](size_t r, size_t island) {
      if (const int64_t outside = faces_outside(r); outside > 0) faces[island][volume_.background] += outside;
    });
    std::unordered_map<size_t, int32_t> out;
    for (const auto& [island, votes] : faces) {
      const auto most = std::max_element(votes.begin(), votes.end(),
                                         [](const auto& a, const auto& b) { return a.second < b.second; });
      out[island] = most->first;
    }
    return out;
  }

  const Run& run(size_t r) const { return runs_[r]; }
  int64_t row_of(size_t r) const { return std::upper_bound(first_.begin(), first_.end(), r) - first_.begin() - 1; }

 private:
  int32_t size(size_t axis) const { return volume_.size_vox[axis]; }
  void look_for_cancel(int64_t row) const {
    if (row % kRowsBetweenLooks == 0) check_cancel(context_, "read");
  }

  /// Calls visit(a, b) for runs that share faces, the earlier one first.
  template <class Visit>
  void each_touching(Visit visit) const {
    for (int64_t row = 0; row + 1 < int64_t(first_.size()); ++row) {
      look_for_cancel(row);
      for (size_t r = first_[size_t(row)] + 1; r < first_[size_t(row) + 1]; ++r) visit(r - 1, r);
      if (row % size(1) > 0) each_overlapping(row - 1, row, visit);
      if (row >= size(1)) each_overlapping(row - size(1), row, visit);
      each_touching_around(row, visit);
    }
  }
  /// Across the end of a periodic volume.
  template <class Visit>
  void each_touching_around(int64_t row, Visit visit) const {
    const int64_t from_y = size(1) - 1, from_z = int64_t(size(1)) * (size(2) - 1);
    if (volume_.is_periodic[0]) visit(first_[size_t(row)], first_[size_t(row) + 1] - 1);
    if (volume_.is_periodic[1] && row % size(1) == from_y) each_overlapping(row - from_y, row, visit);
    if (volume_.is_periodic[2] && row >= from_z) each_overlapping(row - from_z, row, visit);
  }
  template <class Visit>
  void each_overlapping(int64_t row, int64_t other, Visit visit) const {
    size_t a = first_[size_t(row)], b = first_[size_t(other)];
    while (a < first_[size_t(row) + 1] && b < first_[size_t(other) + 1]) {
      visit(a, b);
      const bool a_ends = runs_[a].end <= runs_[b].end, b_ends = runs_[b].end <= runs_[a].end;
      a += a_ends;
      b += b_ends;
    }
  }

  /// Faces of a run at the sides of the array.
  int64_t faces_outside(size_t r) const {
    const int64_t row = row_of(r), y = row % size(1), z = row / size(1), length = runs_[r].end - runs_[r].begin;
    const auto& is_periodic = volume_.is_periodic;
    return (is_periodic[0] ? 0 : (runs_[r].begin == 0) + (runs_[r].end == size(0))) +
           (is_periodic[1] ? 0 : length * ((y == 0) + (y + 1 == size(1)))) +
           (is_periodic[2] ? 0 : length * ((z == 0) + (z + 1 == size(2))));
  }

  size_t root(size_t r) {
    while (parent_[r] != r) r = parent_[r] = parent_[parent_[r]];
    return r;
  }
  void join(size_t a, size_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  void measure() {
    std::vector<int64_t> voxels(runs_.size(), 0);
    std::vector<char> is_outside(runs_.size(), 0);
    for (size_t row = 0; row + 1 < first_.size(); ++row)
      for (size_t r = first_[row]; r < first_[row + 1]; ++r) {
        voxels[root(r)] += runs_[r].end - runs_[r].begin;
        if (runs_[r].label == volume_.background && faces_outside(r) > 0) is_outside[root(r)] = 1;
      }
    std::unordered_map<int32_t, size_t> largest;
    for (size_t r = 0; r < runs_.size(); ++r) {
      if (parent_[r] != r || runs_[r].label == volume_.background) continue;
      const auto [at, is_first] = largest.try_emplace(runs_[r].label, r);
      if (!is_first && voxels[r] > voxels[at->second]) at->second = r;
    }
    is_small_.assign(runs_.size(), 0);
    for (size_t r = 0; r < runs_.size(); ++r)
      is_small_[r] = parent_[r] == r && voxels[r] < volume_.smallest_island_vox && !is_outside[r];
    for (const auto& [label, island] : largest) is_small_[island] = 0;
  }

  const LabelVolume& volume_;
  const Context& context_;
  std::vector<Run> runs_;
  std::vector<size_t> first_;   ///< per row, and one more: offsets into runs
  std::vector<size_t> parent_;  ///< per run an earlier one of its island
  std::vector<char> is_small_;  ///< of the first run of each island
};

/// Pairs of labels that share faces, the background around the array left out.
std::set<std::array<int32_t, 2>> pairs_of(const LabelVolume& volume) {
  std::set<std::array<int32_t, 2>> pairs;
  std::array<int32_t, 2> last{0, 0};
  const auto add = [&](int32_t a, int32_t b) {
    if (a == b || (a == last[0] && b == last[1])) return;
    last = {a, b};
    if (a != volume.background && b != volume.background) pairs.insert({std::min(a, b), std::max(a, b)});
  };
  const int64_t nx = volume.size_vox[0], slab = nx * volume.size_vox[1], all = slab * volume.size_vox[2];
  const std::vector<int32_t>& label = volume.labels;
  for (int64_t i = 0; i < all; ++i) {
    if (i % nx + 1 < nx) add(label[size_t(i)], label[size_t(i + 1)]);
    if (i % slab + nx < slab) add(label[size_t(i)], label[size_t(i + nx)]);
    if (i + slab < all) add(label[size_t(i)], label[size_t(i + slab)]);
  }
  return pairs;
}

}  // namespace

AbsorbedIslands absorb_islands(LabelVolume& volume, const Context& context) {
  AbsorbedIslands absorbed;
  if (volume.smallest_island_vox <= 1) return absorbed;
  std::set<std::array<int32_t, 2>> before;
  for (int round = 0; round < kMostRounds; ++round) {
    Islands islands(volume, context);
    const std::unordered_map<size_t, int32_t> becomes = islands.labels_around();
    if (becomes.empty()) break;
    if (round == 0) before = pairs_of(volume);
    absorbed.islands += int64_t(becomes.size());
    islands.each_small([&](size_t r, size_t island) {
      const auto label = becomes.find(island);
      if (label == becomes.end()) return;
      const Run& run = islands.run(r);
      const auto row = volume.labels.begin() + islands.row_of(r) * volume.size_vox[0];
      std::fill(row + run.begin, row + run.end, label->second);
      absorbed.voxels += run.end - run.begin;
    });
  }
  if (absorbed.islands == 0) return absorbed;
  const std::set<std::array<int32_t, 2>> after = pairs_of(volume);
  std::set_difference(before.begin(), before.end(), after.begin(), after.end(),
                      std::back_inserter(absorbed.lost_pairs));
  return absorbed;
}

}  // namespace isoshell
