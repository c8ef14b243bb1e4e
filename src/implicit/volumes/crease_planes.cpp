#include "implicit/volumes/crease_planes.h"

#include <cmath>

#include "geometry/world_vector.h"
#include "implicit/volumes/linear_fit.h"
#include "implicit/volumes/sharpened_field.h"

namespace isoshell {
namespace {

constexpr double kBent = 0.02;           // bend of a cell near a crease
constexpr double kNear = 1.3;            // voxels from the surface: farther off, distances end and are bent there
constexpr double kStraight = 0.02;       // bend of a cell whose plane is believed: of a sphere of 12 voxels' radius
constexpr double kNearlyStraight = 0.1;  // the same where there is no other
constexpr int kReach = 3;                // voxels around a block
constexpr int kSide = kFieldBlock + 2 * kReach;
constexpr int kWideStride[3] = {kSide * kSide, kSide, 1};
constexpr double kLeastFacing = 0.01;   // cosine between a plane's normal and the edge that crosses it
constexpr double kMostBeyond = 0.05;    // of a plane from the end of the edge
constexpr int kMostSides = 3;           // that meet near an edge
constexpr double kSameSide = 0.95;      // cosine
constexpr double kFarthest = 2.5;       // voxels from the crossing to where the plane touches the surface
constexpr double kFarthestOfPoint = 3;  // voxels from a lattice point to where a plane touches the surface
constexpr double kMostFilled = 1.3;     // voxels from the surface
constexpr double kLeastFilled = 0.02;   // voxels
constexpr double kFarPerShift = 2;  // how much farther that may be where the plane is a voxel nearer to interpolation
constexpr double kFarPerBend = 50;  // the same of a plane from a straighter cell

/// The plane of a nearly straight cell, in the block's coordinates.
struct CellPlane {
  bool is_known = false, is_bent = false;
  double bend = 0;
  WorldPoint normal{0, 0, 0}, foot{0, 0, 0};
};

class CreasePlanes {
 public:
  CreasePlanes(const ScalarField& field, Inside inside, double rise, Voxel block)
      : field_(field), inside_(inside), rise_(rise), block_(block) {}

  /// Points inside whose distances from the sides of a hollow crease are outside.
  std::vector<PointValue> find_filled() {
    std::vector<PointValue> found;
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field_, block_, window);
    for (int offset = 0; offset < 512; ++offset) {
      const float value = window[window_index(offset)];
      if (!inside_(value) || std::abs(value - inside_.iso) > kMostFilled * rise_) continue;
      if (value_.empty()) read_wide();
      const int p[3] = {offset >> 6, offset >> 3 & 7, offset & 7};
      if (!is_beside_bent(p)) continue;
      const double off = hollow_distance(p);
      if (off > -std::abs(value - inside_.iso) / rise_ + kLeastFilled)
        found.push_back({uint16_t(offset), float(inside_.iso + (inside_.below ? 1 : -1) * off * rise_)});
    }
    return found;
  }

  std::vector<CreaseCrossing> find() {
    std::vector<CreaseCrossing> found;
    float window[kWindow * kWindow * kWindow];
    read_cell_window(field_, block_, window);
    for (int axis = 0; axis < 3; ++axis)
      for (int offset = 0; offset < 512; ++offset) {
        const float* at = window + window_index(offset);
        const bool starts_inside = inside_(*at);
        if (starts_inside == inside_(at[kWindowStride[axis]])) continue;
        if (value_.empty()) read_wide();
        const int p[3] = {offset >> 6, offset >> 3 & 7, offset & 7};
        if (!is_near_bent(axis, p)) continue;
        const double place = std::clamp(crossing_on_edge(at[0], at[kWindowStride[axis]], inside_.iso), kCreaseEdgeEnd,
                                        1 - kCreaseEdgeEnd);
        found.push_back(cross_at(axis, p, place, starts_inside));
      }
    return found;
  }

