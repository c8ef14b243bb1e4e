// See free_seeds.h.
#include "features/cutting/free_seeds.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "core/parallel_ranges.h"
#include "features/cutting/curve_seeds.h"
#include "isoshell/error.h"
#include "voxel/exact_int.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

constexpr int64_t kFewestOfClosed = 4;  ///< vertices of a closed surface
constexpr double kTinyLoop = 3;         ///< edges
constexpr int64_t kSlack = 8;           ///< a patch keeps so many seeds more or less than it needs, or one in so many

int64_t doubled_area(const SurfaceMesh& surface, TriangleIndices t) {
  const Vec64 n = cross(difference(surface.position[t.b], surface.position[t.a]),
                        difference(surface.position[t.c], surface.position[t.a]));
  return int64_t(isqrt(uint64_t(dot(n, n))));
}

/// Shares `whole` by demand, the rest by the largest remainders; of equal ones the first.
std::vector<int64_t> shared(int64_t whole, const std::vector<double>& demand) {
  const double sum = std::accumulate(demand.begin(), demand.end(), 0.0);
  std::vector<int64_t> out;
  std::vector<double> remainder;
  int64_t rest = whole;
  for (const double d : demand) {
    const double share = sum > 0 ? double(whole) * (d / sum) : 0;
    out.push_back(int64_t(share));
    rest -= out.back();
    remainder.push_back(share - double(out.back()));
  }
  std::vector<size_t> order(demand.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return remainder[a] > remainder[b]; });
  for (size_t i = 0; rest > 0; i = (i + 1) % order.size(), --rest) ++out[order[i]];
  return out;
}

/// The edges of a mesh that have two triangles, ascending.
std::vector<uint64_t> inner_edges(const Buffer<TriangleIndices>& triangles) {
  std::vector<uint64_t> edges, out;
  for (const TriangleIndices& t : triangles)
    edges.insert(edges.end(), {edge_key(t.a, t.b), edge_key(t.b, t.c), edge_key(t.c, t.a)});
  std::sort(edges.begin(), edges.end());
  for (size_t i = 0; i + 1 < edges.size(); ++i)
    if (edges[i] == edges[i + 1]) out.push_back(edges[i]);
  return out;
}

}  // namespace

FreeSeeds::FreeSeeds(const CutSurface& cut) : cut_(cut) {
  const SurfaceMesh& surface = cut.surface;
  patches_.resize(patch_count(cut));
  // In half-edges for the characteristic: 2 E is the corners and the border edges.
  for (uint32_t v = 0; v < surface.vertex_count(); ++v) {
    Patch& patch = patches_[patch_of(v)];
    patch.inside += is_inside(v) ? 1 : 0;
    patch.euler += is_inside(v) ? 2 : 1;
  }
  std::vector<int64_t> share(size_t(surface.triangles.size()));
  for_each_index(size_t(0), share.size(), [&](size_t t) { share[t] = seed_share(surface.triangles[int64_t(t)]); });
  for (size_t t = 0; t < share.size(); ++t) {
    const TriangleIndices i = surface.triangles[int64_t(t)];
    Patch& patch = patches_[patch_of(i.a)];
    patch.share += share[t];
    patch.euler -= 1;
    if (!is_inside(i.a) && !is_inside(i.b) && !is_inside(i.c)) continue;
    patch.triangles.push_back(uint32_t(t));
    patch.before.push_back(patch.share_inside);
    patch.share_inside += share[t];
  }
  for (Patch& patch : patches_) patch.euler /= 2;
  find_tiny_loops();
}

