// Chords: edges that cross a groove or a ridge far from its bottom or crest. Moves of vertices cannot repair them;
// flipped, they run along it.
#pragma once

#include "stages/optimize/optimize_flips.h"
#include "stages/optimize/optimize_samples.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell::optimize {

constexpr double kFarTriangle = 0.15;  ///< edges; samples farther from their triangle show where chords may be
constexpr double kFarChord = 0.25;     ///< of an edge's length; one that is nearer to the surface is none
constexpr double kNearer = 0.8;        ///< part of the distance that may be left after the flip
constexpr double kChordQuality = 0.7;  ///< least of the triangles that a flip makes: the fit that follows repairs them

struct MarkFarTriangles {
  View<const FitSample> sample;
  View<const int64_t> rest_sq;
  double far_q8;
  View<uint32_t> far;
  ISOSHELL_HD void operator()(int64_t i) const {
    if (double(rest_sq[i]) > far_q8 * far_q8) atomic_or(far[sample[i].triangle], 1u);
  }
};

/// Largest distances in q8 between the surface and the two triangles of an edge, as they are and flipped: by half-edge,
/// the smaller one of its edge. 0 where nothing is far.
struct ChordGaps {
  View<uint32_t> now, flipped;
};
/// Of the samples of triangles that are far, or whose neighbours are.
struct MeasureSamples {
  MeshView mesh;
  View<const PointQ8> position;
  View<const FitSample> sample;
  View<const uint32_t> far;
  ChordGaps gaps;
  ISOSHELL_HD void operator()(int64_t i) const {
    const FitSample s = sample[i];
    if (s.triangle == kNone) return;
    for (uint32_t h = 3 * s.triangle; h < 3 * s.triangle + 3; ++h) {
      const uint32_t g = mesh.twin[h];
      if (mesh.is_border(h)) continue;
      if (!far[h / 3] && !far[g / 3]) continue;
      const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g), edge = h < g ? h : g;
      atomic_max(gaps.now[edge], nearer_of(s.position, {a, b, c}, {b, a, d}));
      atomic_max(gaps.flipped[edge], nearer_of(s.position, {a, d, c}, {d, b, c}));
    }
  }

 private:
  ISOSHELL_HD uint32_t nearer_of(PointQ8 q, TriangleIndices s, TriangleIndices t) const {
    const Vector to_s = foot_on_triangle(q, position[s.a], position[s.b], position[s.c]).rest,
                 to_t = foot_on_triangle(q, position[t.a], position[t.b], position[t.c]).rest;
    const double first = dot(to_s, to_s), second = dot(to_t, to_t);
    return uint32_t(rounded_sqrt(first < second ? first : second));
  }
};
/// Of the middles of the edge and of the one that would replace it: what spans a groove is farther from its bottom than
/// any sample is from the triangles that lead into it.
struct MeasureMiddles {
  MeshView mesh;
  WalkOntoSheet walk;
  View<const PointQ8> position;
  View<const uint32_t> home;
  ChordGaps gaps;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t h = uint32_t(i);
    if (gaps.now[h] == 0) return;
    raise(gaps.now[h], off_sheet(mesh.from(h), mesh.to(h)));
    raise(gaps.flipped[h], off_sheet(mesh.opposite(h), mesh.opposite(mesh.twin[h])));
  }

 private:
  ISOSHELL_HD static void raise(uint32_t& gap, uint32_t to) { gap = gap > to ? gap : to; }
  ISOSHELL_HD uint32_t off_sheet(uint32_t u, uint32_t v) const {
    const PointQ8 p = position[u], q = position[v], middle = {(p.x + q.x) / 2, (p.y + q.y) / 2, (p.z + q.z) / 2};
    const int64_t from_u = off_sheet_sq(home[u], middle), from_v = off_sheet_sq(home[v], middle);
    return uint32_t(isqrt(uint64_t(from_u < from_v ? from_u : from_v)));
  }
  ISOSHELL_HD int64_t off_sheet_sq(uint32_t start, PointQ8 q) const {
    return distance_sq_q16(q, walk.closest_around(walk.nearest_vertex(start, q), q));
  }
};

/// Flips of chords, each with a key: larger gain first, then the smaller half-edge.
struct ChordKey {
  MeshView mesh;
  View<const PointQ8> position;
  ChordGaps gaps;
  FixedView fixed;

  /// By half-edge. 0 when the edge is no chord, or when its flip would gain little or harm the mesh: a vertex of
  /// valence 4 on a smooth place cannot have good triangles.
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    const uint32_t g = mesh.twin[h], now = gaps.now[h], flipped = gaps.flipped[h];
    if (g < h || now == 0 || double(flipped) > kNearer * double(now)) return 0;
    const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    const double length_sq = double(distance_sq_q16(position[a], position[b]));
    if (double(now) * double(now) <= kFarChord * kFarChord * length_sq) return 0;
    if (is_sparse(a) || is_sparse(b) || mesh.are_neighbours(c, d) || !fixed.may_join(mesh, c, d)) return 0;
    return makes_fair(position[a], position[b], position[c], position[d])
               ? uint64_t(now - flipped) << 32 | (0xffffffffu - h)
               : 0;
  }

 private:
  ISOSHELL_HD bool is_sparse(uint32_t v) const { return int32_t(mesh.valence[v]) < fixed.even_valence(v); }
  /// Whether (a, d, c) and (d, b, c) are good enough, and neither turns over.
  ISOSHELL_HD static bool makes_fair(PointQ8 a, PointQ8 b, PointQ8 c, PointQ8 d) {
    const Vector before = normal_of(a, b, c) + normal_of(b, a, d);
    return dot(before, normal_of(a, d, c)) > 0 && dot(before, normal_of(d, b, c)) > 0 &&
           quality_of(a, d, c) >= kChordQuality && quality_of(d, b, c) >= kChordQuality;
  }
};

}  // namespace isoshell::optimize
