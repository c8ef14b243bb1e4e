// A search for better places for the corners of poor triangles: compass points in the tangent plane, in independent
// sets.
#pragma once

#include "stages/halfedge/half_edges.h"
#include "stages/halfedge/planes.h"
#include "stages/halfedge/triangle_shape.h"
#include "stages/optimize/optimize_size.h"
#include "stages/sheet/sheet_walk.h"
#include "voxel/random.h"

namespace isoshell::optimize {

struct MarkPoor {
  View<const TriangleIndices> triangles;
  View<const PointQ8> position;
  double least_quality;
  int64_t locked;  ///< the first vertices, so many, are never poor: they stay where they are
  View<uint32_t> poor;
  ISOSHELL_HD void operator()(int64_t t) const {
    const TriangleIndices i = triangles[t];
    if (quality_of(position[i.a], position[i.b], position[i.c]) >= least_quality) return;
    mark(i.a);
    mark(i.b);
    mark(i.c);
  }

 private:
  ISOSHELL_HD void mark(uint32_t v) const {
    if (v >= locked) atomic_or(poor[v], 1u);
  }
};
struct MarkPoorAround {
  MeshView mesh;
  View<const uint32_t> vertices;
  MarkPoor mark;
  ISOSHELL_HD void operator()(int64_t i) const {
    for_each_half_edge_around(mesh, vertices[i], [&](uint32_t h) { mark(h / 3); });
  }
};
struct IsPoor {
  View<const uint32_t> poor;
  ISOSHELL_HD bool operator()(int64_t v) const { return poor[v] != 0; }
};
/// A poor vertex moves in a round when none of its poor neighbours drew a larger number.
struct MayMove {
  MeshView mesh;
  View<const uint32_t> poor;
  uint64_t round;
  ISOSHELL_HD bool operator()(int64_t v) const {
    if (!poor[v]) return false;
    const uint64_t mine = random_bits(round, uint64_t(v));
    bool largest = true;
    for_each_neighbour(mesh, uint32_t(v), [&](uint32_t b) {
      if (!poor[b]) return;
      const uint64_t other = random_bits(round, b);
      if (other > mine || (other == mine && b > uint32_t(v))) largest = false;
    });
    return largest;
  }
};
struct SearchVertex {
  MeshView mesh;
  WalkOntoSheet walk;
  View<const uint32_t> chosen;
  EdgeSize edge;
  double hold;    ///< how much places are held to the planes of the triangles
  int32_t round;  ///< odd ones turn the compass by half a point, every fourth one sets it upright
  bool onto_sheet;
  View<PointQ8> position;
  View<uint32_t> home;

  static constexpr int kPlaces = 32;  ///< that are tried: the compass points at four distances

  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t v = chosen[i];
    const PointQ8 p = position[v];
    const Compass compass = compass_at(v);
    const double here = worst_quality(v, p, 0);
    double best = here;
    PointQ8 best_position = p;
    for (int number = 0; number < kPlaces; ++number) {
      const PointQ8 place = place_at(p, compass, number);
      const double quality = worst_quality(v, place, best);
      if (quality > best) best = quality, best_position = place;
    }
    if (best_position == p) return;
    if (!onto_sheet) {
      position[v] = best_position;
      return;
    }
    const uint32_t near = walk.nearest_vertex(home[v], best_position);
    move_onto_sheet(v, near, walk.closest_around(near, best_position), here);
  }

  // The parts of a search.

