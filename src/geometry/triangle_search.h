// Nearest points of a mesh on any backend, by a grid of cells that list the triangles whose boxes meet them.
#pragma once

#include <cstdint>
#include <limits>

#include "geometry/world_vector.h"
#include "isoshell/advanced/buffer.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// A point of a mesh: a + b_part (b - a) + c_part (c - a) of a triangle's corners a, b and c.
struct MeshPoint {
  static constexpr uint32_t kNoTriangle = 0xffffffff;
  double distance_sq = std::numeric_limits<double>::infinity();
  double b_part = 0, c_part = 0;
  uint32_t triangle = kNoTriangle;
};
/// What is there of what is known at its triangle's corners. Where all are the same, exactly that.
template <class Value>
Value interpolate(const MeshPoint& place, const Value& a, const Value& b, const Value& c) {
  return a + place.b_part * (b - a) + place.c_part * (c - a);
}

namespace triangle_search {

ISOSHELL_HD inline double smaller(double a, double b) { return b < a ? b : a; }
ISOSHELL_HD inline double larger(double a, double b) { return a < b ? b : a; }

/// Of the segment from a to b, at a + part (b - a).
struct OnSegment {
  double distance_sq, part;
};
ISOSHELL_HD inline OnSegment nearest_of_segment(WorldPoint p, WorldPoint a, WorldPoint b) {
  const WorldPoint ab = b - a, ap = p - a;
  const double length_sq = dot(ab, ab), t = length_sq > 0 ? smaller(larger(dot(ap, ab) / length_sq, 0), 1) : 0;
  const WorldPoint rest = ap + -t * ab;
  return {dot(rest, rest), t};
}

ISOSHELL_HD inline double outside_sq(double at, double a, double b, double c) {
  const double outside = larger(smaller(smaller(a, b), c) - at, at - larger(larger(a, b), c));
  return outside > 0 ? outside * outside : 0;
}
/// To the box around a triangle.
ISOSHELL_HD inline double box_distance_sq(WorldPoint p, WorldPoint a, WorldPoint b, WorldPoint c) {
  return outside_sq(p.x, a.x, b.x, c.x) + outside_sq(p.y, a.y, b.y, c.y) + outside_sq(p.z, a.z, b.z, c.z);
}

/// Where p lies over a triangle that is flat at a: a height and what p has along it are taken upright to one edge, so
/// that nothing is the small difference of two large products. Infinitely far where p does not lie over it.
ISOSHELL_HD inline MeshPoint over_flat_triangle(WorldPoint ab, WorldPoint ac, WorldPoint ap) {
  const double base_sq = dot(ab, ab);
  if (!(base_sq > 0)) return {};
  const double foot = dot(ac, ab) / base_sq, along = dot(ap, ab) / base_sq;
  const WorldPoint height = ac + -foot * ab, beside = ap + -along * ab;
  const double height_sq = dot(height, height), over = dot(beside, height);
  if (!(over >= 0 && over <= height_sq && height_sq > 0)) return {};
  const double c_part = over / height_sq, b_part = along - c_part * foot;
  if (!(b_part >= 0 && b_part + c_part <= 1)) return {};
  const WorldPoint rest = beside + -c_part * height;
  return {dot(rest, rest), b_part, c_part};
}

}  // namespace triangle_search

/// In the plane where p lies over the triangle, on the edges elsewhere. Without a triangle's number. However flat the
/// triangle is, the distance is exact up to some 1e-12 of its size.
ISOSHELL_HD inline MeshPoint nearest_of_triangle(WorldPoint p, WorldPoint a, WorldPoint b, WorldPoint c) {
  using namespace triangle_search;
  constexpr double kFlat = 1e-4;  // squared sine of the angle at a
  const WorldPoint ab = b - a, ac = c - a, ap = p - a;
  const double bb = dot(ab, ab), bc = dot(ab, ac), cc = dot(ac, ac), pb = dot(ap, ab), pc = dot(ap, ac);
  const double area_sq = bb * cc - bc * bc, v = cc * pb - bc * pc, w = bb * pc - bc * pb;
  if (area_sq <= kFlat * bb * cc) {
    const MeshPoint over = over_flat_triangle(ab, ac, ap);
    if (over.distance_sq < std::numeric_limits<double>::infinity()) return over;
  } else if (v >= 0 && w >= 0 && v + w <= area_sq) {
    const WorldPoint rest = ap + (-v / area_sq) * ab + (-w / area_sq) * ac;
    return {dot(rest, rest), v / area_sq, w / area_sq};
  }
  const OnSegment on_ab = nearest_of_segment(p, a, b), on_bc = nearest_of_segment(p, b, c),
                  on_ca = nearest_of_segment(p, c, a);
  const double least = smaller(smaller(on_ab.distance_sq, on_bc.distance_sq), on_ca.distance_sq);
  if (on_ab.distance_sq == least) return {least, on_ab.part, 0};
  if (on_bc.distance_sq == least) return {least, 1 - on_bc.part, on_bc.part};
  return {least, 0, 1 - on_ca.part};
}

