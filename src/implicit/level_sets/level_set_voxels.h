// What several level sets of one lattice say together of any voxel: which is nearest, and where walls between them run.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <unordered_map>
#include <vector>

#include "implicit/level_sets/distance_blocks.h"
#include "isoshell/regions.h"

namespace isoshell {

/// What a voxel is nearest to.
struct Standing {
  size_t first = 0, second = 0;  ///< numbers of level sets, by their values
  double first_value = INFINITY, second_value = INFINITY;
  double united = INFINITY;  ///< of all with their gaps closed: below 0 in any region

  /// The number of a level set and 1, or 0.
  int32_t label() const { return united < 0 ? int32_t(first) + 1 : 0; }
};

/// Values are those of the sets, in voxels, as far as the narrowest of their bands reaches: where bands differ a wider
/// one says more, which is not to be compared with what lies beyond a narrower one.
class LevelSetVoxels {
 public:
  /// Keeps both. Throws: out_of_memory where the box of all that is inside has more than twice kMaxResolution voxels
  /// along an axis, naming the file. Cost: linear in the blocks.
  LevelSetVoxels(const std::vector<DistanceBlocks>& sets, const std::vector<std::string>& names,
                 const std::string& file);

  /// Whether nothing is inside.
  bool empty() const { return size_.x == 0; }
  Voxel low() const { return low_; }
  Voxel size() const { return size_; }
  int64_t voxels() const { return int64_t(size_.x) * size_.y * size_.z; }
  const DistanceBlocks& set(size_t number) const { return sets_[number]; }

  /// Those that hold anything in the block around a voxel, ascending.
  const std::vector<uint32_t>& sets_around(Voxel v) const;
  Standing standing_at(Voxel v, const std::vector<uint32_t>& sets_around) const;
  Standing standing_at(Voxel v) const { return standing_at(v, sets_around(v)); }
  /// The united value, but beside a gap that is closed, or two that touch, how deep it is below the surface around
  /// both: the values of either say how far their walls are, which are none of the union.
  double depth_at(Voxel v, const Standing& standing) const;
  /// Whether it is so deep in two that both have the value beyond the narrowest band, which places no wall.
  bool is_undecided(const Standing& standing) const;
  /// Of the wall between two voxels with these labels, one step along an axis from one another.
  WallCrossing crossing(Voxel near, Voxel far, int32_t near_label, int32_t far_label) const;

 private:
  struct BlockHash {
    size_t operator()(const Voxel& b) const {
      return (size_t(uint32_t(b.x)) * 73856093U) ^ (size_t(uint32_t(b.y)) * 19349663U << 11) ^
             (size_t(uint32_t(b.z)) * 83492791U << 22);
    }
  };

  void find_box(const std::vector<std::string>& names, const std::string& file);
  void list_sets();
  double value(size_t set, Voxel v) const {
    return std::clamp(double(sets_[set].at(v)), -narrowest_band_, narrowest_band_);
  }
  double united_at(Voxel v, const Standing& standing) const;
  /// How much less the first label's value is than the second one's.
  double difference(Voxel v, int32_t label, int32_t other) const;
  WorldPoint slope_of(Voxel v, int32_t label) const {
    return label == 0 ? WorldPoint{0, 0, 0} : sets_[size_t(label) - 1].slope(v);
  }

  const std::vector<DistanceBlocks>& sets_;
  Voxel low_{0, 0, 0}, size_{0, 0, 0};
  double narrowest_band_ = INFINITY;                                     ///< voxels; of those that have an inside
  std::unordered_map<Voxel, std::vector<uint32_t>, BlockHash> sets_in_;  ///< by the coordinates of a block over 8
};

}  // namespace isoshell
