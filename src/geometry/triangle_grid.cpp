#include "geometry/triangle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/vector_view.h"
#include "geometry/box.h"

namespace isoshell {
namespace {

constexpr int64_t kCellsPerTriangle = 8;
constexpr int64_t kEntriesPerTriangle = 32;  // more, and cells are too small for the largest triangles
constexpr int64_t kMostEntries = std::numeric_limits<uint32_t>::max();

}  // namespace

TriangleGrid::TriangleGrid(const std::vector<WorldPoint>& vertices, const Triangles& triangles) {
  view_.vertices = view_of(vertices);
  view_.triangles = view_of(triangles);
  choose_cells(box_of(vertices, triangles));
  const auto dims = view_.dims, blocks = view_.block_dims();
  block_used_.assign(size_t(blocks.count()), 0);
  for (size_t t = 0; t < triangles.size(); ++t)
    for_each_cell_of(t, [&](Cell c) {
      constexpr int64_t kBlock = TriangleGridView::kBlock;
      ++first_[size_t(dims.number_of(c))];
      block_used_[size_t(blocks.number_of({c.x / kBlock, c.y / kBlock, c.z / kBlock}))] = 1;
    });
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  listed_.resize(first_.back());
  for (size_t t = triangles.size(); t-- > 0;)
    for_each_cell_of(t, [&](Cell c) { listed_[--first_[size_t(dims.number_of(c))]] = uint32_t(t); });
  view_.first = view_of(first_);
  view_.listed = view_of(listed_);
  view_.block_used = view_of(block_used_);
}

/// About as wide as triangles are, wider where that would take too many cells or entries.
void TriangleGrid::choose_cells(const WorldBox& box) {
  const WorldPoint extent = box.max - box.min;
  const int64_t triangles = view_.triangles.size;
  const double longest = longest_side(box);
  view_.origin = box.min;
  view_.edge = longest > 0 ? longest / std::sqrt(double(triangles)) : 1;
  for (;; view_.edge *= 1.5) {
    const auto along = [&](double length) { return 1 + int64_t(length / view_.edge); };
    view_.dims = {along(extent.x), along(extent.y), along(extent.z)};
    const int64_t cells = view_.dims.count();
    if (cells > kCellsPerTriangle * triangles) continue;
    int64_t entries = 0;
    for (int64_t t = 0; t < triangles; ++t) {
      const auto [from, to] = cells_of(size_t(t));
      entries += (to.x - from.x + 1) * (to.y - from.y + 1) * (to.z - from.z + 1);
    }
    if (cells > 1 && entries > std::min(kEntriesPerTriangle * triangles, kMostEntries)) continue;
    first_.assign(size_t(cells) + 1, 0);
    return;
  }
}

BoxOf<TriangleGridView::Cell> TriangleGrid::cells_of(size_t triangle) const {
  const auto& t = view_.triangles[int64_t(triangle)];
  const WorldBox box = box_of(view_.vertices[t[0]], view_.vertices[t[1]], view_.vertices[t[2]]);
  return {view_.cell_of(box.min), view_.cell_of(box.max)};
}

template <class Visit>
void TriangleGrid::for_each_cell_of(size_t triangle, Visit visit) const {
  const auto [lo, hi] = cells_of(triangle);
  for (int64_t z = lo.z; z <= hi.z; ++z)
    for (int64_t y = lo.y; y <= hi.y; ++y)
      for (int64_t x = lo.x; x <= hi.x; ++x) visit(Cell{x, y, z});
}

MeshPoint TriangleGrid::nearest(WorldPoint p) const { return view_.nearest(p); }

bool TriangleGrid::is_facing(size_t triangle, WorldPoint direction) const {
  return dot(view_.normal_of(uint32_t(triangle)), direction) > 0;
}

MeshPoint TriangleGrid::nearest_facing(WorldPoint p, WorldPoint direction, double farthest) const {
  return view_.search(p, farthest * farthest, [&](uint32_t triangle) { return is_facing(triangle, direction); });
}

MeshPoint TriangleGrid::nearest_aligned(WorldPoint p, WorldPoint normal, double least_cosine, double farthest) const {
  return view_.nearest_aligned(p, normal, least_cosine, farthest);
}

MeshPoint TriangleGrid::most_aligned(WorldPoint p, WorldPoint normal, double farthest) const {
  return view_.most_aligned(p, normal, farthest);
}

WorldPoint TriangleGrid::at(const MeshPoint& place) const {
  const auto& t = view_.triangles[place.triangle];
  return interpolate(place, view_.vertices[t[0]], view_.vertices[t[1]], view_.vertices[t[2]]);
}

double TriangleGrid::distance_to(size_t triangle, WorldPoint p) const {
  const auto& t = view_.triangles[int64_t(triangle)];
  return std::sqrt(
      nearest_of_triangle(p, view_.vertices[t[0]], view_.vertices[t[1]], view_.vertices[t[2]]).distance_sq);
}

}  // namespace isoshell
