// Faces on a lattice of whole steps, and where they come near to each other.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "geometry/box.h"
#include "isoshell/advanced/lattice.h"
#include "repair/holes/repair_mesh.h"
#include "voxel/exact_int.h"

namespace isoshell::repair {

/// Coordinates are from 0 to 2^40, so that a point which is rounded to them stays on its faces but for what is far
/// below the precision of files, also where faces cross at small angles. On these voxel/intersect.h is exact:
/// differences are at most 2^40, cross products 2^81, and volumes below 2^123.
struct StepPoint {
  int64_t x, y, z;
};
struct StepVector {
  int64_t x, y, z;
};
struct Vec128 {
  Int128 x, y, z;
};
inline StepVector difference(StepPoint a, StepPoint b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
inline Vec128 cross(StepVector a, StepVector b) {
  const auto minor = [](int64_t s, int64_t t, int64_t u, int64_t v) { return Int128(s) * v - Int128(t) * u; };
  return {minor(a.y, a.z, b.y, b.z), minor(a.z, a.x, b.z, b.x), minor(a.x, a.y, b.x, b.y)};
}
template <class Vector>
WorldPoint as_world(const Vector& v) {
  return {double(v.x), double(v.y), double(v.z)};
}

/// Positions of files are exact to this many steps or more: what is made one, and what is called flat, is given in it.
constexpr int kFineBits = 12;
constexpr double kFine = 1 << kFineBits;

/// In cells of kFine steps, whose numbers have 32 bits, around all of it.
inline BoxQ8 coarse(const BoxOf<StepPoint>& box) {
  const auto cell = [](const StepPoint& p) {
    return PointQ8{int32_t(p.x >> kFineBits), int32_t(p.y >> kFineBits), int32_t(p.z >> kFineBits)};
  };
  return {cell(box.min), cell(box.max)};
}

/// Along a direction; none at first.
struct Range {
  double least = HUGE_VAL, most = -HUGE_VAL;

  void add(double x) { least = std::min(least, x), most = std::max(most, x); }
  double length() const { return most - least; }
  bool is_apart(const Range& o, double by) const { return least > o.most + by || o.least > most + by; }
};

/// Ends of an edge, smaller one first.
using Ends = std::array<uint32_t, 2>;
constexpr Ends kNoEnds = {kNoFace, kNoFace};
inline Ends ends_of(uint32_t a, uint32_t b) { return a < b ? Ends{a, b} : Ends{b, a}; }
/// In the order of the two, and quicker to compare.
inline uint64_t key_of(const std::array<uint32_t, 2>& two) { return uint64_t(two[0]) << 32 | two[1]; }
/// Edge i of a face runs from corner i to the next one.
inline Ends edge_of(const Corners& f, size_t i) { return ends_of(f[i], f[(i + 1) % 3]); }
inline bool has_corner(const Corners& f, uint32_t v) { return f[0] == v || f[1] == v || f[2] == v; }

constexpr double kLateReachSteps = 3;  // where what is near without meeting stays as it is

struct LatticeFaces {
  std::vector<StepPoint> point;
  std::vector<Corners> face;
  std::vector<uint32_t> source;       ///< per face
  std::vector<uint8_t> is_unsettled;  ///< per face: what it meets is still to be found
  double reach_steps = 128 * kFine;   ///< a point is on an edge or a face, and edges meet, within that
  bool leaves_near_edges = false;     ///< edges within reach stay as they are where their faces do not meet
  bool leaves_near = false;           ///< what is within reach without meeting stays as it is

  double weld_steps() const { return 2 * reach_steps; }  ///< points are one within that
};

/// A point that belongs in the edges and the inside of a face that are named, since two faces meet there.
struct Contact {
  std::array<uint32_t, 2> pair;                   ///< the faces; twice one that is too low to be a triangle
  std::array<Ends, 2> edge = {kNoEnds, kNoEnds};  ///< in order
  uint32_t face = kNoFace;                        ///< in whose inside it is
  uint32_t point = kNoFace;                       ///< a corner; kNoFace: a new one
  StepPoint at{0, 0, 0};                          ///< of a new one
};

struct Contacts {
  std::vector<Contact> found;
  std::vector<Ends> close;                        ///< points that are to be one
  std::vector<uint32_t> near_close;               ///< faces at those
  std::vector<std::array<uint32_t, 2>> crossing;  ///< faces that intersect though they have no contact
  int64_t pairs = 0;                              ///< of faces that were looked at

  /// To find a contact and cut its faces takes as long as this many pairs.
  int64_t work() const { return pairs + 256 * int64_t(found.size()); }
};

}  // namespace isoshell::repair
