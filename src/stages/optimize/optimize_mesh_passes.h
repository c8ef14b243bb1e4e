// Lloyd relaxation on the mesh itself: edges that are not Delaunay flip, and every vertex goes past the centre of its
// Voronoi cell among the triangles around it. Noise that fades lets irregular vertices meet and cancel out. A pass
// costs a tenth of one on the sheet, but leaves the surface by little each time: vertices return to it every few
// passes.
#pragma once

#include "stages/halfedge/planes.h"
#include "stages/optimize/optimize_flips.h"
#include "stages/optimize/optimize_size.h"
#include "stages/sheet/sheet_walk.h"
#include "voxel/random.h"

namespace isoshell::optimize {

constexpr double kMeshPastCentre = 1.3;  ///< as relax_sheet::past_centre
constexpr double kMeshMomentum = 0.8;    ///< part of the last move that is added
constexpr double kMostMeshMove = 0.3;    ///< edges a pass
constexpr double kMeshHold = 64;         ///< to the planes of triangles, so that tips and rims are not worn down
// Vertices at rims and tips stay, which only cells on the sheet hold there: nothing of a mesh pulls them outwards.
// Least length of the mean of the unit normals around the others.
constexpr double kRimNormal = 0.8;
constexpr double kNoisyShare = 0.75;                ///< of the passes; then noise has faded, and the rest is without
constexpr int32_t kMeshPassesOffSheet = 8;          ///< between returns to the surface
constexpr int32_t kPassesPerFlip = 4;               ///< every so many passes edges flip, in one independent set
constexpr double kLeastBeyondDelaunay = 1.0 / 256;  ///< sum of cotangents below 0; so that no edge flips to and fro

/// What a triangle has of the cell of one of its corners: area, and first moment about the corner.
struct CellPart {
  double area, x, y, z;
};
/// A triangle as Voronoi cells see it.
struct TriangleCells {
  CellPart part[3];     ///< by corner
  double cotangent[3];  ///< of the angle opposite to the half-edge that leaves the corner
  Vector normal;        ///< of length 1, or 0 without area
};

/// Of the triangle with corners at 0, b and c. Where it is obtuse its parts meet in the middle of the longest edge in
/// place of the circumcentre. Choices are between two values, so that compilers can take many triangles at a time.
ISOSHELL_HD inline TriangleCells cells_of_triangle(Vector b, Vector c) {
  TriangleCells out;
  const Vector normal = cross(b, c);
  const double bb = dot(b, b), cc = dot(c, c), at_a = dot(b, c), at_b = bb - at_a, at_c = cc - at_a,
               aa = at_b + at_c;  // squares of edges, and products of the edges at each corner
  const double area2_sq = dot(normal, normal), area2 = rounded_sqrt(area2_sq > 0 ? area2_sq : 1);
  const double inverse = area2_sq > 0 ? 1 / area2 : 0, eighth = area2_sq > 0 ? area2 / 8 : 0;
  const double cot_a = at_a * inverse, cot_b = at_b * inverse, cot_c = at_c * inverse;
  const bool wide_a = at_a < 0, wide_b = at_b < 0, wide_c = at_c < 0, acute = !wide_a && !wide_b && !wide_c;
  // Areas of the right triangles on both halves of each edge, whose tip is the circumcentre along_b b + along_c c.
  const double on_ab = acute ? bb * cot_c / 8 : (wide_c ? 0 : eighth),
               on_bc = acute ? aa * cot_a / 8 : (wide_a ? 0 : eighth),
               on_ca = acute ? cc * cot_b / 8 : (wide_b ? 0 : eighth);
  const double half_sq = 0.5 * inverse * inverse;
  const double along_b = acute ? cc * at_b * half_sq : (wide_b ? 0 : 0.5),
               along_c = acute ? bb * at_c * half_sq : (wide_c ? 0 : 0.5);
  const Vector tip = along_b * b + along_c * c;
  const double third = 1.0 / 3, sixth = 1.0 / 6;
  const double of_a = on_ab + on_ca, of_b = on_ab + on_bc, of_c = on_bc + on_ca;
  const Vector bc = c - b;
  const Vector first_a = (sixth * on_ab) * b + (sixth * on_ca) * c + (third * of_a) * tip;
  const Vector first_b = (sixth * on_bc) * bc - (sixth * on_ab) * b + (third * of_b) * (tip - b);
  const Vector first_c = (third * of_c) * (tip - c) - (sixth * on_bc) * bc - (sixth * on_ca) * c;
  out.part[0] = {of_a, first_a.x, first_a.y, first_a.z};
  out.part[1] = {of_b, first_b.x, first_b.y, first_b.z};
  out.part[2] = {of_c, first_c.x, first_c.y, first_c.z};
  out.normal = inverse * normal;
  out.cotangent[0] = cot_c, out.cotangent[1] = cot_a, out.cotangent[2] = cot_b;
  return out;
}

struct MeshPassOptions {
  int32_t passes = 0;
  double noise_edges = 0;  ///< largest at first, along each axis
};

/// Three lists of positions that take turns: a pass goes from one to the next. By name, since compilers for devices
/// keep what is indexed by a variable in memory.
struct PositionTurns {
  View<PointQ8> first, second, third;
  ISOSHELL_HD View<PointQ8> at(int32_t pass) const {
    const int32_t turn = pass % 3;
    return turn == 0 ? first : (turn == 1 ? second : third);
  }
};

/// All that passes read and write.
struct MeshPasses {
  MeshView mesh;
  WalkOntoSheet walk;
  FixedView fixed;
  EdgeSize size;
  MeshPassOptions options;
  PositionTurns position;
  View<uint32_t> home;
  View<uint64_t> claim;    ///< by vertex; 0 between passes
  View<CellPart> part;     ///< by half-edge, of its start
  View<double> cotangent;  ///< by half-edge, of the angle opposite
  View<Vector> normal;     ///< by triangle

