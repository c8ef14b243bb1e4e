// Grows a copy of a solid that has no more handles than wanted: region growing by simple points, deepest first
// (Bertrand and Malandain, "A new characterization of three-dimensional simple points", 1994). What it leaves out are
// the cuts.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <vector>

#include "core/zeroed_memory.h"
#include "cpu/sheet/bit_plane.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// Parts in which a voxel's neighbours touch it; solid voxels join through corners, empty ones through faces.
struct VoxelContacts {
  int solid;  ///< of the solid voxels among the 26 neighbours
  int empty;  ///< of the empty ones among the 18 that share an edge; only parts that show a face
};
/// Bit 9 (x + 1) + 3 (y + 1) + z + 1 of `solid` is the neighbour at (x, y, z).
VoxelContacts contacts_of(uint32_t solid);

/// Whether adding the voxel leaves the number of components, handles and cavities as it is.
inline bool is_simple(uint32_t solid) {
  const VoxelContacts c = contacts_of(solid);
  return c.solid == 1 && c.empty == 1;
}

/// A box of voxels whose outermost layer stays empty, less than 2^32. A byte and three bits a voxel, and up to eight
/// bytes for each that waits.
class HandleCutter {
 public:
  static constexpr int kRanks = 256;

  explicit HandleCutter(const int32_t extent_vox[3]);

  int64_t index_of(Voxel v) const { return (int64_t(v.x) * extent_[1] + v.y) * extent_[2] + v.z; }
  Voxel voxel_of(int64_t index) const {
    const int64_t row = index / extent_[2];
    return {int32_t(row / extent_[1]), int32_t(row % extent_[1]), int32_t(index % extent_[2])};
  }

  /// Makes a voxel solid. Growing takes the lowest rank it can reach.
  void add(int64_t voxel, int rank);
  bool is_solid(int64_t voxel) const { return solid_[voxel]; }

  /// Grows every component from its lowest rank, then closes the cuts that reach the lowest ranks, one a handle.
  /// Result: what a queue a rank gives, first in, first out. `check` is called now and then and may throw.
  void grow(int64_t handles, const std::function<void()>& check);

  /// Closes all cuts that reach a rank below this.
  void close_cuts_below(int rank);

  bool is_grown(int64_t voxel) const { return grown_[voxel]; }
  /// Solid voxels that were left out, ascending.
  std::vector<int64_t> cuts() const;

 private:
  struct Queue {
    std::vector<uint32_t> voxels;
    size_t first = 0;  ///< those before it have left
    void drop_left() {
      voxels.erase(voxels.begin(), voxels.begin() + std::ptrdiff_t(first));
      first = 0;
    }
  };

  static constexpr size_t kMostLeft = 1 << 12;

  int rank_of(int64_t voxel) const { return rank_[size_t(voxel)]; }
  /// The 27 voxels of `plane` around one and itself, as contacts_of() has them.
  uint32_t around(const BitPlane& plane, int64_t voxel) const;
  /// Takes out of `left_` what is left around a voxel and calls visit(index), ascending.
  template <class Visit>
  void take_around(int64_t voxel, Visit visit);
  /// The middle of three voxels along z: nine rows around a voxel, 3 (x + 1) + y + 1.
  int64_t row(int64_t voxel, int number) const { return voxel + row_[number]; }
  bool may_grow(int64_t voxel);
  void expect(int64_t voxel) const;
  int64_t visit_component(int64_t start);
  void grow_from(int64_t start, const std::function<void()>& check);
  void add_grown(int64_t voxel);
  struct Cut {
    int rank;  ///< the lowest in it
    std::vector<int64_t> voxels;
  };
  std::vector<Cut> list_cuts();
  void close(const Cut& cut);

  int64_t extent_[3];
  int64_t row_[9];  ///< steps to the rows around
  BitPlane solid_, grown_;
  BitPlane left_;  ///< solid voxels that are neither grown nor waiting; in between, those that are left to be looked at
  ZeroedVector<uint8_t> rank_;
  std::vector<Queue> waiting_;   ///< per rank
  std::vector<uint32_t> known_;  ///< neighbourhoods met lately, times two, plus one where the voxel is simple
  int lowest_waiting_ = 0;
};

}  // namespace isoshell