  struct Compass {
    Vector east, north;
    double farthest_q8;
  };
  ISOSHELL_HD Compass compass_at(uint32_t v) const {
    const PointQ8 p = position[v];
    Vector normal = {0, 0, 0};
    PlanesAround planes;
    for_each_triangle_around(mesh, v, [&](uint32_t b, uint32_t c) {
      const Vector n = normal_of(p, position[b], position[c]);
      normal = normal + n;
      planes.add(n);
    });
    normal = unit(normal);
    const double ax = normal.x * normal.x, ay = normal.y * normal.y, az = normal.z * normal.z;
    const Vector axis = ax <= ay && ax <= az ? Vector{1, 0, 0} : (ay <= az ? Vector{0, 1, 0} : Vector{0, 0, 1});
    const Vector east = unit(cross(axis, normal));
    const Symmetric holding = planes.holding(hold);
    const Vector north = round % 4 == 3 ? normal : cross(normal, east);
    return {holding.solve(east), holding.solve(north), 0.16 * edge.at(home[v])};
  }
  /// The nearer ones come later.
  ISOSHELL_HD PointQ8 place_at(PointQ8 p, const Compass& compass, int number) const {
    const double step = compass.farthest_q8 / double(1 << number / 8);
    return moved_by(p, step * direction(number % 8, compass.east, compass.north));
  }
  /// Least quality of the triangles around v when it moves to q; 0 when one turns over, and anything not above `enough`
  /// as soon as that is known.
  ISOSHELL_HD double worst_quality(uint32_t v, PointQ8 q, double enough) const {
    const PointQ8 p = position[v];
    double worst = 2;
    for_each_triangle_around(mesh, v, [&](uint32_t b, uint32_t c) {
      if (worst <= enough) return;
      const PointQ8 pb = position[b], pc = position[c];
      const double quality = quality_of(q, pb, pc);
      if (quality < worst) worst = quality;
      if (!within_45_degrees(normal_of(p, pb, pc), normal_of(q, pb, pc))) worst = 0;
    });
    return worst;
  }
  /// If that still helps.
  ISOSHELL_HD void move_onto_sheet(uint32_t v, uint32_t near, PointQ8 place, double here) const {
    if (!(worst_quality(v, place, here) > here)) return;
    home[v] = near;
    position[v] = place;
  }

 private:
  /// Eight directions at 45 degrees from one another.
  ISOSHELL_HD Vector direction(int point, Vector east, Vector north) const {
    const bool odd = round % 2 == 1;
    const double major = odd ? 0.9238795325112867 : 1, minor = odd ? 0.3826834323650898 : 0;
    const Vector first = major * east + minor * north, second = major * north - minor * east;
    const Vector diagonal = 0.7071067811865476 * (first + second), other = 0.7071067811865476 * (second - first);
    const Vector d = (point & 3) == 0 ? first : ((point & 3) == 1 ? diagonal : ((point & 3) == 2 ? second : other));
    return point < 4 ? d : -1.0 * d;
  }
};

/// What a search of all poor vertices needs beside the mesh.
struct SearchOptions {
  int rounds;
  double least_quality;  ///< vertices of triangles below it are poor
  EdgeSize edge;
  double hold;  ///< see SearchVertex
  bool onto_sheet;
  int64_t locked;  ///< see MarkPoor
};

/// Looks for better places for poor vertices, in rounds of independent ones. Only poor vertices move, so a triangle
/// that is poor after a round was so before it or has such a vertex: after the first round few are looked at.
struct PlainSearchPositions {
  template <class Exec>
  static void run(Exec& exec, const MeshView& mesh, const WalkOntoSheet& walk, const SearchOptions& options,
                  View<PointQ8> position, View<uint32_t> home, View<uint32_t> poor) {
    const MarkPoor mark{mesh.triangles, position, options.least_quality, options.locked, poor};
    for (int r = 0; r < options.rounds; ++r) {
      if (r == 0) {
        exec.fill(poor, 0u);
        exec.for_each("mark poor", mesh.triangles.size, mark);
      } else {
        const Buffer<uint32_t> before = exec.select(poor.size, IsPoor{poor});
        exec.fill(poor, 0u);
        exec.for_each("mark poor again", before.size(), MarkPoorAround{mesh, before.view(), mark});
      }
      const Buffer<uint32_t> chosen = exec.select(poor.size, MayMove{mesh, poor, uint64_t(r)});
      if (chosen.empty()) return;
      exec.for_each(
          "search", chosen.size(),
          SearchVertex{mesh, walk, chosen.view(), options.edge, options.hold, r, options.onto_sheet, position, home});
    }
  }
};

}  // namespace isoshell::optimize
