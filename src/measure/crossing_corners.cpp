// crossing_corners (see crossing_corners.h).
#include "measure/crossing_corners.h"

#include <tbb/parallel_for.h>
#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

#include "voxel/intersect.h"

namespace isoshell {
namespace {

struct Box {
  int32_t lo[3], hi[3];
};

Box box_of(const CornersOfTriangle& t) {
  const PointQ8 a = t.at[0], b = t.at[1], c = t.at[2];
  return {{std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})},
          {std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})}};
}

bool meet(const Box& p, const Box& q) {
  for (int i = 0; i < 3; ++i)
    if (p.hi[i] < q.lo[i] || q.hi[i] < p.lo[i]) return false;
  return true;
}

struct CellOfTriangle {
  uint64_t cell;
  uint32_t triangle;
};

/// Every cell that the box of a triangle reaches into; a cell is twice as wide as boxes are on average.
std::vector<CellOfTriangle> sort_into_cells(const std::vector<Box>& boxes) {
  int64_t extents = 0;
  for (const Box& box : boxes)
    for (int i = 0; i < 3; ++i) extents += box.hi[i] - box.lo[i];
  const int64_t width = std::max<int64_t>(1, 2 * extents / (3 * int64_t(boxes.size())));
  std::vector<CellOfTriangle> cells;
  for (size_t t = 0; t < boxes.size(); ++t) {
    const Box& box = boxes[t];
    for (int64_t x = box.lo[0] / width; x <= box.hi[0] / width; ++x)
      for (int64_t y = box.lo[1] / width; y <= box.hi[1] / width; ++y)
        for (int64_t z = box.lo[2] / width; z <= box.hi[2] / width; ++z)
          cells.push_back({uint64_t(x) << 42 | uint64_t(y) << 21 | uint64_t(z), uint32_t(t)});
  }
  tbb::parallel_sort(cells.begin(), cells.end(), [](const CellOfTriangle& p, const CellOfTriangle& q) {
    return p.cell != q.cell ? p.cell < q.cell : p.triangle < q.triangle;
  });
  return cells;
}

}  // namespace

std::vector<PointQ8> crossing_corners(const DualMesh& mesh, View<const uint32_t> joined) {
  const int64_t count = mesh.triangles.size();
  if (count == 0) return {};
  const auto id = [&](uint32_t v) { return v < joined.size ? joined[v] : v; };
  std::vector<CornersOfTriangle> triangles(static_cast<size_t>(count));
  std::vector<Box> boxes(triangles.size());
  tbb::parallel_for(int64_t(0), count, [&](int64_t i) {
    const TriangleIndices t = mesh.triangles[i];
    triangles[size_t(i)] = {{id(t.a), id(t.b), id(t.c)}, {mesh.position[t.a], mesh.position[t.b], mesh.position[t.c]}};
    boxes[size_t(i)] = box_of(triangles[size_t(i)]);
  });
  const std::vector<CellOfTriangle> cells = sort_into_cells(boxes);
  std::vector<uint8_t> crosses(cells.size());  // an element each: no two threads write the same
  tbb::parallel_for(size_t(0), cells.size(), [&](size_t i) {
    const uint32_t here = cells[i].triangle;
    const auto crosses_other = [&](const CellOfTriangle& c) {
      return c.triangle != here && meet(boxes[here], boxes[c.triangle]) &&
             triangles_intersect(triangles[here], triangles[c.triangle]);
    };
    size_t first = i, last = i + 1;
    while (first > 0 && cells[first - 1].cell == cells[i].cell) --first;
    while (last < cells.size() && cells[last].cell == cells[i].cell) ++last;
    crosses[i] = std::any_of(cells.begin() + int64_t(first), cells.begin() + int64_t(last), crosses_other);
  });
  std::vector<PointQ8> corners;
  for (size_t i = 0; i < cells.size(); ++i)
    if (crosses[i])
      for (const PointQ8 p : triangles[cells[i].triangle].at) corners.push_back(p);
  const auto key = [](PointQ8 p) { return std::make_tuple(p.x, p.y, p.z); };
  std::sort(corners.begin(), corners.end(), [&](PointQ8 p, PointQ8 q) { return key(p) < key(q); });
  corners.erase(std::unique(corners.begin(), corners.end()), corners.end());
  return corners;
}

}  // namespace isoshell
