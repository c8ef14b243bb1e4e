// Finds the vertex of a surface that is nearest to a point. Vertices lie together by blocks already: a grid of the
// blocks takes a small part of the memory that one of the vertices would.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "stages/sparse/point_grid_body.h"

namespace isoshell {

struct VertexGridView {
  PointGridView blocks;  ///< by the middles of their boxes
  View<const int64_t> first;
  View<const BoxQ8> box;          ///< per block, of its vertices
  View<const uint32_t> reach_q8;  ///< of one element: how far a box goes from its middle at most, on an axis
  View<const PointQ8> position;
};

/// Keeps the smallest (squared distance, id) of the vertices of the blocks it is shown.
struct NearestVertex {
  const VertexGridView& grid;
  PointQ8 from;
  int64_t distance_sq_q16 = int64_t(1) << 62;
  uint32_t id = kNone;

  /// For the middle of a block.
  ISOSHELL_HD int64_t bound_q16() const {
    if (id == kNone) return distance_sq_q16;
    const int64_t bound = int64_t(isqrt(uint64_t(distance_sq_q16))) + 1 + grid.reach_q8[0];
    return bound * bound;
  }
  ISOSHELL_HD void operator()(const GridPoint& block) {
    if (!may_be_in(block.id)) return;
    for (int64_t v = grid.first[block.id]; v < grid.first[block.id + 1]; ++v) consider(uint32_t(v));
  }
  ISOSHELL_HD bool may_be_in(uint32_t block) const {
    const BoxQ8 box = grid.box[block];
    const Vec64 off = {beside(box.lo.x, box.hi.x, from.x), beside(box.lo.y, box.hi.y, from.y),
                       beside(box.lo.z, box.hi.z, from.z)};
    return dot(off, off) <= distance_sq_q16;
  }
  ISOSHELL_HD void consider(uint32_t v) {
    const int64_t d = isoshell::distance_sq_q16(from, grid.position[v]);
    if (d > distance_sq_q16 || (d == distance_sq_q16 && v > id)) return;
    distance_sq_q16 = d;
    id = v;
  }

 private:
  /// How far x is from the interval.
  ISOSHELL_HD static int64_t beside(int32_t lo, int32_t hi, int32_t x) {
    return x < lo ? int64_t(lo) - x : x > hi ? int64_t(x) - hi : 0;
  }
};

/// The vertex with the smallest (squared distance, id), exact; kNone of an empty surface.
ISOSHELL_HD inline NearestVertex nearest_vertex(const VertexGridView& grid, PointQ8 from) {
  NearestVertex nearest{grid, from};
  visit_around(grid.blocks, BoxQ8{from, from}, nearest);
  return nearest;
}

struct BoxBlock {
  View<const int64_t> first;
  View<const PointQ8> position;
  View<BoxQ8> box;
  View<PointQ8> middle;
  View<uint32_t> reach_q8;
  ISOSHELL_HD void operator()(int64_t block) const {
    BoxQ8 b{position[first[block]], position[first[block]]};
    for (int64_t v = first[block] + 1; v < first[block + 1]; ++v) {
      const PointQ8 p = position[v];
      b.lo = {p.x < b.lo.x ? p.x : b.lo.x, p.y < b.lo.y ? p.y : b.lo.y, p.z < b.lo.z ? p.z : b.lo.z};
      b.hi = {p.x > b.hi.x ? p.x : b.hi.x, p.y > b.hi.y ? p.y : b.hi.y, p.z > b.hi.z ? p.z : b.hi.z};
    }
    box[block] = b;
    const PointQ8 m = {(b.lo.x + b.hi.x) >> 1, (b.lo.y + b.hi.y) >> 1, (b.lo.z + b.hi.z) >> 1};
    middle[block] = m;
    const int32_t x = b.hi.x - m.x, y = b.hi.y - m.y, z = b.hi.z - m.z, xy = x > y ? x : y;
    atomic_max(reach_q8[0], uint32_t(xy > z ? xy : z));
  }
};

/// Owner of a VertexGridView.
class VertexGrid {
 public:
  template <class Exec>
  VertexGrid(Exec& exec, const SurfaceMesh& surface) : surface_(surface) {
    constexpr int64_t kCellVox = 8;  // the edge of a sheet's block
    const int64_t blocks = surface.blocks.count();
    box_ = exec.template make<BoxQ8>(blocks);
    reach_q8_ = exec.template make<uint32_t>(1);
    exec.fill(reach_q8_.view(), uint32_t(0));
    Buffer<PointQ8> middle = exec.template make<PointQ8>(blocks);
    exec.for_each(
        "box blocks", blocks,
        BoxBlock{surface.blocks.first.view(), surface.position.view(), box_.view(), middle.view(), reach_q8_.view()});
    blocks_ = make_point_grid(exec, surface.extent_vox, kCellVox, blocks);
    fill_point_grid(exec, blocks_, View<const PointQ8>(middle.view()));
  }
  VertexGridView view() const {
    return {blocks_.view(), surface_.blocks.first.view(), box_.view(), reach_q8_.view(), surface_.position.view()};
  }

 private:
  const SurfaceMesh& surface_;
  Buffer<BoxQ8> box_;
  Buffer<uint32_t> reach_q8_;
  PointGrid blocks_;
};

}  // namespace isoshell