/// What TriangleGrid holds, in the memory of a backend.
class TriangleGridView {
 public:
  struct Cell {
    int64_t x, y, z;
  };
  /// Of cells, or of blocks of kBlock^3 cells.
  struct Dims {
    int64_t x, y, z;
    ISOSHELL_HD int64_t count() const { return x * y * z; }
    ISOSHELL_HD int64_t number_of(Cell c) const { return (c.z * y + c.y) * x + c.x; }
  };
  static constexpr int64_t kBlock = 8;

  View<const WorldPoint> vertices;
  View<const std::array<uint32_t, 3>> triangles;
  WorldPoint origin{0, 0, 0};
  double edge = 1;  ///< of a cell
  Dims dims{1, 1, 1};
  View<const uint32_t> first;      ///< by cell, and an end: into `listed`
  View<const uint32_t> listed;     ///< triangles
  View<const uint8_t> block_used;  ///< whether a cell of it lists any

  /// See TriangleGrid.
  ISOSHELL_HD MeshPoint nearest(WorldPoint p) const {
    return search(p, std::numeric_limits<double>::infinity(), [](uint32_t) { return true; });
  }
  ISOSHELL_HD MeshPoint nearest_aligned(WorldPoint p, WorldPoint normal, double least_cosine, double farthest) const {
    return search(p, farthest * farthest, [&](uint32_t triangle) {
      const WorldPoint along = normal_of(triangle);
      return std::abs(dot(along, normal)) >= least_cosine * length(along);
    });
  }
  ISOSHELL_HD MeshPoint most_aligned(WorldPoint p, WorldPoint normal, double farthest) const {
    MeshPoint best;
    double best_cosine = -1;
    search(p, farthest * farthest, [&](uint32_t triangle) {
      const WorldPoint along = normal_of(triangle);
      const double size = length(along), cosine = size > 0 ? std::abs(dot(along, normal)) / size : -1;
      if (cosine > best_cosine || (cosine == best_cosine && triangle < best.triangle)) {
        best_cosine = cosine;
        best.triangle = triangle;
      }
      return false;  // the search goes on to all of them
    });
    return best;
  }

