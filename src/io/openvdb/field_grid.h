// Grids of .vdb files that are sampled anywhere: the edge lengths of a sizing field, velocities, values of vertices.
#pragma once

#include <openvdb/openvdb.h>

#include <algorithm>
#include <string>
#include <vector>

#include "core/parallel_ranges.h"
#include "io/bytes/mesh_source.h"
#include "io/vdb/vdb_layout.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// What a kind of field is made of, and how messages speak of it.
struct FieldKind {
  const char* tree_type;      ///< as a file names it, such as Tree_float_5_4_3
  const char* type_in_words;  ///< such as "floats"
  const char* what_it_is;     ///< such as "a sizing field is a FloatGrid of edge lengths"
  const char* name;           ///< what to coarsen when it is too large, such as "the field"
};

/// Whether the grid has values of its own in such a tree, in a file perhaps as halves.
bool is_of_tree(const VdbGridSpan& grid, const std::string& tree_type);

/// What messages say that a file holds.
std::string list_of(const std::vector<VdbGridSpan>& grids);

/// Reads one of the grids of a file, once its memory is counted. Throws: unreadable_input; out_of_memory.
openvdb::GridBase::Ptr read_counted_grid(const MeshSource& source, const VdbGridSpan& grid);

/// Reads a grid of the type that `kind` asks for, by its name, or the only one when the name is empty. Throws:
/// unreadable_input, which lists the grids there are; out_of_memory for a file larger than `max_bytes` (0: no limit).
openvdb::GridBase::ConstPtr read_field_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                                            int64_t max_bytes);

/// A place in voxels, moved to where indices end if it is beyond: there is nothing either.
inline openvdb::Vec3d within_indices(openvdb::Vec3d at) {
  constexpr double kFarthest = 1 << 30;
  for (int axis = 0; axis < 3; ++axis) at[axis] = std::max(-kFarthest, std::min(kFarthest, at[axis]));
  return at;
}

/// Calls use(weight, whether the voxel is active, its value) for the eight voxels around a place, which is in voxels.
/// The weights are those of trilinear interpolation.
template <class Reader, class Use>
void for_each_voxel_around(Reader& reader, const openvdb::Vec3d& place, Use use) {
  const openvdb::Vec3d at = within_indices(place);
  const openvdb::Coord low = openvdb::Coord::floor(at);
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Coord c = low.offsetBy(corner >> 2, corner >> 1 & 1, corner & 1);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double t = at[axis] - low[axis];
      weight *= c[axis] > low[axis] ? t : 1 - t;
    }
    typename Reader::ValueType value;
    const bool is_active = reader.probeValue(c, value);
    use(weight, is_active, value);
  }
}

/// at(reader, point) for every point, in parallel, each thread with a reader of its own.
template <class Value, class Grid, class At>
std::vector<Value> sample_field(const Grid& grid, const std::vector<WorldPoint>& points, At at) {
  std::vector<Value> out(points.size());
  for_ranges(int64_t(points.size()), 1024, [&](int64_t begin, int64_t end) {
    auto reader = grid.getConstAccessor();
    for (size_t i = size_t(begin); i < size_t(end); ++i) out[i] = at(reader, points[i]);
  });
  return out;
}

}  // namespace isoshell
