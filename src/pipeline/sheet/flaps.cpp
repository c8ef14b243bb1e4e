// See flaps.h.
#include "pipeline/sheet/flaps.h"

#include <cmath>
#include <cstdlib>
#include <map>
#include <utility>

#include "core/copy_product.h"
#include "core/voxel_set.h"
#include "isoshell/advanced/to_host.h"
#include "pipeline/grid/thin_walls.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr int32_t kDeepest = 4;           // voxels of a flap's sites, from one side to the other
constexpr int64_t kMostThicknessQ8 = 64;  // between its sides, as they are laid onto the surface

using LeafMasks = std::map<uint64_t, LeafMask>;

void add(LeafMasks& to, Voxel v) {
  const int offset = offset_in_leaf(v);
  to[leaf_key(leaf_of_voxel(v))].word[offset >> 6] |= uint64_t(1) << (offset & 63);
}
void add(LeafMasks& to, const VoxelSet& voxels) {
  for (int64_t leaf = 0; leaf < voxels.leaf_count(); ++leaf) {
    LeafMask& mask = to[voxels.leaf_key[leaf]];
    for (int x = 0; x < 8; ++x) mask.word[x] |= voxels.mask[leaf].word[x];
  }
}
/// On the lattice of `like`.
VoxelSet voxel_set_of(const LeafMasks& leaves, const VoxelSet& like) {
  VoxelSet set;
  set.leaf_key = Buffer<uint64_t>(int64_t(leaves.size()));
  set.mask = Buffer<LeafMask>(int64_t(leaves.size()));
  int64_t i = 0;
  for (const auto& [key, mask] : leaves) {
    set.leaf_key[i] = key;
    set.mask[i++] = mask;
  }
  const int32_t extent_vox[3] = {like.block_dims[0] * 128, like.block_dims[1] * 128, like.block_dims[2] * 128};
  index_host_leaves(set, extent_vox);
  return set;
}

template <class Each>
void for_each_voxel_around(Voxel corner, Each each) {
  for (int o = 0; o < 8; ++o) each(Voxel{corner.x - (o >> 2), corner.y - (o >> 1 & 1), corner.z - (o & 1)});
}

/// Whether normals are more than 120 degrees apart.
bool face_away(Normal8 a, Normal8 b) { return dot(a, b) < 0 && 4 * dot(a, b) * dot(a, b) > dot(a, a) * dot(b, b); }

/// The lattice axis nearest to the direction opposite of a normal.
Voxel inward_axis(Normal8 n) {
  const int x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  if (x >= y && x >= z) return {n.x < 0 ? 1 : -1, 0, 0};
  return y >= z ? Voxel{0, n.y < 0 ? 1 : -1, 0} : Voxel{0, 0, n.z < 0 ? 1 : -1};
}

/// Vertices of the sheet that lie on another one which looks the other way: on the same faces.
std::vector<uint8_t> find_two_sided(const Sheet& sheet) {
  const VoxelSetView corners = sheet.corners.view();
  std::vector<uint8_t> two_sided(size_t(sheet.vertex_count()));
  const auto lie_together = [&](int64_t v, int64_t w) {
    if (!face_away(sheet.normal[v], sheet.normal[w])) return false;
    const PointQ8 p = sheet.position[v], q = sheet.position[w];
    const Normal8 n = sheet.normal[v];
    const int64_t along = int64_t(q.x - p.x) * n.x + int64_t(q.y - p.y) * n.y + int64_t(q.z - p.z) * n.z;
    return along * along <= kMostThicknessQ8 * kMostThicknessQ8 * dot(n, n);
  };
  for_each_voxel(sheet.corners.view(), [&](Voxel c, int64_t v) {
    if (sheet.source_triangle[v] == kNone) return;
    const Voxel axis = inward_axis(sheet.normal[v]);
    for (int32_t k = 1; k <= kDeepest; ++k) {
      const int64_t w = find_voxel(corners, {c.x + k * axis.x, c.y + k * axis.y, c.z + k * axis.z});
      if (w < 0 || sheet.source_triangle[w] == kNone || !lie_together(v, w)) continue;
      two_sided[size_t(v)] = two_sided[size_t(w)] = 1;
      return;
    }
  });
  return two_sided;
}

/// Marks what is within a triangle of a marked vertex.
std::vector<uint8_t> spread(const Sheet& sheet, const std::vector<uint8_t>& marked) {
  std::vector<uint8_t> out = marked;
  for (const TriangleIndices t : sheet.triangles)
    if (marked[t.a] || marked[t.b] || marked[t.c]) out[t.a] = out[t.b] = out[t.c] = 1;
  return out;
}

