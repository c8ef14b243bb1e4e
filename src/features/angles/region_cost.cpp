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
constexpr double kCostOfChord = 0.4;    ///< at twice as far

}  // namespace

int64_t MeshRegion::poor() const {
  return std::count_if(triangles().begin(), triangles().end(),
                       [&](const RegionTriangle& t) { return sine(t) < kPoorSine; });
}

double MeshRegion::worst_sine() const {
  double worst = kPoorSine;
  for (const RegionTriangle& t : triangles()) worst = std::min(worst, sine(t));
  return worst;
}

double MeshRegion::cost() const { return std::accumulate(costs_.begin(), costs_.end(), 0.0); }

double MeshRegion::cost_of_first() const {
  const auto first = std::find_if(triangles().begin(), triangles().end(), [](const RegionTriangle& t) {
    return std::max({t.corner[0], t.corner[1], t.corner[2]}) < 3;
  });
  return first == triangles().end() ? 0 : costs_[size_t(first - triangles().begin())];
}

/// Exact below `enough`; what is above may leave out the rest.
double MeshRegion::cost_of(const RegionTriangle& t, double enough) const {
  if (t.is_gone()) return 0;
  const double narrow = sine(t);
  if (!(narrow > 0)) return kMostCost;
  const double thin = std::max(0.0, kGoodSine / narrow - 1);
  double sum = thin * thin + (narrow < kPoorSine ? kCostOfPoor : 0);
  if (sum >= enough) return std::min(sum, kMostCost);
  const double turned = std::max(0.0, follows_ - surface_->cosine(*this, t));
  sum += kCostOfTurn * turned * turned;
  for (size_t i = 0; i < 3 && sum < enough; ++i)
    if (t.curve[i] != kNone) sum += cost_of_chord(t.corner[i], t.corner[(i + 1) % 3], t.curve[i]);
  return std::min(sum, kMostCost);
}

double MeshRegion::cost_of_chord(uint32_t u, uint32_t v, uint32_t curve) const {
  const auto [begin, end] = span(u, v, curve);
  const double off = surface_->off_chord(curve, begin, end) / surface_->edge_length(vertex(u).home) / kMostOffCurve - 1;
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
  const RegionVertex &a = vertex(u), &b = vertex(v);
  const CutCurve& c = surface_->cut().curves[curve];
  const size_t n = c.place.size();
  if (a.kind != RegionVertex::Kind::on_curve && b.kind != RegionVertex::Kind::on_curve) return {0, n - 1};
  const size_t i = place_on(a, curve, b.at), j = place_on(b, curve, a.at);
  const size_t begin = std::min(i, j), end = std::max(i, j);
  if (c.is_loop && 2 * (c.at_q8[end] - c.at_q8[begin]) > c.length_q8) return {end, begin + n};
  return {begin, end};
}

bool MeshRegion::is_better_than(const MeshRegion& start) const {
  return poor() <= start.poor() && worst_sine() >= start.worst_sine();
}

}  // namespace isoshell
