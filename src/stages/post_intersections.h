// Self-intersections of a mesh on the lattice: exact, every pair of triangles that could meet.
#pragma once

#include "isoshell/lattice_surface.h"
#include "stages/point_grid_body.h"
#include "voxel/intersect.h"

namespace isoshell::post {

ISOSHELL_HD inline BoxQ8 box_of(const CornersOfTriangle& t) {
  BoxQ8 box{t.at[0], t.at[0]};
  for (int i = 1; i < 3; ++i) {
    const PointQ8 p = t.at[i];
    if (p.x < box.lo.x) box.lo.x = p.x;
    if (p.y < box.lo.y) box.lo.y = p.y;
    if (p.z < box.lo.z) box.lo.z = p.z;
    if (p.x > box.hi.x) box.hi.x = p.x;
    if (p.y > box.hi.y) box.hi.y = p.y;
    if (p.z > box.hi.z) box.hi.z = p.z;
  }
  return box;
}
ISOSHELL_HD inline bool boxes_meet(const BoxQ8& a, const BoxQ8& b) {
  return a.lo.x <= b.hi.x && b.lo.x <= a.hi.x && a.lo.y <= b.hi.y && b.lo.y <= a.hi.y && a.lo.z <= b.hi.z &&
         b.lo.z <= a.hi.z;
}

struct TrianglesView {
  View<const TriangleIndices> triangles;
  View<const PointQ8> position;
  ISOSHELL_HD CornersOfTriangle operator[](int64_t t) const {
    const TriangleIndices i = triangles[t];
    return {{i.a, i.b, i.c}, {position[i.a], position[i.b], position[i.c]}};
  }
};

/// Every triangle as a point, the middle of its box, and the largest extent of any box.
struct PlaceTriangle {
  TrianglesView mesh;
  View<PointQ8> middle;
  View<uint32_t> largest_extent;
  ISOSHELL_HD void operator()(int64_t t) const {
    const BoxQ8 box = box_of(mesh[t]);
    middle[t] = {box.lo.x + (box.hi.x - box.lo.x) / 2, box.lo.y + (box.hi.y - box.lo.y) / 2,
                 box.lo.z + (box.hi.z - box.lo.z) / 2};
    const int32_t x = box.hi.x - box.lo.x, y = box.hi.y - box.lo.y, z = box.hi.z - box.lo.z;
    const uint32_t extent = uint32_t(x > y ? (x > z ? x : z) : (y > z ? y : z));
    if (extent > atomic_load(largest_extent[0])) atomic_max(largest_extent[0], extent);
  }
};

/// Counts the triangles of smaller index that a triangle intersects, and marks the corners of both.
struct FindIntersections {
  TrianglesView mesh;
  PointGridView middles;
  int32_t reach;  ///< from a box to the middles of boxes that meet it
  View<uint32_t> marked;
  View<int64_t> found;
  ISOSHELL_HD void operator()(int64_t t) const {
    const CornersOfTriangle here = mesh[t];
    const BoxQ8 box = box_of(here);
    int64_t count = 0;
    const auto test = [&](const GridPoint& middle) {
      if (int64_t(middle.id) >= t) return;
      const CornersOfTriangle there = mesh[middle.id];
      if (!boxes_meet(box, box_of(there)) || !triangles_intersect(here, there)) return;
      ++count;
      for (int i = 0; i < 3; ++i) {
        atomic_or(marked[here.id[i]], 1u);
        atomic_or(marked[there.id[i]], 1u);
      }
    };
    visit_box(middles,
              {{box.lo.x - reach, box.lo.y - reach, box.lo.z - reach},
               {box.hi.x + reach, box.hi.y + reach, box.hi.z + reach}},
              test);
    found[t] = count;
  }
};
struct FoundHere {
  View<const int64_t> found;
  ISOSHELL_HD int64_t operator()(int64_t t) const { return found[t]; }
};

/// Pairs of triangles that intersect; `marked` becomes 1 at the corners of those triangles, 0 elsewhere. `blocks`: see
/// VoxelSetView::block_dims; `spacing_vox`: about the length of an edge. Cost: O(triangles) for edges of even length.
template <class Exec>
int64_t find_intersections(Exec& exec, const TrianglesView& mesh, const int32_t blocks[3], int64_t spacing_vox,
                           View<uint32_t> marked) {
  const int64_t triangles = mesh.triangles.size;
  Buffer<PointQ8> middle = exec.template make<PointQ8>(triangles);
  Buffer<uint32_t> largest_extent = exec.template make<uint32_t>(1);
  exec.fill(largest_extent.view(), 0u);
  exec.for_each("place triangles", triangles, PlaceTriangle{mesh, middle.view(), largest_extent.view()});
  PointGrid grid = make_point_grid(exec, blocks, spacing_vox, triangles);
  fill_point_grid(exec, grid, middle.view());
  const int32_t reach = int32_t(exec.value(View<const uint32_t>(largest_extent.view()), 0) / 2) + 1;
  Buffer<int64_t> found = exec.template make<int64_t>(triangles);
  exec.fill(marked, 0u);
  exec.for_each("find intersections", triangles, FindIntersections{mesh, grid.view(), reach, marked, found.view()});
  return exec.sum(triangles, FoundHere{found.view()});
}

}  // namespace isoshell::post