  ISOSHELL_HD View<PointQ8> from(int32_t pass) const { return position.at(pass); }
  ISOSHELL_HD View<PointQ8> to(int32_t pass) const { return position.at(pass + 1); }
  ISOSHELL_HD View<PointQ8> before(int32_t pass) const { return position.at(pass + 2); }
  /// The last pass and every few others before it.
  ISOSHELL_HD bool returns(int32_t pass) const { return (options.passes - 1 - pass) % kMeshPassesOffSheet == 0; }
  ISOSHELL_HD static bool flips(int32_t pass) { return pass % kPassesPerFlip == 0; }
  ISOSHELL_HD double noise_q8(int32_t pass) const {
    const double faded = double(pass) / (kNoisyShare * double(options.passes));
    return faded < 1 ? options.noise_edges * size.edge_q8 * (1 - faded) : 0;
  }
  /// By the lengths that edges are to have there, where they vary: what a corner has is weighed by their fourth power
  /// at a place between it and the middle of the triangle. There linear weights give the centre of a regular cell.
  ISOSHELL_HD void weigh(TriangleIndices t, TriangleCells& cells) const {
    if (!size.lengths.vary()) return;
    constexpr double kToMiddle = 0.712;
    const double ratio[3] = {size.ratio(home[t.a]), size.ratio(home[t.b]), size.ratio(home[t.c])};
    const double middle = (ratio[0] + ratio[1] + ratio[2]) / 3;
    for (int k = 0; k < 3; ++k) {
      const double there = (1 - kToMiddle) * ratio[k] + kToMiddle * middle, square = there * there,
                   weight = 1 / (square * square);
      CellPart& p = cells.part[k];
      p = {weight * p.area, weight * p.x, weight * p.y, weight * p.z};
    }
  }
  ISOSHELL_HD void take(uint32_t triangle, TriangleCells cells) const {
    weigh(mesh.triangles[triangle], cells);
    for (uint32_t k = 0; k < 3; ++k) {
      part[3 * triangle + k] = cells.part[k];
      cotangent[3 * triangle + k] = cells.cotangent[k];
    }
    normal[triangle] = cells.normal;
  }
  ISOSHELL_HD void measure(uint32_t triangle, View<const PointQ8> at) const {
    const TriangleIndices t = mesh.triangles[triangle];
    take(triangle, cells_of_triangle(from_to(at[t.a], at[t.b]), from_to(at[t.a], at[t.c])));
  }
};

struct MeasureCells {
  MeshPasses passes;
  int32_t pass;
  ISOSHELL_HD void operator()(int64_t t) const { passes.measure(uint32_t(t), passes.from(pass)); }
};

/// Flips of edges that are not Delaunay, each with a key: the worst first, then the smaller half-edge.
struct DelaunayKey {
  MeshView mesh;
  FixedView fixed;
  View<const double> cotangent;
  View<const PointQ8> position;

