// cut_false_handles (see backend_table.h). Growing is sequential by nature and only needed where the solid is wrong, so
// every backend uses this one.
#include <algorithm>
#include <map>

#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/handle_cutter.h"
#include "stages/sheet_closing_body.h"

namespace isoshell {
namespace {

constexpr int64_t kMaxBoxVoxels = int64_t(1) << 30;
constexpr int64_t kBytesPerVoxel = 3;  ///< of the box: HandleCutter's two and its queues

// Ranks: what is inside by its layer, deepest first; then sites, those with their centres farthest inside first.
constexpr int kInsideRanks = 96;
int rank_of_layer(int layer) { return std::max(0, kInsideRanks - layer); }
int rank_of_site(const SiteSample& s) {
  constexpr int kFarthestQ8 = 222;  // half a voxel's diagonal
  const int above_q8 = -(s.dx * s.normal.x + s.dy * s.normal.y + s.dz * s.normal.z) / 127;
  const int step = std::clamp(above_q8 + kFarthestQ8, 0, 2 * kFarthestQ8);
  return kInsideRanks + step * (HandleCutter::kRanks - 1 - kInsideRanks) / (2 * kFarthestQ8);
}

/// The voxels around all sites, and a layer more.
struct Box {
  Voxel first, last;  ///< leaves
  explicit Box(const VoxelSetView& sites) : first(leaf_of_key(sites.leaf_key[0])), last(first) {
    for (int64_t l = 1; l < sites.leaf_key.size; ++l) {
      const Voxel v = leaf_of_key(sites.leaf_key[l]);
      first = {std::min(first.x, v.x), std::min(first.y, v.y), std::min(first.z, v.z)};
      last = {std::max(last.x, v.x), std::max(last.y, v.y), std::max(last.z, v.z)};
    }
  }
  struct Extent {
    int32_t vox[3];
  };
  Extent extent() const {
    return {{8 * (last.x - first.x) + 10, 8 * (last.y - first.y) + 10, 8 * (last.z - first.z) + 10}};
  }
  Voxel inside(Voxel v) const { return {v.x - 8 * first.x + 1, v.y - 8 * first.y + 1, v.z - 8 * first.z + 1}; }
  Voxel outside(Voxel v) const { return {v.x + 8 * first.x - 1, v.y + 8 * first.y - 1, v.z + 8 * first.z - 1}; }
};

/// Enters the solid with its ranks.
void add_solid(HandleCutter& cutter, const Box& box, const SolidView& solid, const VoxelSetView& sites,
               const SiteSamples& samples) {
  std::vector<int64_t> front;
  for (int64_t l = 0; l < sites.leaf_key.size; ++l)
    for_each_active(sites, l, [&](int offset, int64_t site) {
      const int64_t v = cutter.index_of(box.inside(voxel_at(leaf_of_key(sites.leaf_key[l]), offset)));
      cutter.add(v, rank_of_site(samples.sample[site]));
      front.push_back(v);
    });
  const auto is_inside = [&](int64_t voxel) {
    const Voxel v = box.outside(cutter.voxel_of(voxel));
    return solid.at(leaf_of_voxel(v)).word((v.x & 7)) >> (offset_in_leaf(v) & 63) & 1;
  };
  const Box::Extent extent = box.extent();
  const int64_t step[3] = {int64_t(extent.vox[1]) * extent.vox[2], extent.vox[2], 1};
  for (int layer = 1; !front.empty(); ++layer) {
    std::vector<int64_t> next;
    for (const int64_t v : front)
      for (const int64_t s : step)
        for (const int64_t n : {v - s, v + s})
          if (!cutter.is_solid(n) && is_inside(n)) {
            cutter.add(n, rank_of_layer(layer));
            next.push_back(n);
          }
    front.swap(next);
  }
}

/// The sites less the cuts, with the solid that surrounds those: a wall again.
SiteSet walls_around(TbbExecutor& exec, const HandleCutter& cutter, const Box& box, const VoxelSetView& sites) {
  std::map<uint64_t, LeafMask> leaves;
  for (int64_t l = 0; l < sites.leaf_key.size; ++l) leaves.emplace_hint(leaves.end(), sites.leaf_key[l], sites.mask[l]);
  const auto word_of = [&](Voxel v) -> uint64_t& {
    return leaves[leaf_key(leaf_of_voxel(v))].word[offset_in_leaf(v) >> 6];
  };
  for (const int64_t cut : cutter.cuts()) {
    const Voxel c = cutter.voxel_of(cut), v = box.outside(c);
    word_of(v) &= ~(uint64_t(1) << (offset_in_leaf(v) & 63));
    for (int n = 0; n < 27; ++n) {
      const Voxel near = neighbour_leaf(v, n);  // the same 27 steps
      if (cutter.is_grown(cutter.index_of(neighbour_leaf(c, n))))
        word_of(near) |= uint64_t(1) << (offset_in_leaf(near) & 63);
    }
  }
  Buffer<uint64_t> key(int64_t(leaves.size()));
  Buffer<LeafMask> mask(int64_t(leaves.size()));
  int64_t at = 0;
  for (const auto& leaf : leaves) {
    key[at] = leaf.first;
    mask[at++] = leaf.second;
  }
  return {
      voxel_set_of(exec, View<const uint64_t>(key.view()), View<const LeafMask>(mask.view()), BlockExtent(sites).vox)};
}

}  // namespace

SiteSet cpu_cut_false_handles(const SiteSet& sites, const SiteSamples& samples, int64_t genus, Context& context) {
  TbbExecutor exec(context, "cut handles");
  return run_with_threads(context, [&]() -> SiteSet {
    const OnHost<SiteSet> here(sites);
    const VoxelSetView site_view = here->voxels.view();
    const Box box(site_view);
    const Box::Extent extent = box.extent();
    const int64_t voxels = int64_t(extent.vox[0]) * extent.vox[1] * extent.vox[2];
    if (voxels > kMaxBoxVoxels) return {};
    if (context.memory_limit_bytes > 0 && voxels * kBytesPerVoxel > context.memory_limit_bytes) return {};
    HandleCutter cutter(extent.vox);
    {
      Solid solid = sheet_steps::complement_of_outside(exec, site_view);
      add_solid(cutter, box, solid.view(), site_view, *OnHost<SiteSamples>(samples));
    }
    cutter.grow(genus, [&] { check_cancel(context, "cut handles"); });
    return walls_around(exec, cutter, box, site_view);
  });
}

}  // namespace isoshell
