// What a program may have in memory beside triangles and points: polygons, and values on a regular lattice.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "isoshell/backend.h"
#include "isoshell/io/input.h"

namespace isoshell {

/// Faces of any number of corners.
struct PolygonSoup {
  std::vector<WorldPoint> vertices;
  std::vector<uint32_t> corners;  ///< of one face after the other
  std::vector<uint32_t> sizes;    ///< per face its number of corners
};

/// The triangles that readers of mesh files make of the same faces. Throws: unreadable_input for a corner that is no
/// vertex and for sizes that do not sum up to the corners, nothing_to_mesh without a usable face; `name` is what the
/// message calls the surface.
TriangleSoup split_polygons(PolygonSoup polygons, const std::string& name);

/// Value (i, j, k) stands at origin + i step[0] + j step[1] + k step[2]: steps may turn, skew and mirror the array.
/// Borrows the values.
struct DenseVolume {
  const float* values = nullptr;
  int64_t size[3] = {};    ///< values along each axis
  int64_t stride[3] = {};  ///< values from one to the next along each axis
  std::array<WorldPoint, 3> step_world{WorldPoint{1, 0, 0}, WorldPoint{0, 1, 0}, WorldPoint{0, 0, 1}};
  WorldPoint origin_world{0, 0, 0};
};

/// The surface of a volume as read_volume extracts it, from values that no file gives a class. Without an isovalue they
/// are signed distances where some are negative, and otherwise unsigned ones if they rise as such. The space beyond
/// the array is outside. With an isovalue, the side of it that most values at the array's faces lie on is outside, too,
/// or of a mask the lower one; without one the positive side. Where the body reaches a face, it ends as options.sides
/// says. Values that are NaN are not known: beside them the surface is open. Throws: usage for an array without values
/// or with steps that span no volume, and for a periodic one whose steps are not along the axes of the world;
/// unreadable_input for an infinite value; nothing_to_mesh where none is a number; and as read_volume does.
TriangleSoup surface_of_volume(const DenseVolume& volume, const std::string& name, const VolumeReadOptions& options,
                               VolumeInfo& info);

/// The values for InputRequest::given_grids, under a name: a grid of floats, or of whole numbers, which are not
/// interpolated. Places beyond the array, and where values are NaN, have 0. A copy of them. Cost: linear in the values,
/// on one thread; 2 KiB for each block of 8^3 that has a value. Throws: usage for steps that span no volume, an
/// infinite value, and where numbers are said to be whole one that is not, or is beyond 2^24; out_of_memory where the
/// blocks of the whole array would take more than the limit in bytes (0: none); unreadable_input in a build without
/// OpenVDB.
std::shared_ptr<const GridField> grid_field(const DenseVolume& volume, const std::string& name, bool is_whole = false,
                                            int64_t memory_limit_bytes = 0);

/// The walls between voxels of different labels, faired within the voxels: every region is bounded by closed triangles,
/// which it shares with those beside it (see implicit/labels). `surface.regions` says what they part. Result: the same
/// for any number of threads. Islands of fewer than volume.smallest_island_vox voxels are absorbed first, which is
/// told. The context's threads and limit hold, and its progress is that of "read". Throws: usage for an array without
/// voxels, a number of labels that is not theirs, or steps that span no volume; nothing_to_mesh where all voxels have
/// one label; out_of_memory over the limit, before walls are made; interrupted.
TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, const Context& context,
                               const Tell& tell = {});
/// The same with all threads there are.
TriangleSoup surface_of_labels(LabelVolume volume, const std::string& name, int64_t memory_limit_bytes,
                               const Tell& tell = {});

/// The same as an input. Throws: as surface_of_labels does.
Input input_of(LabelVolume volume, const std::string& name, const Context& context, const Tell& tell = {});

/// The same as an input. Throws: as surface_of_volume does.
Input input_of(const DenseVolume& volume, const std::string& name, const VolumeReadOptions& options,
               const Tell& tell = {});

}  // namespace isoshell