  /// Whether an edge is not Delaunay, asked of one of its half-edges.
  ISOSHELL_HD bool is_beyond(uint32_t h) const {
    const uint32_t g = mesh.twin[h];
    return g != kNone && h < g && -(cotangent[h] + cotangent[g]) > kLeastBeyondDelaunay;
  }
  /// By half-edge; 0 for Delaunay edges, for those of borders, and where a flip would harm the mesh.
  ISOSHELL_HD uint64_t operator()(uint32_t h) const {
    if (!is_beyond(h)) return 0;
    const uint32_t g = mesh.twin[h];
    const double beyond = -(cotangent[h] + cotangent[g]);
    const uint32_t a = mesh.from(h), b = mesh.to(h), c = mesh.opposite(h), d = mesh.opposite(g);
    if (is_spent(a) || is_spent(b) || mesh.are_neighbours(c, d) || !fixed.may_join(mesh, c, d)) return 0;
    const PointQ8 pa = position[a], pb = position[b], pc = position[c], pd = position[d];
    const Vector before = normal_of(pa, pb, pc) + normal_of(pb, pa, pd);
    if (!within_45_degrees(before, normal_of(pa, pd, pc)) || !within_45_degrees(before, normal_of(pd, pb, pc)))
      return 0;
    const double grade = beyond * 256;
    return uint64_t(grade < 2e9 ? uint32_t(grade) : 2000000000u) << 32 | (0xffffffffu - h);
  }

 private:
  /// Whether a vertex has no edge to lose.
  ISOSHELL_HD bool is_spent(uint32_t v) const { return int32_t(mesh.valence[v]) - fixed.even_valence(v) <= -2; }
};
ISOSHELL_HD inline DelaunayKey delaunay_key(const MeshPasses& passes, int32_t pass) {
  return {passes.mesh, passes.fixed, passes.cotangent, passes.from(pass)};
}

struct MarkWinner {
  WinsItsVertices<DelaunayKey> winner;
  View<uint32_t> wins;
  ISOSHELL_HD void operator()(int64_t h) const { wins[h] = winner(h) ? 1u : 0u; }
};
/// Flips an edge, and measures its triangles anew.
struct FlipInPass {
  MeshPasses passes;
  int32_t pass;
  ISOSHELL_HD void operator()(uint32_t h) const {
    const uint32_t other = passes.mesh.twin[h] / 3;
    flip_edge(passes.mesh, h);
    passes.measure(h / 3, passes.from(pass));
    passes.measure(other, passes.from(pass));
  }
};
struct FlipMarked {
  FlipInPass flip;
  View<const uint32_t> wins;
  ISOSHELL_HD void operator()(int64_t h) const {
    if (wins[h]) flip(uint32_t(h));
  }
};

/// Past the centre of its cell along the mesh.
struct MoveInRing {
  MeshPasses passes;
  int32_t pass;
  double noise_q8;