void FreeSeeds::find_tiny_loops() {
  const SurfaceMesh& surface = cut_.surface;
  const EdgeLengths& lengths = surface.lengths;
  for (int64_t c = 0; c < surface.chains.count(); ++c) {
    const int64_t begin = surface.chains.first[c], end = surface.chains.first[c + 1];
    double edges = 0;
    for (int64_t i = begin; i < end && edges < kTinyLoop; ++i) {
      const uint32_t v = surface.chains.vertex[i], w = surface.chains.vertex[i + 1 < end ? i + 1 : begin];
      const Vec64 step = difference(surface.position[v], surface.position[w]);
      edges += std::sqrt(double(dot(step, step))) / (lengths.at.empty() ? cut_.longest_edge_q8 : double(lengths.at[v]));
    }
    if (edges >= kTinyLoop) continue;
    if (tiny_loop_of_.empty()) tiny_loop_of_.assign(size_t(surface.vertex_count()), kNone);
    for (int64_t i = begin; i < end; ++i) tiny_loop_of_[surface.chains.vertex[i]] = uint32_t(tiny_loops_.size());
    tiny_loops_.push_back({patch_of(surface.chains.vertex[begin]), edges});
  }
}

/// Fixed seeds on the border of each patch, but of a tiny loop its edges of the length aimed at.
std::vector<double> FreeSeeds::on_border_by_length(const SeedSet& fixed) const {
  const Counts all = fixed_of(fixed);
  std::vector<double> out(all.begin(), all.end());
  if (tiny_loops_.empty()) return out;
  std::vector<double> on_loop(tiny_loops_.size(), 0);
  for (int64_t s = 0; s < fixed.fixed.count; ++s)
    if (const uint32_t loop = tiny_loop_of_[fixed.home[s]]; loop != kNone) ++on_loop[loop];
  for (size_t l = 0; l < on_loop.size(); ++l)
    out[tiny_loops_[l].patch] -= std::max(0.0, on_loop[l] - tiny_loops_[l].edges);
  return out;
}

/// A triangle's share of the seeds: its doubled area over the square of its edge length, the least being 1.
int64_t FreeSeeds::seed_share(TriangleIndices t) const {
  const EdgeLengths& lengths = cut_.surface.lengths;
  const int64_t area2 = std::max<int64_t>(1, doubled_area(cut_.surface, t));
  if (lengths.at.empty()) return area2;
  const double ratio =
      3 * double(lengths.least) / (double(lengths.at[t.a]) + double(lengths.at[t.b]) + double(lengths.at[t.c]));
  return std::max<int64_t>(1, int64_t(double(area2) * ratio * ratio));
}

/// Fixed seeds on the border of each patch.
FreeSeeds::Counts FreeSeeds::fixed_of(const SeedSet& fixed) const {
  Counts out(patches_.size(), 0);
  for (int64_t s = 0; s < fixed.fixed.count; ++s) ++out[patch_of(fixed.home[s])];
  return out;
}

int64_t FreeSeeds::fewest(const SeedSet& fixed) const {
  const Counts on_border = fixed_of(fixed);
  return count_places(fixed.fixed) + kFewestOfClosed * std::count(on_border.begin(), on_border.end(), 0);
}

double FreeSeeds::by_length(const SeedSet& fixed) const {
  const EdgeLengths& lengths = cut_.surface.lengths;
  const double e = lengths.at.empty() ? cut_.longest_edge_q8 : double(lengths.least);
  const std::vector<double> border = on_border_by_length(fixed);
  auto sum = double(count_places(fixed.fixed));
  for (size_t p = 0; p < patches_.size(); ++p)
    sum +=
        std::max(0., double(patches_[p].share) / (std::sqrt(3.) * e * e) - border[p] / 2 + double(patches_[p].euler));
  return sum;
}

int64_t FreeSeeds::closed_parts(const SeedSet& fixed) const {
  const Counts on_border = fixed_of(fixed);
  int64_t parts = 0;
  for (size_t p = 0; p < patches_.size(); ++p) parts += on_border[p] == 0 ? 2 - patches_[p].euler / 2 : 0;
  return parts;
}