  /// Along the triangle's normal, as long as twice its area.
  ISOSHELL_HD WorldPoint normal_of(uint32_t triangle) const {
    const auto& t = triangles[triangle];
    return doubled_area(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
  }
  ISOSHELL_HD Cell cell_of(WorldPoint p) const {
    return {cell_along(p.x - origin.x, dims.x), cell_along(p.y - origin.y, dims.y), cell_along(p.z - origin.z, dims.z)};
  }
  ISOSHELL_HD Dims block_dims() const {
    return {(dims.x + kBlock - 1) / kBlock, (dims.y + kBlock - 1) / kBlock, (dims.z + kBlock - 1) / kBlock};
  }

  /// The nearest point of the triangles that are accepted and no farther. Triangles may be asked about several times.
  template <class Accept>
  ISOSHELL_HD MeshPoint search(WorldPoint p, double farthest_sq, Accept accept) const {
    MeshPoint best;
    best.distance_sq = farthest_sq;
    const Cell middle = cell_of(p);
    for (int64_t ring = 0; ring <= kNearRings; ++ring) {
      for_each_of_ring(middle, ring, dims, [&](Cell cell) { search_cell(cell, p, accept, best); });
      if (ends_within(middle, ring, dims, edge, p, best)) return best;
    }
    const Cell block{middle.x / kBlock, middle.y / kBlock, middle.z / kBlock};
    for (int64_t ring = 0;; ++ring) {
      for_each_of_ring(block, ring, block_dims(), [&](Cell at) { search_block(at, p, accept, best); });
      if (ends_within(block, ring, block_dims(), edge * kBlock, p, best)) return best;
    }
  }

 private:
  static constexpr int64_t kNearRings = 2;  ///< then blocks of cells are faster
  static constexpr double kWall = 1e-6;     ///< of a cell: how far rounding may move its walls
  static constexpr double kBoxPart = 1 - 1e-9;

  ISOSHELL_HD int64_t cell_along(double at, int64_t count) const {
    return int64_t(triangle_search::smaller(triangle_search::larger(at / edge, 0), double(count - 1)));
  }

  /// The cells that are `ring` cells from the middle along some axis.
  template <class Visit>
  ISOSHELL_HD static void for_each_of_ring(Cell middle, int64_t ring, Dims dims, Visit visit) {
    const auto from = [&](int64_t at) { return at > ring ? at - ring : 0; };
    const auto to = [&](int64_t at, int64_t count) { return at + ring < count ? at + ring : count - 1; };
    const int64_t last_x = to(middle.x, dims.x), last_y = to(middle.y, dims.y), last_z = to(middle.z, dims.z);
    for (int64_t z = from(middle.z); z <= last_z; ++z)
      for (int64_t y = from(middle.y); y <= last_y; ++y) {
        const bool is_face =
            z == middle.z - ring || z == middle.z + ring || y == middle.y - ring || y == middle.y + ring;
        for (int64_t x = from(middle.x); x <= last_x; ++x) {
          if (is_face || x == middle.x - ring || x == middle.x + ring)
            visit(Cell{x, y, z});
          else if (x < middle.x + ring - 1)
            x = middle.x + ring - 1;  // past what is inside of the ring
        }
      }
  }

  /// Along one axis, from p to what lies beyond the rings so far. Nothing lies beyond the grid.
  ISOSHELL_HD static double reach_along(int64_t middle, int64_t ring, int64_t count, double edge, double at) {
    double reach = std::numeric_limits<double>::max();
    if (middle - ring > 0) reach = at - double(middle - ring) * edge;
    if (middle + ring + 1 < count) reach = triangle_search::smaller(reach, double(middle + ring + 1) * edge - at);
    return reach;
  }
  /// Whether no triangle that none of the cells up to the ring lists is nearer than the best one.
  ISOSHELL_HD bool ends_within(Cell middle, int64_t ring, Dims count, double width, WorldPoint p,
                               const MeshPoint& best) const {
    using triangle_search::smaller;
    const WorldPoint at = p - origin;
    const double reach = smaller(
        smaller(reach_along(middle.x, ring, count.x, width, at.x), reach_along(middle.y, ring, count.y, width, at.y)),
        reach_along(middle.z, ring, count.z, width, at.z));
    return reach == std::numeric_limits<double>::max() || (reach > 0 && best.distance_sq < reach * reach);
  }

  /// What the cells from `lowest` to `highest` list for nearer points than that lies elsewhere, too. A little less than
  /// the distance: walls of cells are rounded.
  ISOSHELL_HD double least_distance_sq(Cell lowest, Cell highest, WorldPoint p) const {
    const WorldPoint at = p - origin;
    return outside_sq(at.x / edge, lowest.x, highest.x) + outside_sq(at.y / edge, lowest.y, highest.y) +
           outside_sq(at.z / edge, lowest.z, highest.z);
  }
  ISOSHELL_HD double outside_sq(double at, int64_t lowest, int64_t highest) const {
    const double outside = triangle_search::larger(double(lowest) - at, at - double(highest + 1)) - kWall;
    return outside > 0 ? outside * outside * (edge * edge) : 0;
  }

  template <class Accept>
  ISOSHELL_HD void search_block(Cell block, WorldPoint p, Accept& accept, MeshPoint& best) const {
    if (!block_used[block_dims().number_of(block)]) return;
    const Cell lowest{block.x * kBlock, block.y * kBlock, block.z * kBlock};
    const auto end = [](int64_t from, int64_t count) { return from + kBlock < count ? from + kBlock : count; };
    const Cell past{end(lowest.x, dims.x), end(lowest.y, dims.y), end(lowest.z, dims.z)};
    if (least_distance_sq(lowest, {past.x - 1, past.y - 1, past.z - 1}, p) > best.distance_sq) return;
    for (int64_t z = lowest.z; z < past.z; ++z)
      for (int64_t y = lowest.y; y < past.y; ++y)
        for (int64_t x = lowest.x; x < past.x; ++x) search_cell({x, y, z}, p, accept, best);
  }

  template <class Accept>
  ISOSHELL_HD void search_cell(Cell cell, WorldPoint p, Accept& accept, MeshPoint& best) const {
    const int64_t number = dims.number_of(cell);
    const uint32_t end = first[number + 1];
    if (first[number] == end || least_distance_sq(cell, cell, p) > best.distance_sq) return;
    for (uint32_t i = first[number]; i < end; ++i) {
      const uint32_t triangle = listed[i];
      const auto& t = triangles[triangle];
      const WorldPoint a = vertices[t[0]], b = vertices[t[1]], c = vertices[t[2]];
      if (kBoxPart * triangle_search::box_distance_sq(p, a, b, c) > best.distance_sq) continue;
      const MeshPoint found = nearest_of_triangle(p, a, b, c);
      if (found.distance_sq > best.distance_sq ||
          (found.distance_sq == best.distance_sq && triangle >= best.triangle) || !accept(triangle))
        continue;
      best = found;
      best.triangle = triangle;
    }
  }
};

}  // namespace isoshell
