// Self-intersections of a mesh on the lattice: exact, every pair of triangles that could meet.
#pragma once

#include "isoshell/advanced/lattice_surface.h"
#include "stages/sparse/point_grid_body.h"
#include "voxel/intersect.h"

namespace isoshell::optimize {

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
  View<const uint32_t> joined = {};  ///< of the first vertices the one that each is a copy of (see FixedSeeds)

  /// By the ids that copies share.
  ISOSHELL_HD CornersOfTriangle operator[](int64_t t) const {
    const TriangleIndices i = triangles[t];
    return {{id(i.a), id(i.b), id(i.c)}, {position[i.a], position[i.b], position[i.c]}};
  }

 private:
  ISOSHELL_HD uint32_t id(uint32_t v) const { return v < joined.size ? joined[v] : v; }
};

ISOSHELL_HD inline int32_t extent_of(const BoxQ8& box) {
  const int32_t x = box.hi.x - box.lo.x, y = box.hi.y - box.lo.y, z = box.hi.z - box.lo.z;
  return x > y ? (x > z ? x : z) : (y > z ? y : z);
}

/// Every triangle as a point, the middle of its box, and the largest extent of any box.
struct PlaceTriangle {
  TrianglesView mesh;
  View<PointQ8> middle;
  View<uint32_t> largest_extent;
  ISOSHELL_HD void operator()(int64_t t) const {
    const BoxQ8 box = box_of(mesh[t]);
    middle[t] = {box.lo.x + (box.hi.x - box.lo.x) / 2, box.lo.y + (box.hi.y - box.lo.y) / 2,
                 box.lo.z + (box.hi.z - box.lo.z) / 2};
    const uint32_t extent = uint32_t(extent_of(box));
    if (extent > atomic_load(largest_extent[0])) atomic_max(largest_extent[0], extent);
  }
};

/// Triangles whose boxes are above `above` and at most `most` wide.
struct ExtentClass {
  int32_t above, most;
  ISOSHELL_HD bool holds(int32_t extent) const { return extent > above && extent <= most; }
};
struct IsOfClass {
  TrianglesView mesh;
  ExtentClass extents;
  ISOSHELL_HD bool operator()(int64_t t) const { return extents.holds(extent_of(box_of(mesh[t]))); }
};
struct GatherMiddle {
  View<const uint32_t> triangle;
  View<const PointQ8> middle;
  View<PointQ8> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = middle[triangle[i]]; }
};

/// Which triangles look for others: all, or those with a corner that has moved.
struct LooksForOthers {
  View<const TriangleIndices> triangles;
  View<const uint32_t> has_moved;  ///< per vertex 1 or 0; empty: all look
  ISOSHELL_HD bool operator()(int64_t t) const {
    if (has_moved.size == 0) return true;
    const TriangleIndices i = triangles[t];
    return has_moved[i.a] || has_moved[i.b] || has_moved[i.c];
  }
};

/// Counts the triangles of a class that a triangle intersects, each pair once, and marks the corners of both. Where all
/// look for others, only those of the class and of smaller ones look here.
struct FindIntersections {
  TrianglesView mesh;
  LooksForOthers looks;
  ExtentClass extents;
  PointGridView middles;          ///< of the class
  View<const uint32_t> triangle;  ///< the class's triangles, by number in the grid; empty: all of the mesh
  View<uint32_t> marked;
  View<int64_t> found;
  ISOSHELL_HD void operator()(int64_t t) const {
    if (!looks(t)) return;
    const CornersOfTriangle here = mesh[t];
    const BoxQ8 box = box_of(here);
    const int32_t extent = extent_of(box);
    const bool all_look = looks.has_moved.size == 0;
    if (all_look && extent > extents.most) return;
    const bool is_seen_by_class = !all_look || extents.holds(extent);
    int64_t count = 0;
    const auto test = [&](const GridPoint& middle) {
      const uint32_t other = triangle.size > 0 ? triangle[middle.id] : middle.id;
      if (is_seen_by_class && int64_t(other) >= t && looks(other)) return;
      const CornersOfTriangle there = mesh[other];
      if (!boxes_meet(box, box_of(there)) || !triangles_intersect(here, there)) return;
      ++count;
      mark_corners(t);
      mark_corners(other);
    };
    const int32_t reach = extents.most / 2 + 1;  // from the box to the middles of boxes that meet it
    visit_box(middles,
              {{box.lo.x - reach, box.lo.y - reach, box.lo.z - reach},
               {box.hi.x + reach, box.hi.y + reach, box.hi.z + reach}},
              test);
    found[t] += count;
  }