FreeSeeds::Counts FreeSeeds::counts(const SeedSet& fixed, int64_t vertices) const {
  const Counts on_border = fixed_of(fixed);
  const int64_t places = count_places(fixed.fixed), least = fewest(fixed) - places;
  const std::vector<double> border = on_border_by_length(fixed);
  double shares = 0, taken = 0;
  for (size_t p = 0; p < patches_.size(); ++p) {
    shares += double(patches_[p].share);
    taken += border[p] / 2 - double(patches_[p].euler);
  }
  if (vertices < places + least)
    throw NoRoom("features",
                 std::to_string(vertices) + " vertices are too few: curves and corners take " + std::to_string(places) +
                     (least > 0 ? ", and closed parts without curves " + std::to_string(least) : std::string()) +
                     "; use more vertices, or a higher angle from which on edges are features");
  const double per_share = (double(vertices - places) + taken) / shares;
  std::vector<double> demand, area;
  for (size_t p = 0; p < patches_.size(); ++p) {
    const Patch& patch = patches_[p];
    const double inner = double(patch.share) * per_share - border[p] / 2 + double(patch.euler) -
                         double(on_border[p] == 0 ? kFewestOfClosed : 0);
    demand.push_back(std::max(0.0, inner));
    area.push_back(double(patch.share));
  }
  Counts out(patches_.size());
  for (size_t p = 0; p < patches_.size(); ++p) out[p] = on_border[p] == 0 ? kFewestOfClosed : 0;
  fill(vertices - places - least, demand, area, out);
  return out;
}

/// Shares seeds among the patches by demand, and what those have no room for by area.
void FreeSeeds::fill(int64_t seeds, std::vector<double> demand, std::vector<double> area, Counts& counts) const {
  while (seeds > 0) {
    const auto has_room = [&](size_t p) { return 2 * (counts[p] + 1) <= patches_[p].inside; };
    for (size_t p = 0; p < patches_.size(); ++p)
      if (!has_room(p)) demand[p] = area[p] = 0;
    const auto is_wanted = [](double d) { return d > 0; };
    if (std::none_of(demand.begin(), demand.end(), is_wanted)) demand = area;
    if (std::none_of(demand.begin(), demand.end(), is_wanted))
      throw NoRoom("features",
                   std::to_string(seeds) +
                       " seeds are too many for the patches, whose vertices are too few; cut the surface for a shorter "
                       "edge length, or use fewer vertices");
    const std::vector<int64_t> more = shared(seeds, demand);
    for (size_t p = 0; p < patches_.size(); ++p) {
      const int64_t room = std::max<int64_t>(0, patches_[p].inside / 2 - counts[p]), takes = std::min(more[p], room);
      counts[p] += takes;
      seeds -= takes;
    }
  }
}

FreeSeeds::Counts FreeSeeds::coarser(const SeedSet& fixed, const Counts& finer) const {
  const Counts on_border = fixed_of(fixed);
  Counts out;
  for (size_t p = 0; p < patches_.size(); ++p) {  // f inner vertices and b on the border have 3 f + b - 3 x inner edges
    const int64_t count = (finer[p] - on_border[p] + 3 * patches_[p].euler + 3) / 4;
    out.push_back(std::clamp<int64_t>(count, on_border[p] == 0 ? kFewestOfClosed : 0, finer[p]));
  }
  return out;
}

FreeSeeds::Counts FreeSeeds::as_before(const Counts& wanted, const Counts& before) const {
  Counts out;
  int64_t missing = 0;
  for (size_t p = 0; p < patches_.size(); ++p) {
    const int64_t slack = std::max<int64_t>(kSlack, wanted[p] / kSlack), most = patches_[p].inside / 2;
    out.push_back(std::clamp(before[p], std::min(wanted[p], std::max(kFewestOfClosed, wanted[p] - slack)),
                             std::max(wanted[p], std::min(most, wanted[p] + slack))));
    missing += wanted[p] - out.back();
  }
  std::vector<double> demand;
  for (size_t p = 0; p < out.size(); ++p)
    demand.push_back(std::max(0.0, double(missing < 0 ? out[p] - wanted[p] : wanted[p] - out[p])));
  if (missing == 0) return out;
  const std::vector<int64_t> more = shared(std::abs(missing), demand);
  for (size_t p = 0; p < out.size(); ++p) out[p] += missing < 0 ? -more[p] : more[p];
  return out;
}

