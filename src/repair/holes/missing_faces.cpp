#include "repair/holes/missing_faces.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "repair/holes/fill_plane.h"

namespace isoshell::repair {
namespace {

constexpr size_t kMostRims = 2000;  // parts have fewer, scans have more holes that are triangles

struct Rim {
  const Loop* loop;
  FlatRim flat;
  uint32_t patch;
};

/// Which side of its plane the surface at a loop lies on.
enum class Side { behind, before, both };
Side side_of_surface(const RepairMesh& mesh, const Loop& loop, const FlatRim& rim) {
  bool behind = false, before = false;
  for (const uint32_t h : loop) {
    const double height = rim.height(mesh.position[mesh.to(next_in_triangle(h))]);
    behind |= height < rim.tolerance;  // what lies in the plane is on both sides
    before |= height > -rim.tolerance;
  }
  return behind && before ? Side::both : behind ? Side::behind : Side::before;
}

bool surrounds(const RepairMesh& mesh, const Rim& outer, const Rim& inner) {
  if (!(inner.flat.area < outer.flat.area) || dot(outer.flat.normal, inner.flat.normal) > 0) return false;
  const auto is_off = [&](uint32_t h) { return !outer.flat.holds(mesh.position[mesh.from(h)]); };
  if (std::any_of(inner.loop->begin(), inner.loop->end(), is_off)) return false;
  return is_inside(mesh, outer.flat, *outer.loop, mesh.position[mesh.from(inner.loop->front())]);
}

/// The smallest of some rims around another; null where there is none.
const Rim* around(const RepairMesh& mesh, const std::vector<Rim>& outers, const Rim& inner) {
  const Rim* found = nullptr;
  for (const Rim& outer : outers)
    if ((!found || outer.flat.area < found->flat.area) && surrounds(mesh, outer, inner)) found = &outer;
  return found;
}

}  // namespace

std::vector<Cap> find_missing_faces(const RepairMesh& mesh, const std::vector<Loop>& loops) {
  const Patches patches = find_patches(mesh);
  std::vector<Rim> outers, inners;
  for (const Loop& loop : loops) {
    const std::optional<FlatRim> flat = flat_rim(mesh, loop);
    if (!flat) continue;
    const Side side = side_of_surface(mesh, loop, *flat);
    if (side != Side::both) (side == Side::behind ? outers : inners).push_back({&loop, *flat, patches.of[loop[0] / 3]});
  }
  if (outers.size() + inners.size() > kMostRims) return {};
  std::map<const Rim*, std::vector<const Rim*>> inside;  // by address: in the order of the loops
  for (const Rim& inner : inners)
    if (const Rim* outer = around(mesh, outers, inner)) inside[outer].push_back(&inner);
  std::vector<Cap> faces;
  for (const auto& [outer, holes] : inside) {
    if (std::all_of(holes.begin(), holes.end(), [&, patch = outer->patch](const Rim* h) { return h->patch == patch; }))
      continue;
    Loop all = *outer->loop;
    for (const Rim* hole : holes) all.insert(all.end(), hole->loop->begin(), hole->loop->end());
    std::vector<Corners> between = fill_plane(mesh, outer->flat, all);
    if (!between.empty()) faces.push_back({std::move(all), std::move(between), 1 + int(holes.size())});
  }
  return faces;
}

}  // namespace isoshell::repair