 private:
  void read_wide() {
    value_.resize(size_t(kSide * kSide * kSide));
    plane_.resize(value_.size());
    float part[kWindow * kWindow * kWindow];
    int step[3];
    for (step[0] = -1; step[0] < 2; ++step[0])
      for (step[1] = -1; step[1] < 2; ++step[1])
        for (step[2] = -1; step[2] < 2; ++step[2]) {
          int size[3], skip[3], to = 0;
          for (int a = 0; a < 3; ++a) {
            size[a] = step[a] > 0 ? kReach : kFieldBlock;
            skip[a] = step[a] < 0 ? kFieldBlock - kReach : 0;
            to += (kFieldBlock * step[a] + skip[a] + kReach) * kWideStride[a];
          }
          field_.copy(plus(block_, kFieldBlock * step[0], kFieldBlock * step[1], kFieldBlock * step[2]), size, part);
          for (int x = skip[0]; x < size[0]; ++x)
            for (int y = skip[1]; y < size[1]; ++y)
              for (int z = skip[2]; z < size[2]; ++z)
                value_[size_t(to + (x - skip[0]) * kWideStride[0] + (y - skip[1]) * kWideStride[1] + z - skip[2])] =
                    part[x * kWindowStride[0] + y * kWindowStride[1] + z];
        }
  }

  const CellPlane& plane_of(int x, int y, int z) {
    const size_t at =
        size_t((x + kReach) * kWideStride[0] + (y + kReach) * kWideStride[1] + (z + kReach) * kWideStride[2]);
    CellPlane& plane = plane_[at];
    if (plane.is_known) return plane;
    const LinearFit fit = fit_cell(&value_[at], kWideStride);
    plane.is_known = true;
    plane.bend = fit.bend(rise_);
    plane.is_bent = plane.bend >= kBent && std::abs(fit.mean - inside_.iso) < kNear * rise_;
    if (!(plane.bend < kNearlyStraight)) return plane;
    const double outward = (inside_.below ? 1 : -1) / fit.rise();
    plane.normal = outward * WorldPoint{fit.slope[0], fit.slope[1], fit.slope[2]};
    plane.foot = WorldPoint{x + .5, y + .5, z + .5} - (outward * (fit.mean - inside_.iso)) * plane.normal;
    return plane;
  }

  /// Whether one of the four cells around an edge, or of the cells beside these, is.
  bool is_near_bent(int axis, const int p[3]) {
    int low[3], cell[3];
    for (int a = 0; a < 3; ++a) low[a] = p[a] - (a == axis ? 1 : 2);
    for (cell[0] = low[0]; cell[0] <= p[0] + 1; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= p[1] + 1; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= p[2] + 1; ++cell[2])
          if (plane_of(cell[0], cell[1], cell[2]).is_bent) return true;
    return false;
  }

  bool is_beside_bent(const int p[3]) {
    for (int c = 0; c < 8; ++c)
      if (plane_of(p[0] - (c >> 2), p[1] - (c >> 1 & 1), p[2] - (c & 1)).is_bent) return true;
    return false;
  }

  /// How far a point is outside of all sides of a hollow crease near it; far inside where there is none.
  double hollow_distance(const int p[3]) {
    const WorldPoint at{double(p[0]), double(p[1]), double(p[2])};
    candidates_.clear();
    int cell[3];
    for (cell[0] = p[0] - kReach; cell[0] < p[0] + kReach; ++cell[0])
      for (cell[1] = p[1] - kReach; cell[1] < p[1] + kReach; ++cell[1])
        for (cell[2] = p[2] - kReach; cell[2] < p[2] + kReach; ++cell[2]) {
          const CellPlane& plane = plane_of(cell[0], cell[1], cell[2]);
          if (!(plane.bend < kStraight)) continue;
          const double far = length(at - plane.foot);
          if (far <= kFarthestOfPoint) candidates_.push_back({&plane, 0, far + kFarPerBend * plane.bend});
        }
    Side sides[kMostSides];
    int count = 0;
    while (count < kMostSides && !candidates_.empty()) sides[count++] = take_side();
    double farthest = -kFarthestOfPoint;
    for (int i = 0; i < count; ++i) {
      double off = dot(sides[i].normal, at - sides[i].foot);
      bool is_hollow = false;
      for (int j = 0; j < count; ++j) {
        if (j == i || is_convex(sides[i], sides[j])) continue;
        is_hollow = true;
        off = std::min(off, dot(sides[j].normal, at - sides[j].foot));
      }
      if (is_hollow) farthest = std::max(farthest, off);
    }
    return farthest;
  }

