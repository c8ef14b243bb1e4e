// CutLookup (see cut_lookup.h).
#include "features/angles/cut_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <tuple>

#include "core/parallel_ranges.h"
#include "features/mesh/refine_mesh.h"
#include "geometry/segment.h"
#include "voxel/closest_point.h"

namespace isoshell {
namespace {

constexpr double kLeastBend = 1. / 512;  ///< edges that a bend is off the chord between those around it
constexpr double kRounding = 2;          ///< steps that a straight curve may seem to bend

}  // namespace

CutLookup::CutLookup(const CutSurface& cut)
    : cut_(&cut), bends_(cut.curves.size()), at_place_(cut.copies_first.size() - 1, {kNone, 0}) {
  for_each_index(uint32_t(0), uint32_t(bends_.size()), [&](uint32_t c) { bends_[c] = bends_of(c); });
  for (uint32_t c = 0; c < cut.curves.size(); ++c)
    for (size_t i = 0; i < cut.curves[c].place.size(); ++i) at_place_[cut.curves[c].place[i]] = {c, i};
}

WorldPoint CutLookup::position(uint32_t home) const {
  const PointQ8 p = cut_->surface.position[home];
  return {double(p.x), double(p.y), double(p.z)};
}

RegionVertex CutLookup::vertex_at(uint32_t home) const {
  using Kind = RegionVertex::Kind;
  RegionVertex out;
  out.home = home;
  out.position = position(home);
  const uint32_t place = cut_->place[home];
  if (place == kNone) return out;
  out.kind = place < cut_->corner_count ? Kind::corner : Kind::on_curve;
  std::tie(out.curve, out.at) = at_place_[place];
  return out;
}

RegionVertex CutLookup::on_curve_at(uint32_t curve, size_t at) const { return vertex_at(home_on(curve, at)); }

std::optional<RegionVertex> CutLookup::on_surface_near(const RegionVertex& from, const WorldPoint& near) const {
  RegionVertex out = from;
  out.home = nearest_from(from.home, near);
  if (cut_->place[out.home] != kNone) return {};
  const SurfaceMesh& surface = cut_->surface;
  double nearest = std::numeric_limits<double>::infinity();
  for (int64_t n = surface.vertex_first[out.home]; n < surface.vertex_first[out.home + 1]; ++n) {
    const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
    const PointQ8 at =
        closest_point_on_triangle(rounded(near), surface.position[t.a], surface.position[t.b], surface.position[t.c]);
    const WorldPoint there{double(at.x), double(at.y), double(at.z)};
    if (const double d = distance_sq(there, near); d < nearest) nearest = d, out.position = there;
  }
  return out;
}

double CutLookup::way_between(const RegionVertex& from, const RegionVertex& to) const {
  const CutCurve& curve = cut_->curves[from.curve];
  const double here = curve.at_q8[from.at], half = curve.length_q8 / 2;
  if (to.kind == RegionVertex::Kind::corner) {
    const uint32_t place = cut_->place[to.home];
    const bool is_first = curve.place.front() == place, is_last = curve.place.back() == place;
    return (is_last && (!is_first || here > half) ? curve.length_q8 : 0) - here;
  }
  const double way = curve.at_q8[to.at] - here;
  if (!curve.is_loop || std::abs(way) <= half) return way;
  return way > 0 ? way - curve.length_q8 : way + curve.length_q8;
}

RegionVertex CutLookup::along(const RegionVertex& from, double way_q8) const {
  const CutCurve& curve = cut_->curves[from.curve];
  const std::vector<double>& at = curve.at_q8;
  double wanted = at[from.at] + way_q8;
  if (curve.is_loop && wanted < 0) wanted += curve.length_q8;
  if (curve.is_loop && wanted >= curve.length_q8) wanted -= curve.length_q8;
  auto i = size_t(std::lower_bound(at.begin(), at.end(), wanted) - at.begin());
  if (i == at.size() || (i > 0 && wanted - at[i - 1] < at[i] - wanted)) --i;
  if (!curve.is_loop) i = std::min(std::max(i, size_t(1)), at.size() - 2);
  return on_curve_at(from.curve, i);
}

double CutLookup::edge_length(uint32_t home) const {
  const EdgeLengths& lengths = cut_->surface.lengths;
  return lengths.at.empty() ? cut_->longest_edge_q8 : double(lengths.at[home]);
}

uint32_t CutLookup::home_on(uint32_t curve, size_t at) const {
  const std::vector<uint32_t>& place = cut_->curves[curve].place;
  return cut_->copies[size_t(cut_->copies_first[place[at < place.size() ? at : at - place.size()]])];
}

uint32_t CutLookup::copy_in(uint32_t home, uint32_t patch) const {
  const uint32_t place = cut_->place[home];
  if (place == kNone || this->patch(home) == patch) return home;
  for (int64_t i = cut_->copies_first[place]; i < cut_->copies_first[place + 1]; ++i)
    if (this->patch(cut_->copies[size_t(i)]) == patch) return cut_->copies[size_t(i)];
  return kNone;
}

double CutLookup::cosine(uint32_t home, uint32_t patch, const WorldPoint& unit) const {
  const auto cosine_at = [&](uint32_t copy) {
    const Normal8 n = cut_->surface.normal[copy];
    const WorldPoint at{double(n.x), double(n.y), double(n.z)};
    const double whole = length(at);
    return whole > 0 ? dot(at, unit) / whole : 1;
  };
  const uint32_t place = cut_->place[home];
  if (place == kNone) return cosine_at(home);
  double best = -1;
  for (int64_t i = cut_->copies_first[place]; i < cut_->copies_first[place + 1]; ++i)
    if (const uint32_t copy = cut_->copies[size_t(i)]; this->patch(copy) == patch)
      best = std::max(best, cosine_at(copy));
  return best;
}

double CutLookup::cosine(const EditableMesh& mesh, const RegionTriangle& t) const {
  const WorldPoint unit = normalised(mesh.normal(t));
  double least = 1;
  for (const uint32_t v : t.corner) least = std::min(least, cosine(mesh.vertex(v).home, t.patch, unit));
  return least;
}

uint32_t CutLookup::nearest_from(uint32_t start, const WorldPoint& near) const {
  const SurfaceMesh& surface = cut_->surface;
  uint32_t at = start;
  for (uint32_t from = kNone; from != at;) {
    from = at;
    double nearest = distance_sq(position(at), near);
    for (int64_t n = surface.vertex_first[from]; n < surface.vertex_first[from + 1]; ++n) {
      const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
      for (const uint32_t w : {t.a, t.b, t.c}) {
        const double d = distance_sq(position(w), near);
        if (d < nearest || (d == nearest && w < at)) nearest = d, at = w;
      }
    }
  }
  return at;
}

double CutLookup::off_chord(uint32_t curve, size_t begin, size_t end) const {
  const std::vector<size_t>& bends = bends_[curve];
  const WorldPoint a = position(home_on(curve, begin)), b = position(home_on(curve, end));
  double farthest_sq = 0;
  for (auto i = std::upper_bound(bends.begin(), bends.end(), begin); i != bends.end() && *i < end; ++i)
    farthest_sq = std::max(farthest_sq, segment_distance_sq(position(home_on(curve, *i)), a, b));
  return std::sqrt(farthest_sq);
}

/// Cuts the curve at the place that is farthest from its chord, then both parts, until all places are near.
std::vector<size_t> CutLookup::bends_of(uint32_t curve) const {
  const CutCurve& c = cut_->curves[curve];
  const size_t n = c.place.size();
  double shortest = cut_->longest_edge_q8;
  for (size_t i = 0; i < n; ++i) shortest = std::min(shortest, edge_length(home_on(curve, i)));
  const double least = std::max(kRounding, kLeastBend * shortest);
  std::vector<size_t> bends;
  if (c.is_loop) bends.push_back(0);
  std::vector<std::array<size_t, 2>> parts{{0, c.is_loop ? n : n - 1}};
  while (!parts.empty()) {
    const auto [begin, end] = parts.back();
    parts.pop_back();
    const WorldPoint a = position(home_on(curve, begin)), b = position(home_on(curve, end));
    size_t farthest = begin;
    double farthest_sq = least * least;
    for (size_t i = begin + 1; i < end; ++i)
      if (const double d = segment_distance_sq(position(home_on(curve, i)), a, b); d > farthest_sq)
        farthest = i, farthest_sq = d;
    if (farthest == begin) continue;
    bends.push_back(farthest);
    parts.insert(parts.end(), {{begin, farthest}, {farthest, end}});
  }
  std::sort(bends.begin(), bends.end());
  if (c.is_loop)
    for (size_t i = 0, count = bends.size(); i < count; ++i) bends.push_back(bends[i] + n);
  return bends;
}

}  // namespace isoshell