/// A point at random in a triangle, as place_seeds takes it; its home is the corner of the largest weight that is not
/// on a border.
FreeSeeds::FreeSeed FreeSeeds::seed_in(uint32_t triangle, uint64_t r) const {
  const SurfaceMesh& surface = cut_.surface;
  const TriangleIndices t = surface.triangles[triangle];
  constexpr int64_t kOne = 1 << 20;
  int64_t u = int64_t(r & 0xfffff), v = int64_t(r >> 20 & 0xfffff);
  if (u + v > kOne) u = kOne - u, v = kOne - v;
  const PointQ8 a = surface.position[t.a];
  const Vec64 e = difference(surface.position[t.b], a), f = difference(surface.position[t.c], a);
  FreeSeed seed{
      {a.x + int32_t((e.x * u + f.x * v + kOne / 2) >> 20), a.y + int32_t((e.y * u + f.y * v + kOne / 2) >> 20),
       a.z + int32_t((e.z * u + f.z * v + kOne / 2) >> 20)},
      kNone};
  const uint32_t corner[3] = {t.a, t.b, t.c};
  const int64_t weight[3] = {kOne - u - v, u, v};
  int64_t most = -1;
  for (int i = 0; i < 3; ++i)
    if (is_inside(corner[i]) && weight[i] > most) most = weight[i], seed.home = corner[i];
  return seed;
}

/// One seed in each of as many strata of equal shares as seeds are asked for, along the triangles.
void FreeSeeds::spread(const Patch& patch, int64_t count, uint64_t seed, std::vector<FreeSeed>& out) const {
  if (count == 0) return;
  const int64_t width = patch.share_inside / count, rest = patch.share_inside % count;
  for (int64_t i = 0; i < count; ++i) {
    const uint64_t r = random_bits(seed, uint64_t(patch.triangles[0]) << 32 | uint64_t(i));
    const auto fraction_24 = int64_t(r >> 40);
    const int64_t target =
        width * i + rest * i / count + (width >> 24) * fraction_24 + ((width & 0xffffff) * fraction_24 >> 24);
    const auto after = std::upper_bound(patch.before.begin(), patch.before.end(), target);
    out.push_back(seed_in(patch.triangles[size_t(after - patch.before.begin() - 1)], r));
  }
}

SeedSet FreeSeeds::with_fixed(SeedSet fixed, const Placed& placed) const {
  int64_t count = fixed.fixed.count;
  for (const std::vector<FreeSeed>& in_patch : placed) count += int64_t(in_patch.size());
  SeedSet out;
  out.position = Buffer<PointQ8>(count);
  out.normal = Buffer<Normal8>(count);
  out.home = Buffer<uint32_t>(count);
  int64_t s = 0;
  for (; s < fixed.fixed.count; ++s) out.position[s] = fixed.position[s], out.home[s] = fixed.home[s];
  for (const std::vector<FreeSeed>& in_patch : placed)
    for (const FreeSeed& seed : in_patch) out.position[s] = seed.position, out.home[s] = seed.home, ++s;
  for (s = 0; s < count; ++s) out.normal[s] = cut_.surface.normal[out.home[s]];
  out.fixed = std::move(fixed.fixed);
  return out;
}

SeedSet FreeSeeds::add(SeedSet fixed, const Counts& counts, uint64_t seed) const {
  Placed placed(patches_.size());
  for (size_t p = 0; p < patches_.size(); ++p) spread(patches_[p], counts[p], seed, placed[p]);
  return with_fixed(std::move(fixed), placed);
}