  CreaseCrossing cross_at(int axis, const int p[3], double place, bool starts_inside) {
    CreaseCrossing crossing{uint16_t(axis << 9 | p[0] << 6 | p[1] << 3 | p[2]), false, place, {0, 0, 0}, 0};
    const WorldPoint start{double(p[0]), double(p[1]), double(p[2])};
    const WorldPoint along{double(axis == 0), double(axis == 1), double(axis == 2)};
    list_candidates(axis, p, place, starts_inside, kStraight);
    if (candidates_.empty()) list_candidates(axis, p, place, starts_inside, kNearlyStraight);
    Side side;
    for (int n = 0; n < kMostSides && !candidates_.empty(); ++n) {
      Side next = take_side();
      next.place = dot(next.normal, next.foot - start) / dot(next.normal, along);
      if (n == 0 || is_hidden_by(side, next, starts_inside)) side = next;
    }
    if (length_sq(side.normal) == 0) return crossing;
    crossing.has_plane = true;
    crossing.normal = side.normal;
    crossing.height = dot(side.normal, side.foot);
    crossing.place = std::clamp(side.place, kCreaseEdgeEnd, 1 - kCreaseEdgeEnd);
    return crossing;
  }

  /// The plane of several cells, and where it crosses an edge, if it is asked for one.
  struct Side {
    WorldPoint normal{0, 0, 0}, foot{0, 0, 0};
    double place = 0;
  };

  /// The plane of the best candidate and of those like it, near ones first; they are no candidates any more.
  Side take_side() {
    const auto by_score = [](const Candidate& a, const Candidate& b) { return a.score < b.score; };
    const WorldPoint best = std::min_element(candidates_.begin(), candidates_.end(), by_score)->plane->normal;
    Side side;
    double weights = 0;
    size_t kept = 0;
    for (const Candidate& c : candidates_) {
      if (dot(c.plane->normal, best) <= kSameSide) {
        candidates_[kept++] = c;
        continue;
      }
      const double weight = 1 / (c.score * c.score * c.score * c.score + 1e-2);
      side.normal = side.normal + weight * c.plane->normal;
      side.foot = side.foot + weight * c.plane->foot;
      weights += weight;
    }
    candidates_.resize(kept);
    side.normal = (1 / length(side.normal)) * side.normal;
    side.foot = (1 / weights) * side.foot;
    return side;
  }

  /// The plane of a cell, and where it crosses an edge, if it is asked for one.
  struct Candidate {
    const CellPlane* plane;
    double place, score;
  };

  void list_candidates(int axis, const int p[3], double place, bool starts_inside, double most_bend) {
    const double outward = starts_inside ? 1 : -1;
    const WorldPoint along{outward * (axis == 0), outward * (axis == 1), outward * (axis == 2)};
    const WorldPoint start{double(p[0]), double(p[1]), double(p[2])};
    candidates_.clear();
    int low[3], cell[3];
    for (int a = 0; a < 3; ++a) low[a] = p[a] - (a == axis ? 2 : 3);
    for (cell[0] = low[0]; cell[0] <= p[0] + 2; ++cell[0])
      for (cell[1] = low[1]; cell[1] <= p[1] + 2; ++cell[1])
        for (cell[2] = low[2]; cell[2] <= p[2] + 2; ++cell[2]) {
          const CellPlane& plane = plane_of(cell[0], cell[1], cell[2]);
          const double facing = dot(plane.normal, along);
          if (!(plane.bend < most_bend) || facing < kLeastFacing) continue;
          const double here = dot(plane.normal, plane.foot - start) / (outward * facing);
          if (std::max(0., std::abs(here - .5) - .5) * facing > kMostBeyond) continue;
          const double far = length(start + (outward * here) * along - plane.foot);
          const double score = far + kFarPerShift * std::abs(here - place) + kFarPerBend * plane.bend;
          if (far <= kFarthest) candidates_.push_back({&plane, here, score});
        }
  }

  /// Around a convex crease the surface is where the first of its sides is met from inside, around a hollow one where
  /// the last is.
  static bool is_hidden_by(const Side& side, const Side& other, bool starts_inside) {
    const bool is_before = (other.place < side.place) == starts_inside;
    return is_convex(side, other) == is_before;
  }
  static bool is_convex(const Side& side, const Side& other) { return dot(side.normal, other.foot - side.foot) < 0; }

  const ScalarField& field_;
  const Inside inside_;
  const double rise_;
  const Voxel block_;
  std::vector<float> value_;      // of the block and kReach points around it
  std::vector<CellPlane> plane_;  // per cell, by its smallest corner
  std::vector<Candidate> candidates_;
};

}  // namespace

std::vector<PointValue> find_filled_points(const ScalarField& field, Inside inside, double rise, Voxel block) {
  return CreasePlanes(field, inside, rise, block).find_filled();
}

std::vector<CreaseCrossing> find_crease_crossings(const ScalarField& field, Inside inside, double rise, Voxel block) {
  return CreasePlanes(field, inside, rise, block).find();
}

}  // namespace isoshell
