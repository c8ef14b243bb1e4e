// sample_sites (see stages.h), written once over an executor. Works leaf by leaf: a leaf's sites are its own, so
// counting and filling need no atomics, and a leaf's ascending triangle list makes ascending lists of its sites.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sites/leaf_triangles.h"
#include "voxel/closest_point.h"
#include "voxel/heap_sort.h"

namespace isoshell {

struct SortLeafTriangles {
  View<const int64_t> first;
  View<uint32_t> triangle;
  ISOSHELL_HD void operator()(int64_t l) const { sort_ascending(&triangle[first[l]], first[l + 1] - first[l]); }
};

/// Triangles per site.
struct CountSiteTriangles {
  SurfaceView surface;
  VoxelSetView sites;
  View<const int64_t> leaf_first;
  View<const uint32_t> leaf_triangle;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t l) const {
    const Voxel leaf = leaf_of_key(sites.leaf_key[l]);
    uint32_t seen[512] = {};
    for (int64_t i = leaf_first[l]; i < leaf_first[l + 1]; ++i) {
      LeafMask met = {};
      mark_voxels(surface.triangle(leaf_triangle[i]), leaf, met);
      for (int w = 0; w < 8; ++w)
        for (uint64_t bits = met.word[w]; bits; bits &= bits - 1) ++seen[w * 64 + lowest_bit(bits)];
    }
    for_each_active(sites, l, [&](int offset, int64_t site) { count[site] = seen[offset]; });
  }
};

struct FillSiteTriangles {
  SurfaceView surface;
  VoxelSetView sites;
  View<const int64_t> leaf_first;
  View<const uint32_t> leaf_triangle;
  View<const int64_t> first;
  View<uint32_t> triangles;
  ISOSHELL_HD void operator()(int64_t l) const {
    const Voxel leaf = leaf_of_key(sites.leaf_key[l]);
    int64_t cursor[512];
    for_each_active(sites, l, [&](int offset, int64_t site) { cursor[offset] = first[site]; });
    for (int64_t i = leaf_first[l]; i < leaf_first[l + 1]; ++i) {
      LeafMask met = {};
      mark_voxels(surface.triangle(leaf_triangle[i]), leaf, met);
      for (int w = 0; w < 8; ++w)
        for (uint64_t bits = met.word[w] & sites.mask[l].word[w]; bits; bits &= bits - 1)
          triangles[cursor[w * 64 + lowest_bit(bits)]++] = leaf_triangle[i];
    }
  }
};

/// A normal costs more than a distance, and a triangle has many sites.
struct FindNormals {
  SurfaceView surface;
  View<Normal8> normal;
  ISOSHELL_HD void operator()(int64_t t) const { normal[t] = normal8(triangle_normal(surface.triangle(t))); }
};

struct SampleSites {
  SurfaceView surface;
  VoxelSetView sites;
  View<const int64_t> first;
  View<const uint32_t> triangles;
  View<const Normal8> normal;
  View<SiteSample> sample;
  ISOSHELL_HD void operator()(int64_t l) const {
    const Voxel leaf = leaf_of_key(sites.leaf_key[l]);
    for_each_active(sites, l, [&](int offset, int64_t site) {
      const Voxel v = voxel_at(leaf, offset);
      sample[site] = nearest({v.x * 256 + 128, v.y * 256 + 128, v.z * 256 + 128}, site);
    });
  }
  ISOSHELL_HD SiteSample nearest(PointQ8 centre, int64_t site) const {
    int64_t best_sq = int64_t(1) << 62;
    PointQ8 best = centre;
    uint32_t from = kNone;
    for (int64_t i = first[site]; i < first[site + 1]; ++i) {
      const TriangleIndices t = surface.triangles[triangles[i]];
      const PointQ8 p =
          closest_point_on_triangle(centre, surface.points[t.a], surface.points[t.b], surface.points[t.c]);
      const int64_t sq = distance_sq_q16(p, centre);
      if (sq < best_sq) best_sq = sq, best = p, from = triangles[i];
    }
    SiteSample s = {};
    s.triangle = from;
    if (from == kNone) return s;
    s.dx = int16_t(best.x - centre.x);
    s.dy = int16_t(best.y - centre.y);
    s.dz = int16_t(best.z - centre.z);
    s.normal = normal[from];
    return s;
  }
};

/// Fills out.triangles; out.first holds zeros, then the offsets.
struct PlainListSiteTriangles {
  template <class Exec>
  static void run(Exec& exec, const SurfaceView& surface, const VoxelSetView& sites, const LeafTriangles& lists,
                  SiteSamples& out) {
    const int64_t leaves = sites.leaf_key.size;
    exec.for_each("count site triangles", leaves,
                  CountSiteTriangles{surface, sites, lists.first.view(), lists.triangle.view(), out.first.view()});
    out.triangles = exec.template make<uint32_t>(exec.exclusive_scan(out.first.view()));
    exec.for_each("fill site triangles", leaves,
                  FillSiteTriangles{surface, sites, lists.first.view(), lists.triangle.view(), out.first.view(),
                                    out.triangles.view()});
  }
};

template <class Exec>
SiteSamples sample_sites_body(Exec& exec, const LatticeSurface& surface, const SiteSet& sites) {
  const VoxelSetView set = sites.voxels.view();
  const SurfaceView triangles = view_of(surface);
  const BlockGrid grid = {{set.block_dims[0], set.block_dims[1], set.block_dims[2]}};
  const Buffer<Tile> tiles = find_tiles(exec, surface, grid);
  LeafTriangles lists = find_leaf_triangles(exec, surface, grid, tiles.view(), set);
  const int64_t leaves = sites.voxels.leaf_count(), count = sites.voxels.voxel_count();
  exec.for_each("sort leaf triangles", leaves, SortLeafTriangles{lists.first.view(), lists.triangle.view()});

  SiteSamples out;
  out.first = exec.template make<int64_t>(count + 1);
  exec.fill(out.first.view(), int64_t(0));
  Exec::Kernels::ListSiteTriangles::run(exec, triangles, set, lists, out);
  out.sample = exec.template make<SiteSample>(count);
  Buffer<Normal8> normal = exec.template make<Normal8>(surface.triangles.size());
  exec.for_each("find normals", normal.size(), FindNormals{triangles, normal.view()});
  exec.for_each("sample sites", leaves,
                SampleSites{triangles, set, out.first.view(), out.triangles.view(), normal.view(), out.sample.view()});
  return out;
}

}  // namespace isoshell