/// Downhill over neighbours; kNone where that ends on a border.
uint32_t FreeSeeds::inside_near(uint32_t from, PointQ8 target) const {
  const SurfaceMesh& surface = cut_.surface;
  uint32_t at = from;
  for (;;) {
    uint32_t next = at;
    int64_t best = distance_sq_q16(surface.position[at], target);
    for (int64_t n = surface.vertex_first[at]; n < surface.vertex_first[at + 1]; ++n) {
      const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
      for (const uint32_t v : {t.a, t.b, t.c}) {
        const int64_t d = distance_sq_q16(surface.position[v], target);
        if (d < best || (d == best && v < next)) best = d, next = v;
      }
    }
    if (next == at) return is_inside(at) ? at : kNone;
    at = next;
  }
}

FreeSeeds::Placed FreeSeeds::middles_of_edges(const SeededMesh& coarse, Placed placed, const Counts& counts) const {
  struct Middle {
    int64_t size;  ///< the square of the edge, beside the lengths there
    uint64_t edge;
  };
  const SeedSet& seeds = coarse.seeds;
  const EdgeLengths& lengths = cut_.surface.lengths;
  std::vector<std::vector<Middle>> middles(patches_.size());
  for (const uint64_t edge : inner_edges(coarse.mesh.triangles)) {
    const uint32_t a = seeds.home[int64_t(edge >> 32)], b = seeds.home[int64_t(uint32_t(edge))];
    double size = double(distance_sq_q16(seeds.position[int64_t(edge >> 32)], seeds.position[int64_t(uint32_t(edge))]));
    if (!lengths.at.empty()) {
      const double ratio = 2 * double(lengths.least) / (double(lengths.at[a]) + double(lengths.at[b]));
      size = size * ratio * ratio;
    }
    middles[patch_of(a)].push_back({int64_t(size), edge});
  }
  std::vector<char> is_taken(size_t(cut_.surface.vertex_count()), 0);
  for (const auto& in_patch : placed)
    for (const FreeSeed& seed : in_patch) is_taken[seed.home] = 1;
  for (size_t p = 0; p < patches_.size(); ++p) {
    std::sort(middles[p].begin(), middles[p].end(),
              [](const Middle& m, const Middle& n) { return m.size != n.size ? m.size > n.size : m.edge < n.edge; });
    for (const Middle& m : middles[p]) {
      if (int64_t(placed[p].size()) >= counts[p]) break;
      const auto a = int64_t(m.edge >> 32), b = int64_t(uint32_t(m.edge));
      const PointQ8 u = seeds.position[a], v = seeds.position[b];
      const uint32_t home = inside_near(seeds.home[a], {(u.x + v.x) >> 1, (u.y + v.y) >> 1, (u.z + v.z) >> 1});
      if (home == kNone || is_taken[home]) continue;
      is_taken[home] = 1;
      placed[p].push_back({cut_.surface.position[home], home});
    }
  }
  return placed;
}

SeedSet FreeSeeds::add_finer(SeedSet fixed, const Counts& counts, const SeededMesh& coarse, uint64_t seed) const {
  Placed placed(patches_.size());
  for (int64_t s = coarse.seeds.fixed.count; s < coarse.seeds.size(); ++s) {
    std::vector<FreeSeed>& in_patch = placed[patch_of(coarse.seeds.home[s])];
    if (int64_t(in_patch.size()) < counts[patch_of(coarse.seeds.home[s])])
      in_patch.push_back({coarse.seeds.position[s], coarse.seeds.home[s]});
  }
  placed = middles_of_edges(coarse, std::move(placed), counts);
  for (size_t p = 0; p < patches_.size(); ++p)
    spread(patches_[p], counts[p] - int64_t(placed[p].size()), seed, placed[p]);
  return with_fixed(std::move(fixed), placed);
}

}  // namespace isoshell
