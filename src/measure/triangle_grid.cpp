#include "measure/triangle_grid.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/world_vector.h"

namespace isoshell {
namespace {

constexpr double kLargest = std::numeric_limits<double>::max();
constexpr int64_t kCellsPerTriangle = 8;
constexpr int64_t kEntriesPerTriangle = 32;  // more, and cells are too small for the largest triangles
constexpr int64_t kMostEntries = std::numeric_limits<uint32_t>::max();

/// Of the segment from a to b, at a + part (b - a).
struct OnSegment {
  double distance_sq, part;
};
OnSegment nearest_of_segment(WorldPoint p, WorldPoint a, WorldPoint b) {
  const WorldPoint ab = b - a, ap = p - a;
  const double length_sq = dot(ab, ab), t = length_sq > 0 ? std::clamp(dot(ap, ab) / length_sq, 0.0, 1.0) : 0;
  const WorldPoint rest = ap + -t * ab;
  return {dot(rest, rest), t};
}

}  // namespace

MeshPoint nearest_of_triangle(WorldPoint p, WorldPoint a, WorldPoint b, WorldPoint c) {
  const WorldPoint ab = b - a, ac = c - a, ap = p - a;
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
  const double area_sq = bb * cc - bc * bc, v = cc * pb - bc * pc, w = bb * pc - bc * pb;
  if (area_sq > 0 && v >= 0 && w >= 0 && v + w <= area_sq) {
    const WorldPoint rest = ap + (-v / area_sq) * ab + (-w / area_sq) * ac;
    return {dot(rest, rest), v / area_sq, w / area_sq};
  }
  const OnSegment on_ab = nearest_of_segment(p, a, b), on_bc = nearest_of_segment(p, b, c),
                  on_ca = nearest_of_segment(p, c, a);
  const double least = std::min({on_ab.distance_sq, on_bc.distance_sq, on_ca.distance_sq});
  if (on_ab.distance_sq == least) return {least, on_ab.part, 0};
  if (on_bc.distance_sq == least) return {least, 1 - on_bc.part, on_bc.part};
  return {least, 0, 1 - on_ca.part};
}

TriangleGrid::TriangleGrid(const std::vector<WorldPoint>& vertices, const Triangles& triangles)
    : vertices_(vertices), list_(triangles) {
  WorldPoint lo{kLargest, kLargest, kLargest}, hi{-kLargest, -kLargest, -kLargest};
  for (const auto& t : list_)
    for (const uint32_t v : t) {
      const WorldPoint p = vertices_[v];
      lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
      hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
    }
  choose_cells(lo, hi);
  for (size_t t = 0; t < list_.size(); ++t) for_each_cell_of(t, [&](Cell c) { ++first_[number_of(c)]; });
  for (size_t c = 1; c < first_.size(); ++c) first_[c] += first_[c - 1];
  triangles_.resize(first_.back());
  for (size_t t = list_.size(); t-- > 0;)
    for_each_cell_of(t, [&](Cell c) { triangles_[--first_[number_of(c)]] = uint32_t(t); });
}

/// About as wide as triangles are, wider where that would take too many cells or entries.
void TriangleGrid::choose_cells(WorldPoint lo, WorldPoint hi) {
  const std::array<double, 3> extent{hi.x - lo.x, hi.y - lo.y, hi.z - lo.z};
  const auto triangles = int64_t(list_.size());
  const double longest = std::max({extent[0], extent[1], extent[2]});
  origin_ = {lo.x, lo.y, lo.z};
  edge_ = longest > 0 ? longest / std::sqrt(double(triangles)) : 1;
  for (;; edge_ *= 1.5) {
    int64_t cells = 1, entries = 0;
    for (size_t axis = 0; axis < 3; ++axis) cells *= dims_[axis] = 1 + int64_t(extent[axis] / edge_);
    if (cells > kCellsPerTriangle * triangles) continue;
    for (size_t t = 0; t < list_.size(); ++t) entries += cells_of(t).count();
    if (cells > 1 && entries > std::min(kEntriesPerTriangle * triangles, kMostEntries)) continue;
    first_.assign(size_t(cells) + 1, 0);
    return;
  }
}

TriangleGrid::Cell TriangleGrid::cell_of(WorldPoint p) const {
  const double at[3] = {p.x, p.y, p.z};
  Cell cell;
  for (size_t axis = 0; axis < 3; ++axis)
    cell[axis] = int64_t(std::clamp((at[axis] - origin_[axis]) / edge_, 0.0, double(dims_[axis] - 1)));
  return cell;
}

TriangleGrid::CellBox TriangleGrid::cells_of(size_t triangle) const {
  const auto& t = list_[triangle];
  const WorldPoint a = vertices_[t[0]], b = vertices_[t[1]], c = vertices_[t[2]];
  return {cell_of({std::min({a.x, b.x, c.x}), std::min({a.y, b.y, c.y}), std::min({a.z, b.z, c.z})}),
          cell_of({std::max({a.x, b.x, c.x}), std::max({a.y, b.y, c.y}), std::max({a.z, b.z, c.z})})};
}

template <class Visit>
void TriangleGrid::for_each_cell_of(size_t triangle, Visit visit) const {
  const auto [lo, hi] = cells_of(triangle);
  for (int64_t z = lo[2]; z <= hi[2]; ++z)
    for (int64_t y = lo[1]; y <= hi[1]; ++y)
      for (int64_t x = lo[0]; x <= hi[0]; ++x) visit(Cell{x, y, z});
}

/// The cells that are `ring` cells from the middle along some axis.
template <class Visit>
void TriangleGrid::for_each_cell_of_ring(Cell middle, int64_t ring, Visit visit) const {
  const auto from = [&](size_t axis) { return std::max<int64_t>(0, middle[axis] - ring); };
  const auto to = [&](size_t axis) { return std::min(dims_[axis] - 1, middle[axis] + ring); };
  for (int64_t z = from(2); z <= to(2); ++z)
    for (int64_t y = from(1); y <= to(1); ++y) {
      const bool is_face = std::abs(z - middle[2]) == ring || std::abs(y - middle[1]) == ring;
      for (int64_t x = from(0); x <= to(0); ++x) {
        if (is_face || std::abs(x - middle[0]) == ring)
          visit(Cell{x, y, z});
        else
          x = std::max(x, middle[0] + ring - 1);  // past what is inside of the ring
      }
    }
}

/// No triangle that none of the cells up to the ring lists is nearer to p. Nothing lies beyond the grid.
double TriangleGrid::reach_of(Cell middle, int64_t ring, WorldPoint p) const {
  const double at[3] = {p.x, p.y, p.z};
  double reach = kLargest;
  for (size_t axis = 0; axis < 3; ++axis) {
    const int64_t below = middle[axis] - ring, above = middle[axis] + ring + 1;
    if (below > 0) reach = std::min(reach, at[axis] - (origin_[axis] + double(below) * edge_));
    if (above < dims_[axis]) reach = std::min(reach, origin_[axis] + double(above) * edge_ - at[axis]);
  }
  return reach;
}

/// The nearest point of the triangles that are accepted and no farther.
template <class Accept>
MeshPoint TriangleGrid::search(WorldPoint p, double farthest_sq, Accept accept) const {
  const Cell middle = cell_of(p);
  MeshPoint best;
  best.distance_sq = farthest_sq;
  for (int64_t ring = 0;; ++ring) {
    for_each_cell_of_ring(middle, ring, [&](Cell cell) {
      const size_t number = number_of(cell);
      for (uint32_t i = first_[number]; i < first_[number + 1]; ++i) {
        const uint32_t triangle = triangles_[i];
        const auto& t = list_[triangle];
        const MeshPoint found = nearest_of_triangle(p, vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
        if (found.distance_sq > best.distance_sq ||
            (found.distance_sq == best.distance_sq && triangle >= best.triangle) || !accept(triangle))
          continue;
        best = found;
        best.triangle = triangle;
      }
    });
    const double reach = reach_of(middle, ring, p);
    if (reach == kLargest || (reach > 0 && best.distance_sq < reach * reach)) return best;
  }
}

MeshPoint TriangleGrid::nearest(WorldPoint p) const {
  return search(p, std::numeric_limits<double>::infinity(), [](uint32_t) { return true; });
}

bool TriangleGrid::is_facing(size_t triangle, WorldPoint direction) const {
  const auto& t = list_[triangle];
  return dot(doubled_area(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]), direction) > 0;
}

MeshPoint TriangleGrid::nearest_facing(WorldPoint p, WorldPoint direction, double farthest) const {
  return search(p, farthest * farthest, [&](uint32_t triangle) { return is_facing(triangle, direction); });
}

MeshPoint TriangleGrid::nearest_aligned(WorldPoint p, WorldPoint normal, double least_cosine, double farthest) const {
  return search(p, farthest * farthest, [&](uint32_t triangle) {
    const auto& t = list_[triangle];
    const WorldPoint along = doubled_area(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
    return std::abs(dot(along, normal)) >= least_cosine * length(along);
  });
}

MeshPoint TriangleGrid::most_aligned(WorldPoint p, WorldPoint normal, double farthest) const {
  MeshPoint best;
  double best_cosine = -1;
  search(p, farthest * farthest, [&](uint32_t triangle) {
    const auto& t = list_[triangle];
    const WorldPoint along = doubled_area(vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]);
    const double size = length(along), cosine = size > 0 ? std::abs(dot(along, normal)) / size : -1;
    if (cosine > best_cosine || (cosine == best_cosine && triangle < best.triangle)) {
      best_cosine = cosine;
      best.triangle = triangle;
    }
    return false;  // the search goes on to all of them
  });
  return best;
}

double TriangleGrid::distance_to(size_t triangle, WorldPoint p) const {
  const auto& t = list_[triangle];
  return std::sqrt(nearest_of_triangle(p, vertices_[t[0]], vertices_[t[1]], vertices_[t[2]]).distance_sq);
}

}  // namespace isoshell
