#include "repair/solids/hollows.h"

#include <cstdlib>
#include <optional>

#include "core/index_sets.h"
#include "core/voxel_set.h"
#include "repair/solids/winding.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr int64_t kWays = 4096;       // tried for a component, at most twice as many
constexpr int32_t kThickestWall = 3;  // voxels of the component's own sites that a way starts in

Voxel axis_of(Normal8 n) {
  const int x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x >= y && x >= z) return {n.x < 0 ? -1 : 1, 0, 0};
  return y >= z ? Voxel{0, n.y < 0 ? -1 : 1, 0} : Voxel{0, 0, n.z < 0 ? -1 : 1};
}

Voxel along(Voxel v, Voxel axis, int32_t steps) {
  return {v.x + steps * axis.x, v.y + steps * axis.y, v.z + steps * axis.z};
}

/// Where a lattice surface has been wound around a point as often forth as back: not in solid.
class Outside {
 public:
  explicit Outside(const LatticeSurface& surface) {
    for (const PointQ8 p : surface.points) points_.push_back({double(p.x), double(p.y), double(p.z)});
    for (const TriangleIndices t : surface.triangles) faces_.push_back({t.a, t.b, t.c});
    rays_.emplace(points_, faces_);
  }
  bool holds(Voxel v) const {
    const auto middle = [](int32_t i) { return (i + 0.5) * kOneVoxelQ8; };
    int number = 0;
    rays_->for_each_crossing({middle(v.x), middle(v.y), middle(v.z)}, kNone,
                             [&](uint32_t, int sign) { number += sign; });
    return number == 0;
  }

 private:
  std::vector<WorldPoint> points_;
  std::vector<std::array<uint32_t, 3>> faces_;
  std::optional<RayColumns> rays_;
};

/// A component that looks inward, and the longest way through its hollow.
struct Hollow {
  Vec64 doubled_area = {0, 0, 0};  ///< of a closed component none
  double six_volume = 0;
  int64_t sites = 0, seen = 0;
  int32_t longest = 0;
  Voxel middle = {0, 0, 0};

  bool looks_inward() const {
    return doubled_area.x == 0 && doubled_area.y == 0 && doubled_area.z == 0 && six_volume < 0;
  }
};

class HollowFinder {
 public:
  HollowFinder(const LatticeSurface& surface, const SiteSet& sites)
      : surface_(surface),
        sites_(sites.voxels.view()),
        sets_(surface.points.size()),
        hollow_(size_t(surface.points.size())) {
    for (const TriangleIndices t : surface.triangles) {
      sets_.unite(t.a, t.b);
      sets_.unite(t.a, t.c);
    }
    for (const TriangleIndices t : surface.triangles) {
      const PointQ8 a = surface.points[t.a], start = surface.points[0];
      const Vec64 n = cross(difference(surface.points[t.b], a), difference(surface.points[t.c], a));
      const Vec64 from = difference(a, start);
      Hollow& h = hollow_of(t);
      h.doubled_area = h.doubled_area + n;
      h.six_volume += double(from.x) * double(n.x) + double(from.y) * double(n.y) + double(from.z) * double(n.z);
    }
  }
  Hollow& hollow_of(TriangleIndices t) { return hollow_[sets_.root(t.a)]; }

  /// A hollow too small for voxels is left through its other side: what lies beyond is no hollow.
  void follow(Voxel site, Normal8 normal, Hollow& hollow) {
    const Voxel axis = axis_of(normal);
    int32_t first = 1;
    while (first <= kThickestWall && is_site(along(site, axis, first))) ++first;
    int32_t last = first;
    for (; !is_site(along(site, axis, last)); ++last)
      if (is_beyond(along(site, axis, last))) return;
    const Voxel middle = along(site, axis, (first + last) / 2);
    if (last - first <= hollow.longest) return;
    if (!outside_) outside_.emplace(surface_);
    if (!outside_->holds(middle)) return;
    hollow.longest = last - first;
    hollow.middle = middle;
  }

  std::vector<Voxel> middles() const {
    std::vector<Voxel> out;
    for (const Hollow& h : hollow_)
      if (h.longest > 0) out.push_back(h.middle);
    return out;
  }

 private:
  bool is_site(Voxel v) const { return find_voxel(sites_, v) >= 0; }
  bool is_beyond(Voxel v) const {
    return v.x < 0 || v.y < 0 || v.z < 0 || v.x >= sites_.block_dims[0] * 128 || v.y >= sites_.block_dims[1] * 128 ||
           v.z >= sites_.block_dims[2] * 128;
  }

  const LatticeSurface& surface_;
  const VoxelSetView sites_;
  IndexSets sets_;
  std::optional<Outside> outside_;
  std::vector<Hollow> hollow_;  ///< per point, at the roots
};

}  // namespace

std::vector<Voxel> find_hollows(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples) {
  HollowFinder finder(surface, sites);
  const auto for_each_inner = [&](auto each) {
    for_each_voxel(sites.voxels.view(), [&](Voxel v, int64_t site) {
      const SiteSample& s = samples.sample[site];
      Hollow& hollow = finder.hollow_of(surface.triangles[s.triangle]);
      if (hollow.looks_inward()) each(hollow, v, s.normal);
    });
  };
  for_each_inner([](Hollow& hollow, Voxel, Normal8) { ++hollow.sites; });
  for_each_inner([&](Hollow& hollow, Voxel v, Normal8 normal) {
    if (hollow.seen++ % std::max<int64_t>(1, hollow.sites / kWays) == 0) finder.follow(v, normal, hollow);
  });
  return finder.middles();
}

}  // namespace isoshell
