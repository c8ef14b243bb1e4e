// Polygons into triangles: ear clipping in the polygon's own best plane.
#pragma once

#include <cstdint>
#include <vector>

#include "io/faces/reflex_corners.h"
#include "isoshell/surface_source.h"

namespace isoshell {

/// Splits one polygon after another, keeping its memory.
class PolygonSplitter {
 public:
  /// Appends count - 2 triangles (fewer where a corner repeats) with the polygon's orientation.
  /// Result: depends on the polygon alone, not on the corner it starts at. Convex quads are cut along the shorter
  /// diagonal (tie: the one with the smallest index); otherwise the ear with the shortest diagonal goes first (tie:
  /// smallest index). Where no ear is left (zero area, self-crossing), a fan from the smallest index takes the rest.
  /// `corners` are in range of `vertices`, finite, and no corner equals the one after it; count >= 3.
  /// Cost: O(n log n) for convex polygons, O(n sqrt n) for most others, O(n^2) at worst.
  void split(const WorldPoint* vertices, const uint32_t* corners, int64_t count,
             std::vector<std::array<uint32_t, 3>>& triangles);

 private:
  struct Ear {
    double diagonal_sq;
    uint32_t id;       // vertex index, decides ties
    uint32_t corner;   // place in the polygon
    uint32_t version;  // stale when the corner has changed since
  };
  static bool later(const Ear& a, const Ear& b);

  bool project(const WorldPoint* vertices);
  bool split_convex_quad(const WorldPoint* vertices, std::vector<std::array<uint32_t, 3>>& triangles) const;
  double turn(uint32_t a, uint32_t b, uint32_t c) const { return doubled_area(at_[a], at_[b], at_[c]); }
  bool is_ear(uint32_t corner) const;
  void look_at(const WorldPoint* vertices, uint32_t corner);
  void clip_ears(const WorldPoint* vertices, std::vector<std::array<uint32_t, 3>>& triangles);
  void emit(uint32_t a, uint32_t b, uint32_t c, std::vector<std::array<uint32_t, 3>>& triangles) const;

  std::vector<uint32_t> ids_;  // corners, rotated to start at the smallest index
  std::vector<PlanePosition> at_;
  std::vector<uint32_t> previous_, next_, version_;
  ReflexCorners reflex_;   // corners that were not convex at first
  std::vector<Ear> ears_;  // heap, shortest diagonal on top
};

}  // namespace isoshell
