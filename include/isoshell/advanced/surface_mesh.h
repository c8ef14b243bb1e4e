// The surface that seeds move on: a triangle mesh in fixed point, cut into blocks of vertices, closed or with borders.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// What a step sees of VertexBlocks.
struct VertexBlocksView {
  View<const int64_t> first;
  View<const PointQ8> centre;
};

/// Runs of consecutive vertices that are near to one another: the unit of work of labels, of the sums of cells and of
/// the limit of edge lengths. A triangle belongs to the block of its smallest vertex. What holds of every block:
/// - It has 1 to kMostVertices vertices, and every vertex is in one block.
/// - Of its vertices, and of the corners of their triangles, no coordinate is kReachQ8 or more from the centre's: so
///   the moments of a block's triangles fit 64 bits (voxel/cell_sum.h).
/// No result depends on how vertices are cut into blocks. Time does: those of a sheet have about 65 vertices, within
/// eight voxels; blocks that are larger see more seeds that are not theirs, smaller ones see the same seeds again.
struct VertexBlocks {
  static constexpr int kMostVertices = 512;
  static constexpr int32_t kReachQ8 = 1 << 13;

  Buffer<int64_t> first;   ///< count + 1 offsets: block b has vertices first[b] to first[b + 1] - 1
  Buffer<PointQ8> centre;  ///< origin of the block's own coordinates

  int64_t count() const { return centre.size(); }
  VertexBlocksView view() const { return {first.view(), centre.view()}; }
};

/// What the edges of a chain are.
enum class ChainKind : uint8_t {
  border,  ///< edges of one triangle, passed as that triangle passes them: seen from outside it is on the left
};

/// Paths along edges of the mesh, by kind, then by their smallest vertex, with which a loop begins.
struct Chains {
  Buffer<int64_t> first;    ///< count + 1 offsets into vertex; empty without chains
  Buffer<uint32_t> vertex;  ///< along each chain; the first one of a loop is not repeated at its end
  Buffer<ChainKind> kind;
  Buffer<uint8_t> is_loop;  ///< 1: an edge joins the last vertex to the first

  int64_t count() const { return kind.size(); }
};

/// Edge lengths to aim at, where they vary. Only ratios count: the number of seeds decides the rest.
struct EdgeLengths {
  Buffer<uint32_t> at;  ///< per vertex; empty: the same everywhere
  uint32_t least = 0, largest = 0;
};

/// An oriented 2-manifold of triangles: each edge has two triangles, which pass it in opposite directions, or one, and
/// the triangles around a vertex are one fan. What its stages need of the lattice is its extent.
///
/// A surface with creases is cut along them into patches, whose borders lie on one another: every patch has vertices of
/// its own there, with normals of its own. No triangle has vertices of two patches, and a seed that is in one patch
/// takes no part in another (FixedSeeds joins them).
struct SurfaceMesh {
  int32_t extent_vox[3] = {};  ///< positions are 0 to 256 times this
  Buffer<PointQ8> position;    ///< per vertex
  Buffer<Normal8> normal;      ///< outward, per vertex
  Buffer<TriangleIndices> triangles;
  Buffer<uint32_t> vertex_first;      ///< vertex_count + 1 offsets into vertex_triangles, which are below 2^32
  Buffer<uint32_t> vertex_triangles;  ///< ascending per vertex
  Buffer<uint32_t> border_before;     ///< per vertex the one before it on its border, kNone off borders; empty: closed
  VertexBlocks blocks;                ///< each of one patch
  Chains chains;                      ///< all borders are among them
  Buffer<uint32_t> patch;             ///< per vertex from 0 on, where the mesh is cut into patches; empty: one patch
  EdgeLengths lengths;                ///< empty as built; see limit_edge_lengths
  Buffer<PointQ8> missed;             ///< points of a closed surface that are 1/2 to 4 voxels off the mesh
  Buffer<uint32_t> missed_vertex;     ///< the vertex nearest to each

  int64_t vertex_count() const { return position.size(); }
  /// Without a border.
  bool is_closed() const { return border_before.empty(); }
};

}  // namespace isoshell
