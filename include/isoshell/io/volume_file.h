// Volumes as input: level sets, unsigned distances and fog volumes of .vdb and .nvdb files become a closed surface.
#pragma once

#include <optional>
#include <string>

#include "isoshell/surface_source.h"

namespace isoshell {

/// Whose creases and corners get vertices of their own: of volumes whose values are distances in voxels that are cubes,
/// and of points.
enum class VolumeCreases {
  none,
  of_sharp_bodies,  ///< whose surface is straight but for narrow bends; others are as with `none`
  all,
};

/// Where the surface of an array's values ends that reaches the sides of the array.
enum class VolumeSides {
  sample,  ///< at the outermost values, with flat faces; of one value along an axis as `cell`
  cell,    ///< half a voxel farther out, with flat faces: values stand in the middle of voxels
  open,    ///< at the outermost values, with a border
};

struct VolumeReadOptions {
  /// Name of the grid, NAME[1] for the second one of that name, or NAME[2] where a grid is called NAME[1]: what a grid
  /// is called comes first. Empty takes the only level set, or the only grid that can be meshed.
  std::string grid;
  std::optional<double> iso;       ///< value of the surface; without it 0 in a level set and in unsigned distances, and
                                   ///< an error in a fog volume
  int64_t memory_limit_bytes = 0;  ///< refuse grids that would need more, before they are read; 0 means no limit
  VolumeCreases creases = VolumeCreases::none;
  VolumeSides sides = VolumeSides::sample;
  bool is_mask = false;  ///< of an array: what is above the isovalue is inside, also where that is most of it
  /// Without an isovalue: distances jump where a grid holds one side of an open surface alone, or was clipped, and the
  /// surface is open there.
  bool keep_open = false;
  /// Of an array with samples on its sides: along which axes it goes on with its first values. The surface is that of
  /// one period, which those values end again, and has the regions of one solid, whose opposite sides get the same
  /// triangles. It has no creases but at its sides.
  std::array<bool, 3> is_periodic{false, false, false};
};

/// What the values of a grid were taken for.
enum class VolumeKind {
  at_value,                ///< a level set, or any field whose value of the surface was given
  unsigned_distance,       ///< distances without sign from a closed surface, found between its two sides
  open_unsigned_distance,  ///< of a surface that encloses nothing: the closed crust around it, less than a voxel off
};

/// What was read, for messages and statistics.
struct VolumeInfo {
  std::string grid, grid_class;  ///< class as the file says it: "level set", "fog volume", "unknown"
  VolumeKind kind = VolumeKind::at_value;
  double iso = 0;
  double voxel_size_world = 0;  ///< longest edge of a voxel
  int64_t blocks = 0;           ///< of 8^3 voxels that hold values of their own
  int64_t unknown_values = 0;   ///< not numbers, or beyond the band of a level set
  int64_t open_cells = 0;       ///< in which the surface is open, beside these or where distances jump
  WorldPoint first_open_world{0, 0, 0};
  double jumping_part = 0;  ///< of the surface: where distances jump, as at the end of a band on one side of it alone
};

/// Reads one grid and extracts the surface on which its trilinear field has the value `iso`: closed, 2-manifold, with
/// vertices where lattice edges cross it, or on its creases where these are kept, oriented towards the side on which
/// the background lies. Beside values that are no numbers the surface is open, as it is where the band of a level set
/// ends whose background is 0: an inactive 0 in one is no value. Without `iso` a grid of class unknown,
/// or whose class says that it is unsigned, with no negative values that rise by one voxel's length a voxel holds
/// unsigned distances. They get the signs of the two sides of their zero set first, so that it is one skin, closed over
/// holes and with the hollows of nested surfaces. Every count and offset in the file is held to its bytes before
/// anything is allocated by it. Throws: unreadable_input for a damaged file, an unsigned distance that is not a number,
/// and frustum transforms; nothing_to_mesh for a grid without the surface or of a type that has none (points, booleans,
/// vectors), naming the grids there are; usage when the grid or its iso value must be named; out_of_memory over the
/// limit.
TriangleSoup read_volume(const std::string& path, const VolumeReadOptions& options, VolumeInfo& info);

}  // namespace isoshell
