// CutLookup (see cut_lookup.h).
#include "features/angles/cut_lookup.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/parallel_ranges.h"
#include "geometry/segment.h"

namespace isoshell {
namespace {

constexpr double kLeastBend = 1. / 512;  ///< edges that a bend is off the chord between those around it
constexpr double kRounding = 2;          ///< steps that a straight curve may seem to bend

}  // namespace

CutLookup::CutLookup(const CutSurface& cut) : cut_(&cut), bends_(cut.curves.size()) {
  for_each_index(uint32_t(0), uint32_t(bends_.size()), [&](uint32_t c) { bends_[c] = bends_of(c); });
}

WorldPoint CutLookup::position(uint32_t home) const {
  const PointQ8 p = cut_->surface.position[home];
  return {double(p.x), double(p.y), double(p.z)};
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
