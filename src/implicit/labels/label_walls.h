// The faces between voxels of different labels, as a mesh.
#pragma once

#include <array>
#include <vector>

#include "core/buckets.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/backend.h"
#include "isoshell/regions.h"

namespace isoshell {

/// Walls with vertices at corners of voxels. Corner (x, y, z) is the one of voxel (x, y, z) nearest to the origin.
struct LabelWalls {
  Voxel low_quarters{0, 0, 0}, high_quarters{0, 0, 0};  ///< where the volume ends, in quarters of voxels
  std::vector<uint8_t> is_thin;      ///< per vertex: a voxel beside it is all there is between two walls along an axis
  std::vector<Voxel> rest_quarters;  ///< per vertex where it lies on the lattice
  std::vector<std::array<uint32_t, 4>> faces;  ///< four corners in turn, as seen from the second region; of triangles
                                               ///< the last one is kNone
  std::vector<std::array<int32_t, 2>> labels;  ///< per face, as in FaceRegions
  std::vector<int64_t> crossed = {};  ///< per face, of a volume with crossings: WallCrossing::face, which it stands for
  /// Of a periodic volume the vertices that are one in space, at opposite sides; ascending, as each of them is.
  std::vector<std::vector<uint32_t>> tied = {};

  /// The corners of the faces of voxels.
  std::vector<PointQ8> at_rest() const;
  /// On which side of the volume a face lies, 1 to 6, or 0: as FaceRegions has it.
  uint8_t side_of(size_t face) const;
};

/// Every sheet of walls at a corner of the lattice has a vertex of its own there, and where the walls along a lattice
/// edge are parted each pair has one in its middle: so every two vertices have at most one edge, which has two faces,
/// or three or four that part as many different regions. A region's boundary has two faces at each of its edges, and
/// touches itself in vertices only. Along periodic axes, whose last layer repeats the first one, the volume ends at the
/// centres of these. Result: by layers of voxels along z, whatever the number of threads. Cost: a look
/// at every voxel, and O(walls). Throws: interrupted; out_of_memory where vertices cannot be numbered in 32 bits.
LabelWalls find_label_walls(const LabelVolume& volume, const Context& context);

}  // namespace isoshell