 private:
  ISOSHELL_HD void mark_corners(int64_t t) const {
    const TriangleIndices i = mesh.triangles[t];
    atomic_or(marked[i.a], 1u);
    atomic_or(marked[i.b], 1u);
    atomic_or(marked[i.c], 1u);
  }
};
struct FoundHere {
  View<const int64_t> found;
  ISOSHELL_HD int64_t operator()(int64_t t) const { return found[t]; }
};

/// Boxes up to so many times the usual edge are ordinary; each class of larger ones reaches twice as far as the last.
constexpr int64_t kOrdinaryExtent = 2;

/// Pairs of triangles that intersect; `marked` becomes 1 at the corners of those triangles, 0 elsewhere. `extent_vox`:
/// see SurfaceMesh; `spacing_vox`: about the length of an edge. `has_moved`: per vertex 1 or 0, where no others can be
/// of triangles that intersect now; empty: all can. Triangles look for others of their own class and of larger ones, so
/// that few large ones do not widen the search of all. Cost: O(triangles) where edges are of even length, and again for
/// each class that some larger ones are in.
template <class Exec>
int64_t find_intersections(Exec& exec, const TrianglesView& mesh, const int32_t extent_vox[3], int64_t spacing_vox,
                           View<uint32_t> marked, View<const uint32_t> has_moved = {}) {
  const int64_t triangles = mesh.triangles.size;
  Buffer<PointQ8> middle = exec.template make<PointQ8>(triangles);
  Buffer<uint32_t> largest_extent = exec.template make<uint32_t>(1);
  exec.fill(largest_extent.view(), 0u);
  exec.for_each("place triangles", triangles, PlaceTriangle{mesh, middle.view(), largest_extent.view()});
  Buffer<int64_t> found = exec.template make<int64_t>(triangles);
  exec.fill(found.view(), int64_t(0));
  exec.fill(marked, 0u);
  const auto find_among = [&](ExtentClass extents, View<const PointQ8> middles, View<const uint32_t> of_class,
                              int64_t cell_vox) {
    PointGrid grid = make_point_grid(exec, extent_vox, cell_vox, middles.size);
    fill_point_grid(exec, grid, middles);
    exec.for_each(
        "find intersections", triangles,
        FindIntersections{mesh, {mesh.triangles, has_moved}, extents, grid.view(), of_class, marked, found.view()});
  };
  const auto largest = int32_t(exec.value(View<const uint32_t>(largest_extent.view()), 0));
  const int64_t ordinary = kOrdinaryExtent * spacing_vox * kOneVoxelQ8;
  if (largest <= ordinary) {
    find_among({-1, largest}, middle.view(), {}, spacing_vox);
    return exec.sum(triangles, FoundHere{found.view()});
  }
  int64_t above = -1;
  for (int64_t most = ordinary, cell_vox = spacing_vox; above < largest; above = most, most *= 2) {
    const ExtentClass extents{int32_t(above), int32_t(most < largest ? most : largest)};
    const Buffer<uint32_t> of_class = exec.select(triangles, IsOfClass{mesh, extents});
    Buffer<PointQ8> middles = exec.template make<PointQ8>(of_class.size());
    exec.for_each("gather middles", middles.size(), GatherMiddle{of_class.view(), middle.view(), middles.view()});
    if (!middles.empty()) find_among(extents, middles.view(), of_class.view(), cell_vox);
    cell_vox = 2 * most / kOneVoxelQ8;
  }
  return exec.sum(triangles, FoundHere{found.view()});
}

}  // namespace isoshell::optimize
