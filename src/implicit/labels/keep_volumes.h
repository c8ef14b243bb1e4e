// Walls that were moved are offset so that regions have the volumes of their voxels again.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/world_vector.h"
#include "implicit/labels/label_walls.h"
#include "isoshell/advanced/lattice_surface.h"

namespace isoshell {

/// Every pair of regions has one offset for all of its walls, along their normals, that gives every region the volume
/// that it has with walls at rest (see pressures_of_regions). Vertices on curves go by the mean of the walls there,
/// weighted by area. Volumes and areas are sums of integers and the equation is solved in a fixed order: no number of
/// threads shows.
class VolumeKeeper {
 public:
  /// Both must outlive it. Cost: O(walls), and a sort of the pairs of regions.
  VolumeKeeper(const LabelWalls& walls, const Buckets<uint32_t>& faces_at);

  /// Finds the offsets for walls with vertices here. Result: the largest one, in 1/256 voxel. Cost: O(walls), and
  /// that of pressures_of_regions.
  double find_offsets(const std::vector<PointQ8>& position);
  /// How far a vertex goes by the offsets that were found, in voxels.
  WorldPoint way_of(size_t vertex, const std::vector<PointQ8>& position) const;

 private:
  struct Pair {
    std::array<uint32_t, 2> region;  ///< by their numbers: that inside, and that outside
    uint64_t rest = 0, now = 0;      ///< six times what walls and the origin span, in 1/256 voxel, modulo 2^64
    int64_t doubled_area = 0;
    double offset_q8 = 0;
  };

  void number_pairs();
  template <class Add>
  void add_by_pair(const Add& add);
  std::vector<double> lacking_volumes() const;

  const LabelWalls& walls_;
  const Buckets<uint32_t>& faces_at_;
  std::vector<Pair> pairs_;
  std::vector<uint32_t> pair_of_face_;
  size_t regions_ = 0;  ///< with the background, which is as any other
};

}  // namespace isoshell
