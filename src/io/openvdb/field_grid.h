// Grids of .vdb files that are sampled anywhere: the edge lengths of a sizing field, velocities.
#pragma once

#include <openvdb/openvdb.h>

#include <string>
#include <vector>

#include "core/parallel_ranges.h"
#include "isoshell/advanced/lattice.h"

namespace isoshell {

/// What a kind of field is made of, and how messages speak of it.
struct FieldKind {
  const char* tree_type;      ///< as a file names it, such as Tree_float_5_4_3
  const char* type_in_words;  ///< such as "floats"
  const char* what_it_is;     ///< such as "a sizing field is a FloatGrid of edge lengths"
  const char* name;           ///< what to coarsen when it is too large, such as "the field"
};

/// Reads a grid of the type that `kind` asks for, by its name, or the only one when the name is empty. Throws:
/// unreadable_input, which lists the grids there are; out_of_memory for a file larger than `max_bytes` (0: no limit).
openvdb::GridBase::ConstPtr read_field_grid(const std::string& path, const std::string& name, const FieldKind& kind,
                                            int64_t max_bytes);

/// Calls use(weight, whether the voxel is active, its value) for the eight voxels around a point in world units. The
/// weights are those of trilinear interpolation.
template <class Grid, class Reader, class Use>
void for_each_voxel_around(const Grid& grid, Reader& reader, const openvdb::Vec3d& world, Use use) {
  const openvdb::Vec3d at = grid.worldToIndex(world);
  const openvdb::Coord low = openvdb::Coord::floor(at);
  for (int corner = 0; corner < 8; ++corner) {
    const openvdb::Coord c = low.offsetBy(corner >> 2, corner >> 1 & 1, corner & 1);
    double weight = 1;
    for (int axis = 0; axis < 3; ++axis) {
      const double t = at[axis] - low[axis];
      weight *= c[axis] > low[axis] ? t : 1 - t;
    }
    typename Grid::ValueType value;
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
