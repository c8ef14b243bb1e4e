// Which triangles meet which leaf: the work list of every step that goes from triangles to voxels. Two levels, so that
// no step is longer than one block, however large a triangle is.
#pragma once

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/atomic.h"
#include "voxel/leaf.h"
#include "voxel/overlap.h"

namespace isoshell {

/// What a kernel sees of a surface.
struct SurfaceView {
  View<const PointQ8> points;
  View<const TriangleIndices> triangles;

  ISOSHELL_HD TriangleQ8 triangle(int64_t t) const {
    const TriangleIndices i = triangles[t];
    return triangle_q8(points[i.a], points[i.b], points[i.c]);
  }
};
inline SurfaceView view_of(const LatticeSurface& surface) { return {surface.points.view(), surface.triangles.view()}; }

/// Blocks of the dense table, x-major.
struct BlockGrid {
  int32_t dims[3];

  ISOSHELL_HD CellRange range() const { return {{0, 0, 0}, {dims[0] - 1, dims[1] - 1, dims[2] - 1}}; }
  ISOSHELL_HD uint32_t number(Voxel b) const { return (uint32_t(b.x) * dims[1] + b.y) * dims[2] + b.z; }
  ISOSHELL_HD Voxel block(uint32_t n) const {
    return {int32_t(n / (dims[1] * dims[2])), int32_t(n / dims[2] % dims[1]), int32_t(n % dims[2])};
  }
};
constexpr int kMaxBlocksPerAxis = (kMaxResolution + 2 * kMarginVox) / 128 + 2;

/// A triangle in one of the blocks it meets.
struct Tile {
  uint32_t triangle, block;
};

struct TilesOf {
  SurfaceView surface;
  BlockGrid grid;
  ISOSHELL_HD int64_t operator()(int64_t t) const {
    int64_t blocks = 0;
    for_each_run<kMaxBlocksPerAxis>(surface.triangle(t), grid.range(), kBlockShift,
                                    [&](int, Voxel, int32_t run) { blocks += run; });
    return blocks;
  }
};

struct FillTiles {
  SurfaceView surface;
  BlockGrid grid;
  View<const int64_t> first;
  View<Tile> tiles;
  ISOSHELL_HD void operator()(int64_t t) const {
    int64_t at = first[t];
    for_each_cell<kMaxBlocksPerAxis>(surface.triangle(t), grid.range(), kBlockShift, [&](Voxel block) {
      tiles[at++] = {uint32_t(t), grid.number(block)};
    });
  }
};

/// Every triangle with every block it meets, by triangle.
template <class Exec>
Buffer<Tile> find_tiles(Exec& exec, const LatticeSurface& surface, const BlockGrid& grid) {
  const int64_t triangles = surface.triangles.size();
  Buffer<int64_t> first = exec.template make<int64_t>(triangles);
  Buffer<Tile> tiles =
      exec.template make<Tile>(exec.exclusive_scan_of(triangles, TilesOf{view_of(surface), grid}, first.view()));
  exec.for_each("fill tiles", triangles, FillTiles{view_of(surface), grid, first.view(), tiles.view()});
  return tiles;
}

/// For every leaf, the triangles that meet it.
struct LeafTriangles {
  Buffer<int64_t> first;  ///< leaf_count + 1 offsets
  Buffer<uint32_t> triangle;
};

struct CountLeafTriangles {
  SurfaceView surface;
  BlockGrid grid;
  View<const Tile> tiles;
  VoxelSetView leaves;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    for_each_cell<16>(surface.triangle(tiles[i].triangle), leaves_of_block(grid.block(tiles[i].block)), kLeafShift,
                      [&](Voxel leaf) {
                        const uint32_t l = find_leaf(leaves, leaf);
                        if (l != kNone) atomic_add(count[l], int64_t(1));
                      });
  }
};

/// Moves each cursor from the start of its list to its end.
struct FillLeafTriangles {
  SurfaceView surface;
  BlockGrid grid;
  View<const Tile> tiles;
  VoxelSetView leaves;
  View<int64_t> cursor;
  View<uint32_t> triangle;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t t = tiles[i].triangle;
    for_each_cell<16>(surface.triangle(t), leaves_of_block(grid.block(tiles[i].block)), kLeafShift, [&](Voxel leaf) {
      const uint32_t l = find_leaf(leaves, leaf);
      if (l != kNone) triangle[atomic_fetch_add(cursor[l], int64_t(1))] = t;
    });
  }
};

/// The lists' order depends on the schedule: take it as a set, or sort it.
template <class Exec>
LeafTriangles find_leaf_triangles(Exec& exec, const LatticeSurface& surface, const BlockGrid& grid,
                                  View<const Tile> tiles, const VoxelSetView& leaves) {
  const int64_t count = leaves.leaf_key.size;
  LeafTriangles lists;
  lists.first = exec.template make<int64_t>(count + 1);
  exec.fill(lists.first.view(), int64_t(0));
  exec.for_each("count leaf triangles", tiles.size,
                CountLeafTriangles{view_of(surface), grid, tiles, leaves, lists.first.view()});
  lists.triangle = exec.template make<uint32_t>(exec.exclusive_scan(lists.first.view()));
  Buffer<int64_t> cursor = exec.template make<int64_t>(count);
  exec.copy(View<const int64_t>(lists.first.view().part(0, count)), cursor.view());
  exec.for_each("fill leaf triangles", tiles.size,
                FillLeafTriangles{view_of(surface), grid, tiles, leaves, cursor.view(), lists.triangle.view()});
  return lists;
}

}  // namespace isoshell