/// Sites of flaps: along sharp edges sides meet too, but in no more than a line of vertices.
SiteSet sites_of_flaps(const SiteSet& sites, const Sheet& sheet) {
  const std::vector<uint8_t> two_sided = find_two_sided(sheet);
  std::vector<uint8_t> other(two_sided.size());
  for (size_t v = 0; v < other.size(); ++v) other[v] = !two_sided[v];
  std::vector<uint8_t> inner = spread(sheet, other);
  for (uint8_t& mark : inner) mark = !mark;
  const std::vector<uint8_t> near_inner = spread(sheet, inner);
  const VoxelSetView voxels = sites.voxels.view();
  LeafMasks leaves;
  for_each_voxel(sheet.corners.view(), [&](Voxel c, int64_t v) {
    if (!two_sided[size_t(v)] || !near_inner[size_t(v)]) return;
    for_each_voxel_around(c, [&](Voxel o) {
      if (find_voxel(voxels, o) >= 0) add(leaves, o);
    });
  });
  if (leaves.empty()) return {};
  return {voxel_set_of(leaves, sites.voxels)};
}

/// Lays vertices onto the surface as `laid` has them, but those at `grown` voxels. Returns the vertex that each one of
/// `laid` is now, kNone where there is none.
std::vector<uint32_t> lay_as(const Sheet& laid, const VoxelSet& grown, Sheet& sheet) {
  const VoxelSetView laid_corners = laid.corners.view(), grown_voxels = grown.view();
  std::vector<uint32_t> now(size_t(laid.vertex_count()), kNone);
  for_each_voxel(sheet.corners.view(), [&](Voxel c, int64_t v) {
    bool is_grown = false;
    for_each_voxel_around(c, [&](Voxel o) { is_grown |= find_voxel(grown_voxels, o) >= 0; });
    const int64_t w = is_grown ? -1 : find_voxel(laid_corners, c);
    if (w < 0) return;
    sheet.position[v] = laid.position[w];
    sheet.normal[v] = laid.normal[w];
    sheet.source_triangle[v] = laid.source_triangle[w];
    now[size_t(w)] = uint32_t(v);
  });
  return now;
}

/// Off-surface points stay with the vertices that are laid. Those at flaps go: the walls are grown away from them.
void keep_off_surface(const Sheet& laid, const std::vector<uint32_t>& now, Sheet& sheet) {
  std::vector<int64_t> kept;
  for (int64_t i = 0; i < laid.missed.size(); ++i)
    if (now[laid.missed_vertex[i]] != kNone) kept.push_back(i);
  sheet.missed = Buffer<PointQ8>(int64_t(kept.size()));
  sheet.missed_vertex = Buffer<uint32_t>(int64_t(kept.size()));
  for (size_t k = 0; k < kept.size(); ++k) {
    sheet.missed[int64_t(k)] = laid.missed[kept[k]];
    sheet.missed_vertex[int64_t(k)] = now[laid.missed_vertex[kept[k]]];
  }
}

/// The sheet of the solid together with all voxels within `grown_vox` of some sites. What is not within that of them
/// stays as it was laid.
void grow_at(PreparedSurface& p, const SiteSet& where, int32_t grown_vox, int64_t smallest_component_q16,
             Context& context) {
  const SiteSet solid = host_copy(solid_voxels_of(p));
  const SheetOptions options{closing_of_solid(p), smallest_component_q16, kNoGenus, false};
  const Sheet laid = std::move(on_host(p.sheet));
  const VoxelSet grown = host_copy(build_shell(where, {grown_vox}, context)).voxels;
  LeafMasks leaves;
  add(leaves, solid.voxels);
  add(leaves, grown);
  if (!p.grown) p.grown = {grown_vox, true, {}};
  p.grown.voxels = {voxel_set_of(leaves, solid.voxels), solid.hollows.to_host()};
  p.sheet = {};
  p.sheet = build_proxy(p.grown.voxels, p.surface.frame, options, context);
  const std::vector<uint32_t> now = lay_as(laid, grown, on_host(p.sheet));
  keep_off_surface(laid, now, p.sheet);
  p.sheet.topology.bridged_vertices = laid.topology.bridged_vertices;  // the proxy has no sources of its own
}

}  // namespace

bool grow_flaps(PreparedSurface& p, int32_t grown_vox, int64_t smallest_component_q16, Context& context) {
  const SiteSet flaps = sites_of_flaps(*OnHost(p.sites), *OnHost(p.sheet));
  if (flaps.voxels.voxel_count() == 0) return false;
  grow_at(p, flaps, grown_vox, smallest_component_q16, context);
  return true;
}

}  // namespace isoshell
