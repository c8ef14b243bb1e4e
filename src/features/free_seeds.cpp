// add_free_seeds (see curve_seeds.h).
#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>

#include "features/curve_seeds.h"
#include "isoshell/error.h"
#include "voxel/exact_int.h"
#include "voxel/random.h"

namespace isoshell {
namespace {

struct Patch {
  int64_t area2_q16 = 0;            ///< doubled
  int64_t euler = 0, inside = 0;    ///< Euler characteristic; vertices off the border
  int64_t fixed = 0;                ///< seeds on its border
  std::vector<uint32_t> triangles;  ///< those with a vertex inside
  double demand = 0;                ///< seeds inside
  int64_t least = 0, seeds = 0;
};

int64_t doubled_area(const SurfaceMesh& surface, TriangleIndices t) {
  const Vec64 n = cross(difference(surface.position[t.b], surface.position[t.a]),
                        difference(surface.position[t.c], surface.position[t.a]));
  return int64_t(isqrt(uint64_t(dot(n, n))));
}

/// What the patches are, in half-edges for their characteristic: 2 E is the corners and the border edges.
std::vector<Patch> measure_patches(const CutSurface& cut, const SeedSet& fixed) {
  const SurfaceMesh& surface = cut.surface;
  std::vector<Patch> patches(surface.patch.empty() ? 1 : size_t(surface.patch[surface.vertex_count() - 1]) + 1);
  const auto patch_of = [&](uint32_t v) -> Patch& { return patches[surface.patch.empty() ? 0 : surface.patch[v]]; };
  for (uint32_t v = 0; v < surface.vertex_count(); ++v) {
    const bool is_inside = cut.place[v] == kNone;
    patch_of(v).inside += is_inside ? 1 : 0;
    patch_of(v).euler += is_inside ? 2 : 1;
  }
  for (int64_t t = 0; t < surface.triangles.size(); ++t) {
    const TriangleIndices i = surface.triangles[t];
    Patch& patch = patch_of(i.a);
    patch.area2_q16 += doubled_area(surface, i);
    patch.euler -= 1;
    if (cut.place[i.a] == kNone || cut.place[i.b] == kNone || cut.place[i.c] == kNone)
      patch.triangles.push_back(uint32_t(t));
  }
  for (Patch& patch : patches) patch.euler /= 2;
  for (int64_t s = 0; s < fixed.fixed.count; ++s) ++patch_of(fixed.home[s]).fixed;
  return patches;
}

/// What Euler's formula leaves for the inside of every patch, at the edge length that gives `vertices` in all.
void find_demand(int64_t free, std::vector<Patch>& patches) {
  double area = 0, taken = 0;
  for (const Patch& p : patches) {
    area += double(p.area2_q16);
    taken += double(p.fixed) / 2 - double(p.euler);
  }
  const double per_area = (double(free) + taken) / std::max(area, 1.0);  // all patches have `free` inside
  for (Patch& p : patches) {
    p.least = p.fixed == 0 ? 4 : 0;  // a closed surface has four vertices or more
    p.demand = std::max(0.0, double(p.area2_q16) * per_area - double(p.fixed) / 2 + double(p.euler) - double(p.least));
    if (p.inside < 2) p.demand = 0;
  }
}

/// Shares `free` seeds by demand, the rest by the largest remainders; of equal ones the first patch.
void share_seeds(int64_t free, std::vector<Patch>& patches) {
  for (const Patch& p : patches) free -= p.least;
  double demand = 0;
  for (const Patch& p : patches) demand += p.demand;
  if (!(demand > 0))
    for (Patch& p : patches) demand += p.demand = p.inside < 2 ? 0 : double(p.area2_q16);
  std::vector<double> remainder;
  int64_t rest = free;
  for (Patch& p : patches) {
    const double share = demand > 0 ? double(free) * (p.demand / demand) : 0;
    const auto whole = int64_t(share);
    p.seeds = p.least + whole;
    rest -= whole;
    remainder.push_back(share - double(whole));
  }
  std::vector<size_t> order(patches.size());
  std::iota(order.begin(), order.end(), size_t(0));
  std::stable_sort(order.begin(), order.end(), [&](size_t a, size_t b) { return remainder[a] > remainder[b]; });
  for (size_t i = 0; rest > 0; i = (i + 1) % order.size(), --rest) ++patches[order[i]].seeds;
}

struct FreeSeed {
  PointQ8 position;
  uint32_t home;
};

/// A point at random in a triangle, as place_seeds takes it; its home is the corner of the largest weight that is not
/// on a border.
FreeSeed seed_in(const CutSurface& cut, uint32_t triangle, uint64_t r) {
  const SurfaceMesh& surface = cut.surface;
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
    if (cut.place[corner[i]] == kNone && weight[i] > most) most = weight[i], seed.home = corner[i];
  return seed;
}

/// One seed in each of as many strata of equal area as a patch has seeds, along its triangles.
void spread_seeds(const CutSurface& cut, const Patch& patch, uint64_t seed, std::vector<FreeSeed>& out) {
  std::vector<int64_t> before;
  int64_t total = 0;
  for (const uint32_t t : patch.triangles) {
    before.push_back(total);
    total += std::max<int64_t>(1, doubled_area(cut.surface, cut.surface.triangles[t]));
  }
  const int64_t width = patch.seeds > 0 ? total / patch.seeds : 0, rest = patch.seeds > 0 ? total % patch.seeds : 0;
  for (int64_t i = 0; i < patch.seeds; ++i) {
    const uint64_t r = random_bits(seed, uint64_t(out.size()));
    const auto fraction_24 = int64_t(r >> 40);
    const int64_t target =
        width * i + rest * i / patch.seeds + (width >> 24) * fraction_24 + ((width & 0xffffff) * fraction_24 >> 24);
    const auto after = std::upper_bound(before.begin(), before.end(), target);
    out.push_back(seed_in(cut, patch.triangles[size_t(after - before.begin() - 1)], r));
  }
}

void require_room(int64_t vertices, int64_t places, const std::vector<Patch>& patches) {
  int64_t least = 0;
  for (const Patch& p : patches) least += p.fixed == 0 ? 4 : 0;
  if (vertices >= places + least) return;
  throw Error(ErrorCode::usage, "features",
              std::to_string(vertices) + " vertices are too few: curves and corners take " + std::to_string(places) +
                  (least > 0 ? ", and closed parts without curves " + std::to_string(least) : std::string()) +
                  "; use more vertices, or a higher angle from which on edges are features");
}

void require_fine_patches(const std::vector<Patch>& patches) {
  for (size_t p = 0; p < patches.size(); ++p)
    if (2 * patches[p].seeds > patches[p].inside)
      throw Error(ErrorCode::usage, "features",
                  std::to_string(patches[p].seeds) + " seeds are too many for patch " + std::to_string(p) +
                      ", which has " + std::to_string(patches[p].inside) +
                      " vertices inside; cut the surface for a shorter edge length, or use fewer vertices");
}

}  // namespace

SeedSet add_free_seeds(const CutSurface& cut, SeedSet fixed, int64_t vertices, uint64_t seed) {
  std::vector<Patch> patches = measure_patches(cut, fixed);
  const int64_t places = count_places(fixed.fixed);
  require_room(vertices, places, patches);
  find_demand(vertices - places, patches);
  share_seeds(vertices - places, patches);
  require_fine_patches(patches);
  std::vector<FreeSeed> free;
  for (const Patch& patch : patches) spread_seeds(cut, patch, seed, free);

  const int64_t first = fixed.fixed.count, count = first + int64_t(free.size());
  SeedSet out;
  out.position = Buffer<PointQ8>(count);
  out.normal = Buffer<Normal8>(count);
  out.home = Buffer<uint32_t>(count);
  for (int64_t s = 0; s < count; ++s) {
    out.home[s] = s < first ? fixed.home[s] : free[size_t(s - first)].home;
    out.position[s] = s < first ? fixed.position[s] : free[size_t(s - first)].position;
    out.normal[s] = cut.surface.normal[out.home[s]];
  }
  out.fixed = std::move(fixed.fixed);
  return out;
}

}  // namespace isoshell