  ISOSHELL_HD void operator()(int64_t v) const {
    passes.claim[v] = 0;
    const PointQ8 p = passes.from(pass)[v];
    passes.to(pass)[v] = passes.fixed.is_fixed(uint32_t(v)) ? p : target(uint32_t(v), p);
  }

 private:
  ISOSHELL_HD PointQ8 target(uint32_t v, PointQ8 p) const {
    CellPart cell = {0, 0, 0, 0};
    Vector normal = {0, 0, 0};
    PlanesAround planes;
    for_each_half_edge_around(passes.mesh, v, [&](uint32_t h) {
      const CellPart part = passes.part[h];
      cell.area += part.area, cell.x += part.x, cell.y += part.y, cell.z += part.z;
      const Vector n = passes.normal[h / 3];
      normal = normal + n;
      planes.sum.add(1, n);
    });
    const double length_sq = dot(normal, normal), triangles = planes.sum.xx + planes.sum.yy + planes.sum.zz;
    if (length_sq < kRimNormal * kRimNormal * triangles * triangles) return p;
    Vector move = kMeshMomentum * from_to(pass > 0 ? passes.before(pass)[v] : p, p);
    if (cell.area > 0) move = move + (kMeshPastCentre / cell.area) * Vector{cell.x, cell.y, cell.z};
    const double edges = passes.size.ratio(passes.home[v]);
    if (noise_q8 > 0) move = move + (edges * noise_q8) * noise(v);
    move = planes.holding(kMeshHold).solve(move);
    if (length_sq > 0) move = move - (dot(move, normal) / length_sq) * normal;
    return moved_by(p, at_most(move, kMostMeshMove * edges * passes.size.edge_q8));
  }
  /// Each component from -1 to 1.
  ISOSHELL_HD Vector noise(uint32_t v) const {
    const uint64_t bits = random_bits(uint64_t(pass), v);
    const auto part = [&](int shift) { return double(int32_t(bits >> shift & 0x1fffff) - 0x100000) / 0x100000; };
    return {part(0), part(21), part(42)};
  }
};
struct ReturnOntoSheet {
  MeshPasses passes;
  int32_t pass;
  ISOSHELL_HD bool aims(int64_t v, PointQ8& target) const {
    target = passes.to(pass)[v];
    return !passes.fixed.is_fixed(uint32_t(v));
  }
  ISOSHELL_HD void arrives(int64_t v, uint32_t vertex, PointQ8 p) const {
    passes.home[v] = vertex;
    passes.to(pass)[v] = p;
  }
};

/// All passes, one after the other.
struct PlainMeshPasses {
  template <class Exec>
  static void run(Exec& exec, const MeshPasses& passes) {
    const int64_t vertices = passes.home.size, half_edges = passes.mesh.twin.size;
    Buffer<uint32_t> wins = exec.template make<uint32_t>(half_edges);
    exec.fill(passes.claim, uint64_t(0));
    for (int32_t pass = 0; pass < passes.options.passes; ++pass) {
      exec.for_each("measure cells", half_edges / 3, MeasureCells{passes, pass});
      if (passes.flips(pass)) {
        const DelaunayKey key = delaunay_key(passes, pass);
        exec.for_each("claim flips", half_edges, ClaimVertices{key, passes.claim});
        exec.for_each("mark flips", half_edges, MarkWinner{{key, passes.claim}, wins.view()});
        exec.for_each("flip edges", half_edges, FlipMarked{{passes, pass}, wins.view()});
      }
      exec.for_each("move in ring", vertices, MoveInRing{passes, pass, passes.noise_q8(pass)});
      if (passes.returns(pass))
        Exec::Kernels::Walks::to_targets(exec, "return onto sheet", passes.walk, passes.home,
                                         ReturnOntoSheet{passes, pass});
    }
  }
};

}  // namespace isoshell::optimize
