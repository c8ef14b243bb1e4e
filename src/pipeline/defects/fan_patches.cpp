// triangulate_as_fans (see fan_patches.h).
#include "pipeline/defects/fan_patches.h"

#include <algorithm>
#include <limits>

#include "pipeline/defects/added_seeds.h"

namespace isoshell {
namespace {

constexpr int64_t kMostFree = 2;  ///< free seeds that a patch may lose so
constexpr size_t kMostOnBorder = 16;

/// What becomes of a patch.
struct Fan {
  std::vector<uint32_t> border;  ///< seeds around it
  int64_t loops = 0, free = 0;
  uint32_t middle = kNone;  ///< vertex of the surface
  int64_t clearance = -1;   ///< square of its distance from the nearest seed of the border

  bool is_possible() const {
    return loops == 1 && free <= kMostFree && border.size() >= 3 && border.size() <= kMostOnBorder && middle != kNone;
  }
};

std::vector<Fan> fans_of(const CutSurface& cut, const std::vector<char>& is_chosen, const SeedSet& seeds) {
  const SurfaceMesh& surface = cut.surface;
  std::vector<Fan> fans(is_chosen.size());
  for (int64_t c = 0; c < surface.chains.count(); ++c) {
    const int64_t begin = surface.chains.first[c], end = surface.chains.first[c + 1];
    const uint32_t patch = surface.patch[surface.chains.vertex[begin]];
    if (!is_chosen[patch]) continue;
    ++fans[patch].loops;
    for (int64_t i = begin; i < end; ++i) {
      const uint32_t v = surface.chains.vertex[i], seed = seeds.fixed.of_vertex[v];
      if (seeds.home[seed] == v) fans[patch].border.push_back(seed);
    }
  }
  for (int64_t s = seeds.fixed.count; s < seeds.size(); ++s) ++fans[surface.patch[seeds.home[s]]].free;
  for (uint32_t v = 0; v < uint32_t(surface.vertex_count()); ++v) {
    Fan& fan = fans[surface.patch[v]];
    if (cut.place[v] != kNone || !is_chosen[surface.patch[v]] || fan.border.size() > kMostOnBorder) continue;
    int64_t nearest = std::numeric_limits<int64_t>::max();
    for (const uint32_t seed : fan.border)
      nearest = std::min(nearest, distance_sq(surface.position[v], seeds.position[seed]));
    if (nearest > fan.clearance) fan.clearance = nearest, fan.middle = v;
  }
  return fans;
}

}  // namespace

std::vector<char> triangulate_as_fans(const CutSurface& cut, const std::vector<char>& is_chosen, SeededMesh& made) {
  const std::vector<Fan> fans = fans_of(cut, is_chosen, made.seeds);
  std::vector<char> is_done(is_chosen.size(), 0);
  std::vector<TriangleIndices> triangles;
  AddedSeeds added(cut, made.seeds);
  for (size_t patch = 0; patch < fans.size(); ++patch) {
    const Fan& fan = fans[patch];
    if (!is_chosen[patch] || !fan.is_possible()) continue;
    is_done[patch] = 1;
    const uint32_t middle = added.add(fan.middle);
    for (size_t i = 0; i < fan.border.size(); ++i)
      triangles.push_back({fan.border[i], fan.border[(i + 1) % fan.border.size()], middle});
  }
  if (added.empty()) return is_done;
  for (const TriangleIndices& t : made.mesh.triangles)
    if (!is_done[cut.surface.patch[made.seeds.home[t.a]]]) triangles.push_back(t);
  added.give_to(made, triangles);
  return is_done;
}

}  // namespace isoshell
