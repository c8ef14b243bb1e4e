// cut_false_handles (see backend_table.h). Growing is sequential by nature and only needed where the solid is wrong, so
// every backend uses this one.
#include <algorithm>
#include <map>
#include <string>

#include "core/copy_product.h"
#include "cpu/cpu_backend.h"
#include "cpu/executor_tbb.h"
#include "cpu/sheet/handle_cutter.h"
#include "isoshell/error.h"
#include "stages/sheet/sheet_closing_body.h"

namespace isoshell {
namespace {

constexpr int64_t kMaxBoxVoxels = int64_t(1) << 29;
constexpr int64_t kBytesPerVoxel = 3;  ///< of the box: HandleCutter's and its queues

// Ranks: what is inside by its layer, deepest first; then sites, those with their centres farthest inside first.
constexpr int kInsideRanks = 96;
int rank_of_layer(int layer) { return std::max(0, kInsideRanks - layer); }
int rank_of_site(const SiteSample& s, int outward) {
  constexpr int kFarthestQ8 = 222;  // half a voxel's diagonal
  const int above_q8 = -outward * (s.dx * s.normal.x + s.dy * s.normal.y + s.dz * s.normal.z) / 127;
  const int step = std::clamp(above_q8 + kFarthestQ8, 0, 2 * kFarthestQ8);
  return kInsideRanks + step * (HandleCutter::kRanks - 1 - kInsideRanks) / (2 * kFarthestQ8);
}

/// Bytes must not depend on how much memory there is: too little is an error.
void require_memory(int64_t bytes, const Context& context) {
  if (context.memory_limit_bytes <= 0 || bytes <= context.memory_limit_bytes) return;
  throw Error(ErrorCode::out_of_memory, "cut handles",
              "cutting false handles needs about " + std::to_string(bytes >> 20) + " MiB, more than the limit of " +
                  std::to_string(context.memory_limit_bytes >> 20) + " MiB; lower --resolution or raise --max-memory");
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

/// Calls each(step along an axis, place of the step) for a voxel's six faces.
template <class Each>
void for_each_face(const Box::Extent& extent, Each each) {
  const int64_t z = 1, y = extent.vox[2], x = y * extent.vox[1];
  each(Voxel{1, 0, 0}, x), each(Voxel{-1, 0, 0}, -x);
  each(Voxel{0, 1, 0}, y), each(Voxel{0, -1, 0}, -y);
  each(Voxel{0, 0, 1}, z), each(Voxel{0, 0, -1}, -z);
}

/// The voxels of the solid in the box.
BitPlane voxels_inside(const HandleCutter& cutter, const Box& box, const SolidView& solid) {
  const Box::Extent extent = box.extent();
  BitPlane inside(int64_t(extent.vox[0]) * extent.vox[1] * extent.vox[2]);
  for (int32_t lx = box.first.x; lx <= box.last.x; ++lx)
    for (int32_t ly = box.first.y; ly <= box.last.y; ++ly)
      for (int32_t lz = box.first.z; lz <= box.last.z; ++lz) {
        const SolidLeaf leaf = solid.at({lx, ly, lz});
        for (int32_t x = 0; x < 8; ++x)
          for (int32_t y = 0; y < 8; ++y)
            if (const uint64_t row = leaf.word(x) >> 8 * y & 255)
              inside.set_from(cutter.index_of(box.inside({8 * lx + x, 8 * ly + y, 8 * lz})), row);
      }
  return inside;
}

/// Enters the solid with its ranks.
class SolidEntry {
 public:
  SolidEntry(HandleCutter& cutter, const Box& box, const SolidView& solid)
      : cutter_(cutter), box_(box), inside_(voxels_inside(cutter, box, solid)) {}

  void add(const VoxelSetView& sites, const SiteSamples& samples) {
    std::vector<int64_t> front(size_t(sites.first[sites.leaf_key.size]));
    for (int64_t l = 0; l < sites.leaf_key.size; ++l)
      for_each_active(sites, l, [&](int offset, int64_t site) {
        const int64_t v = cutter_.index_of(box_.inside(voxel_at(leaf_of_key(sites.leaf_key[l]), offset)));
        cutter_.add(v, 0);
        front[size_t(site)] = v;
      });
    const int outward = side_of_normals(front, samples);
    for (size_t site = 0; site < front.size(); ++site)
      cutter_.add(front[site], rank_of_site(samples.sample[int64_t(site)], outward));
    for (int layer = 1; !front.empty(); ++layer) {
      std::vector<int64_t> next;
      for (const int64_t v : front)
        for_each_face(box_.extent(), [&](Voxel, int64_t step) {
          if (!is_to_add(v + step)) return;
          cutter_.add(v + step, rank_of_layer(layer));
          next.push_back(v + step);
        });
      front.swap(next);
    }
  }

 private:
  bool is_to_add(int64_t voxel) const { return inside_[voxel] && !cutter_.is_solid(voxel); }

  /// 1 when most normals of sites point away from what is inside, -1 when the input is inside out.
  int side_of_normals(const std::vector<int64_t>& sites, const SiteSamples& samples) const {
    int64_t away = 0;
    for (size_t site = 0; site < sites.size(); ++site)
      for_each_face(box_.extent(), [&](Voxel face, int64_t step) {
        if (!is_to_add(sites[site] + step)) return;
        const Normal8 n = samples.sample[int64_t(site)].normal;
        away -= face.x * n.x + face.y * n.y + face.z * n.z;
      });
    return away < 0 ? -1 : 1;
  }

  HandleCutter& cutter_;
  const Box& box_;
  const BitPlane inside_;
};

/// The sites less the cuts, with the solid that surrounds those: a wall again.
SiteSet solid_around(CpuExecutor& exec, const HandleCutter& cutter, const Box& box, const SiteSet& of) {
  const VoxelSetView sites = of.voxels.view();
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
      voxel_set_of(exec, View<const uint64_t>(key.view()), View<const LeafMask>(mask.view()), BlockExtent(sites).vox),
      of.hollows.to_host()};
}

}  // namespace

SiteSet CpuBackend::cut_false_handles(const SiteSet& sites, const SiteSamples& samples, int64_t genus,
                                      Context& context) const {
  CpuExecutor exec(context, "cut handles");
  return run_with_threads(context, [&]() -> SiteSet {
    const OnHost<SiteSet> here(sites);
    const VoxelSetView site_view = here->voxels.view();
    const Box box(site_view);
    const Box::Extent extent = box.extent();
    const int64_t voxels = int64_t(extent.vox[0]) * extent.vox[1] * extent.vox[2];
    if (voxels > kMaxBoxVoxels) return {};
    require_memory(voxels * kBytesPerVoxel, context);
    HandleCutter cutter(extent.vox);
    {
      Solid solid = sheet_steps::complement_of_outside(exec, site_view, here->hollows.view());
      SolidEntry(cutter, box, solid.view()).add(site_view, *OnHost<SiteSamples>(samples));
    }
    cutter.grow(std::max<int64_t>(0, genus), [&] { check_cancel(context, "cut handles"); });
    if (genus == kUnknownGenus) cutter.close_cuts_below(kInsideRanks);
    return solid_around(exec, cutter, box, *here);
  });
}

}  // namespace isoshell
