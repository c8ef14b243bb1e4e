// Vertices on the creases of a field's surface, where marching cubes would cut them off.
#pragma once

#include <vector>

#include "implicit/volumes/crease_planes.h"

namespace isoshell {

/// A vertex in the middle of one of a cell's patches, on its crease or corner.
struct CreaseVertex {
  enum Place : uint8_t { best, in_cell, none };

  uint16_t offset;       ///< of the cell in its block
  uint8_t loop;          ///< of the cell's case
  uint8_t inside;        ///< the cell's case
  Place place = best;    ///< none: it was given up
  WorldPoint choice[2];  ///< on the crease, and the nearest point of the cell; from the block's origin
  WorldPoint along;      ///< the crease, of length 1; 0 at a corner
  const WorldPoint& at() const { return choice[place]; }
};

/// A crease vertex by its block and its number in it.
struct CreaseVertexId {
  static constexpr uint32_t kNoBlock = 0xffffffffu;
  uint32_t block = kNoBlock, number = 0;
  explicit operator bool() const { return block != kNoBlock; }
};

/// The creases of a distance field: crossings beside them, vertices on them, and which of these become edges.
///
/// Crossings near bent cells get the planes of straight cells nearby (crease_planes.h). Where these turn by 20 degrees
/// or more within a cell's patch, it gets a vertex where they meet. Vertices
/// whose triangles would turn over go into their cell, and away if that does not help; so do those of creases that are
/// shorter than a few cells.
class Creases {
 public:
  /// Blocks of cells, sorted. `rise`: the field's distance a voxel.
  Creases(const ScalarField& field, Inside inside, double rise, const std::vector<Voxel>& blocks);

  /// Of an edge that begins in the block; null where interpolation is right.
  const CreaseCrossing* crossing(size_t block, int axis, int offset) const;
  /// The vertex of a loop.
  CreaseVertexId vertex(size_t block, int offset, int loop) const;
  /// The vertex with which this one shares an edge, instead of the i-th and the next crossing of its loop.
  CreaseVertexId beyond(CreaseVertexId id, int i) const;
  const CreaseVertex& operator[](CreaseVertexId id) const { return vertices_[id.block][id.number]; }
  const std::vector<CreaseVertex>& vertices(size_t block) const { return vertices_[block]; }

  /// Moves vertices to their next place, and others that then turn triangles over. Returns the cells of all these.
  std::vector<Voxel> take_back(const std::vector<CreaseVertexId>& which);

 private:
  struct LocalCrossing {
    const CreaseCrossing* crossing;
    WorldPoint at;  // from the asking block's origin
    double height;
  };
  LocalCrossing local_crossing(size_t block, int offset, int edge) const;
  size_t block_at(Voxel origin) const;
  std::vector<CreaseVertex> find_vertices(const ScalarField& field, Inside inside, size_t block) const;
  bool is_near_crease(size_t block) const;
  bool place_vertex(size_t block, CreaseVertex& vertex) const;
  bool turns_over(CreaseVertexId id) const;
  WorldPoint evened(CreaseVertexId id) const;
  void even_out();
  std::vector<Voxel> undo_inversions();
  Voxel take_back(CreaseVertexId id);
  void keep_nearer(std::vector<std::vector<uint32_t>>& turned) const;
  bool is_farthest(CreaseVertexId id, const std::vector<std::vector<uint32_t>>& turned) const;
  void drop_short();
  void forget_given_up();
  template <class Visit>
  void each_vertex(Visit visit) const;

  const std::vector<Voxel>& blocks_;
  std::vector<std::vector<CreaseCrossing>> crossings_;  // per block, ascending
  std::vector<std::vector<CreaseVertex>> vertices_;     // per block, by offset and loop
};

}  // namespace isoshell
