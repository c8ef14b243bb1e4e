#include "cpu/sites/list_site_triangles.h"

#include <algorithm>
#include <utility>
#include <vector>

namespace isoshell {
namespace {

constexpr int64_t kLeaves = 32;  ///< of a list

/// Lists the triangles of one leaf after the other.
class SiteLists {
 public:
  SiteLists(const SurfaceView& surface, const VoxelSetView& sites, const LeafTriangles& lists)
      : surface_(surface), sites_(sites), lists_(lists) {}

  /// Appends to `listed`, site by site, and counts.
  void list(int64_t leaf, View<int64_t> count, std::vector<uint32_t>& listed) {
    const uint32_t* triangles = &lists_.triangle[lists_.first[leaf]];
    const auto triangle_count = size_t(lists_.first[leaf + 1] - lists_.first[leaf]);
    met_.assign(triangle_count, {});
    uint32_t place[512] = {};
    const Voxel at = leaf_of_key(sites_.leaf_key[leaf]);
    for (size_t t = 0; t < triangle_count; ++t) {
      mark_voxels(surface_.triangle(triangles[t]), at, met_[t]);
      for_each_met(met_[t], leaf, [&](int offset) { ++place[offset]; });
    }
    auto end = uint32_t(listed.size());
    for_each_active(sites_, leaf, [&](int offset, int64_t site) {
      count[site] = place[offset];
      end += std::exchange(place[offset], end);
    });
    listed.resize(end);
    for (size_t t = 0; t < triangle_count; ++t)
      for_each_met(met_[t], leaf, [&](int offset) { listed[place[offset]++] = triangles[t]; });
  }

 private:
  template <class Visit>
  void for_each_met(const LeafMask& met, int64_t leaf, Visit visit) const {
    for (int w = 0; w < 8; ++w)
      for (uint64_t bits = met.word[w] & sites_.mask[leaf].word[w]; bits; bits &= bits - 1)
        visit(w * 64 + lowest_bit(bits));
  }

  const SurfaceView surface_;
  const VoxelSetView sites_;
  const LeafTriangles& lists_;
  std::vector<LeafMask> met_;  ///< by each triangle of the leaf
};

}  // namespace

void CpuListSiteTriangles::run(CpuExecutor& exec, const SurfaceView& surface, const VoxelSetView& sites,
                               const LeafTriangles& lists, SiteSamples& out) {
  const int64_t leaves = sites.leaf_key.size, chunks = (leaves + kLeaves - 1) / kLeaves;
  std::vector<std::vector<uint32_t>> listed(static_cast<size_t>(chunks));
  exec.for_each("list site triangles", chunks, [&](int64_t c) {
    SiteLists site_lists(surface, sites, lists);
    for (int64_t leaf = c * kLeaves; leaf < std::min(leaves, (c + 1) * kLeaves); ++leaf)
      site_lists.list(leaf, out.first.view(), listed[size_t(c)]);
  });
  out.triangles = Buffer<uint32_t>(exec.exclusive_scan(out.first.view()));
  exec.for_each("join site triangles", chunks, [&](int64_t c) {
    std::vector<uint32_t>& part = listed[size_t(c)];
    std::copy(part.begin(), part.end(), out.triangles.begin() + out.first[sites.first[c * kLeaves]]);
    part = {};
  });
}

}  // namespace isoshell
