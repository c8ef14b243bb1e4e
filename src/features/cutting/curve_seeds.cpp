// seeds_on_curves (see curve_seeds.h).
#include "features/cutting/curve_seeds.h"

#include <algorithm>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

/// Per place the place of the nearest seed along its curve; places that are seeds are their own.
std::vector<uint32_t> nearest_seed_places(const CutSurface& cut, int level) {
  std::vector<uint32_t> nearest(cut.copies_first.size() - 1, kNone);
  for (const CutCurve& curve : cut.curves) {
    const std::vector<size_t> seeds = seeds_of_level(curve, level);
    for (size_t s = 0; s < seeds.size(); ++s) {
      nearest[curve.place[seeds[s]]] = curve.place[seeds[s]];
      const bool is_last = s + 1 == seeds.size();
      if (is_last && !curve.is_loop) break;
      const size_t begin = seeds[s], end = is_last ? curve.place.size() : seeds[s + 1];
      const uint32_t here = curve.place[begin], there = curve.place[is_last ? 0 : end];
      const double end_at = is_last ? curve.length_q8 : curve.at_q8[end];
      for (size_t i = begin + 1; i < end; ++i) {
        const double to_here = curve.at_q8[i] - curve.at_q8[begin], to_there = end_at - curve.at_q8[i];
        const bool takes_here = to_here != to_there ? to_here < to_there : here < there;
        nearest[curve.place[i]] = takes_here ? here : there;
      }
    }
  }
  return nearest;
}

/// Between two seeds of a loop of the border, every vertex belongs to the one at the place that it is nearest to.
void label_chain(const View<const uint32_t>& chain, const std::vector<uint32_t>& place,
                 const std::vector<uint32_t>& nearest, Buffer<uint32_t>& of_vertex) {
  const auto is_seed = [&](uint32_t v) { return nearest[place[v]] == place[v]; };
  const int64_t start = std::find_if(chain.begin(), chain.end(), is_seed) - chain.begin();
  uint32_t before = chain[start];
  for (int64_t i = 1; i < chain.size;) {
    int64_t end = i;
    while (!is_seed(chain[(start + end) % chain.size])) ++end;
    const uint32_t after = chain[(start + end) % chain.size];
    for (; i < end; ++i) {
      const uint32_t v = chain[(start + i) % chain.size];
      of_vertex[v] = of_vertex[nearest[place[v]] == place[before] ? before : after];
    }
    before = after;
    ++i;
  }
}

}  // namespace

std::vector<size_t> seeds_of_level(const CutCurve& curve, int level) {
  std::vector<size_t> seeds = curve.seeds;
  const size_t end = curve.is_loop ? 0 : 1;  // seeds beyond the last segment
  for (; level > 0; --level) {
    const size_t segments = seeds.size() - end, coarse = std::max((segments + 1) / 2, size_t(curve.least_segments));
    if (coarse >= segments) break;
    std::vector<size_t> next;
    for (size_t i = 0; i < coarse + end; ++i) next.push_back(seeds[i * segments / coarse]);
    seeds = std::move(next);
  }
  return seeds;
}

int64_t count_places(const FixedSeeds& fixed) {
  int64_t places = 0;
  for (int64_t s = 0; s < fixed.count; ++s) places += fixed.joined[s] == s ? 1 : 0;
  return places;
}

SeedSet seeds_on_curves(const CutSurface& cut, int level) {
  const SurfaceMesh& surface = cut.surface;
  SeedSet seeds;
  if (cut.curves.empty()) return seeds;
  const std::vector<uint32_t> nearest = nearest_seed_places(cut, level);
  std::vector<uint32_t> home, joined;
  for (uint32_t p = 0; p < nearest.size(); ++p) {
    if (nearest[p] != p) continue;
    const auto smallest = uint32_t(home.size());
    for (int64_t c = cut.copies_first[p]; c < cut.copies_first[p + 1]; ++c) {
      home.push_back(cut.copies[size_t(c)]);
      joined.push_back(smallest);
    }
  }
  const auto count = int64_t(home.size());
  seeds.position = Buffer<PointQ8>(count);
  seeds.normal = Buffer<Normal8>(count);
  seeds.home = Buffer<uint32_t>(count);
  seeds.fixed.count = count;
  seeds.fixed.joined = Buffer<uint32_t>(count);
  seeds.fixed.of_vertex = Buffer<uint32_t>(surface.vertex_count());
  std::fill(seeds.fixed.of_vertex.begin(), seeds.fixed.of_vertex.end(), kNone);
  for (int64_t s = 0; s < count; ++s) {
    const uint32_t v = home[size_t(s)];
    seeds.position[s] = surface.position[v];
    seeds.normal[s] = surface.normal[v];
    seeds.home[s] = v;
    seeds.fixed.joined[s] = joined[size_t(s)];
    seeds.fixed.of_vertex[v] = uint32_t(s);
  }
  const Chains& chains = surface.chains;
  for (int64_t c = 0; c < chains.count(); ++c)
    label_chain(chains.vertex.view().part(chains.first[c], chains.first[c + 1] - chains.first[c]), cut.place, nearest,
                seeds.fixed.of_vertex);
  return seeds;
}

}  // namespace isoshell
