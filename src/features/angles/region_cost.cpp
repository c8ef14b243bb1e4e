// What a region costs (see mesh_region.h).
#include <algorithm>
#include <cmath>
#include <numeric>

#include "features/angles/mesh_region.h"

namespace isoshell {
namespace {

constexpr double kGoodSine = 0.587785;  ///< of 36 degrees
constexpr double kCostOfPoor = 0.05;    ///< of any angle below 30 degrees, beside its own
constexpr double kCostOfTurn = 200;     ///< a normal 30 degrees off weighs as much as an angle of 17 degrees
constexpr double kMostOffCurve = 0.03;  ///< edges from the curve to its chord
constexpr double kMuchLess = 0.8;       ///< of the cost, where more triangles are poor than before
constexpr double kCostOfChord = 0.4;    ///< at twice as far

}  // namespace

double smallest_sine(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c) {
  const double ab = distance_sq(a, b), bc = distance_sq(b, c), ca = distance_sq(c, a);
  const double longer_sq = std::max({ab * bc, bc * ca, ca * ab});  // beside the smallest angle
  return longer_sq > 0 ? length(doubled_area(a, b, c)) / std::sqrt(longer_sq) : 0;
}

double MeshRegion::sine_of(const RegionTriangle& t) const {
  if (t.is_gone()) return 1;
  return smallest_sine(vertices_[t.corner[0]].position, vertices_[t.corner[1]].position,
                       vertices_[t.corner[2]].position);
}

int64_t MeshRegion::poor() const {
  return std::count_if(triangles_.begin(), triangles_.end(),
                       [&](const RegionTriangle& t) { return sine_of(t) < kPoorSine; });
}

double MeshRegion::worst_sine() const {
  double worst = kPoorSine;
  for (const RegionTriangle& t : triangles_) worst = std::min(worst, sine_of(t));
  return worst;
}

double MeshRegion::cost() const { return std::accumulate(costs_.begin(), costs_.end(), 0.0); }

double MeshRegion::cost_of_first() const {
  const auto first = std::find_if(triangles_.begin(), triangles_.end(), [](const RegionTriangle& t) {
    return std::max({t.corner[0], t.corner[1], t.corner[2]}) < 3;
  });
  return first == triangles_.end() ? 0 : costs_[size_t(first - triangles_.begin())];
}

/// Exact below `enough`; what is above may leave out the rest.
double MeshRegion::cost_of(const RegionTriangle& t, double enough) const {
  if (t.is_gone()) return 0;
  const double sine = sine_of(t);
  if (!(sine > 0)) return kMostCost;
  const double thin = std::max(0.0, kGoodSine / sine - 1);
  double sum = thin * thin + (sine < kPoorSine ? kCostOfPoor : 0);
  if (sum >= enough) return std::min(sum, kMostCost);
  const double turned = std::max(0.0, follows_ - cosine_to_surface(t));
  sum += kCostOfTurn * turned * turned;
  for (size_t i = 0; i < 3 && sum < enough; ++i)
    if (t.curve[i] != kNone) sum += cost_of_chord(t.corner[i], t.corner[(i + 1) % 3], t.curve[i]);
  return std::min(sum, kMostCost);
}

/// Between the normal of a triangle and those of the surface at its corners, the least.
double MeshRegion::cosine_to_surface(const RegionTriangle& t) const {
  const WorldPoint n =
      doubled_area(vertices_[t.corner[0]].position, vertices_[t.corner[1]].position, vertices_[t.corner[2]].position);
  const double whole = length(n);
  if (!(whole > 0)) return 1;
  double least = 1;
  for (const uint32_t v : t.corner)
    least = std::min(least, surface_->cosine(vertices_[v].home, t.patch, 1 / whole * n));
  return least;
}

double MeshRegion::cost_of_chord(uint32_t u, uint32_t v, uint32_t curve) const {
  const auto [begin, end] = span(u, v, curve);
  const double off =
      surface_->off_chord(curve, begin, end) / surface_->edge_length(vertices_[u].home) / kMostOffCurve - 1;
  return off > 0 ? kCostOfChord * off * off : 0;
}

/// Its place on a curve that it is on or ends; of both ends of a curve that returns to its corner the one nearer to
/// `other`.
size_t MeshRegion::place_on(const RegionVertex& v, uint32_t curve, size_t other) const {
  if (v.kind == RegionVertex::Kind::on_curve) return v.at;
  const CutCurve& c = surface_->cut().curves[curve];
  const size_t last = c.place.size() - 1;
  if (c.place.front() == c.place.back()) return 2 * other < last ? 0 : last;
  return c.place.front() == surface_->cut().place[v.home] ? 0 : last;
}

/// The places between two vertices that follow each other on a curve, the shorter way around a loop; beyond its last
/// one it goes on with the first.
std::array<size_t, 2> MeshRegion::span(uint32_t u, uint32_t v, uint32_t curve) const {
  const RegionVertex &a = vertices_[u], &b = vertices_[v];
  const CutCurve& c = surface_->cut().curves[curve];
  const size_t n = c.place.size();
  if (a.kind != RegionVertex::Kind::on_curve && b.kind != RegionVertex::Kind::on_curve) return {0, n - 1};
  const size_t i = place_on(a, curve, b.at), j = place_on(b, curve, a.at);
  const size_t begin = std::min(i, j), end = std::max(i, j);
  if (c.is_loop && 2 * (c.at_q8[end] - c.at_q8[begin]) > c.length_q8) return {end, begin + n};
  return {begin, end};
}

bool MeshRegion::is_better_than(const MeshRegion& start) const {
  const bool is_improved = poor() <= start.poor() || cost() < kMuchLess * start.cost();
  return is_improved && worst_sine() >= start.worst_sine();
}

}  // namespace isoshell
