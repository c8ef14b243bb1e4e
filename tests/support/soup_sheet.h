// A Sheet straight from a closed soup, for tests of the stages after it: vertex i of the sheet stands for the voxel its
// position lies in, so the soup's vertices must lie in different voxels.
#pragma once

#include <algorithm>
#include <map>
#include <stdexcept>
#include <vector>

#include "core/voxel_set.h"
#include "isoshell/advanced/sheet.h"
#include "isoshell/surface_source.h"
#include "voxel/exact_int.h"
#include "voxel/leaf.h"

namespace isoshell {

template <class T>
Buffer<T> to_buffer(const std::vector<T>& values) {
  Buffer<T> out{int64_t(values.size())};
  std::copy(values.begin(), values.end(), out.begin());
  return out;
}

/// Blocks and extent of a surface whose vertices are the voxels of a set.
inline void cut_into_blocks(const VoxelSet& corners, SurfaceMesh& surface) {
  for (int axis = 0; axis < 3; ++axis) surface.extent_vox[axis] = corners.block_dims[axis] * 128;
  surface.blocks.first = corners.first.to_host();
  surface.blocks.centre = Buffer<PointQ8>(corners.leaf_count());
  for (int64_t l = 0; l < corners.leaf_count(); ++l) {
    const Voxel leaf = leaf_of_key(corners.leaf_key[l]);
    surface.blocks.centre[l] = {leaf.x * 2048 + 1024, leaf.y * 2048 + 1024, leaf.z * 2048 + 1024};
  }
}

/// Sheet of `soup` on a lattice of this resolution. Components and genus are the caller's to say.
inline Sheet sheet_of_soup(const TriangleSoup& soup, int32_t resolution, int64_t components, int64_t genus) {
  WorldPoint lo = soup.vertices[0], hi = lo;
  for (const WorldPoint& p : soup.vertices) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  Sheet sheet;
  sheet.frame = LatticeFrame::around(lo, hi, resolution);
  struct Entry {
    uint64_t leaf;
    int offset;
    uint32_t vertex;
  };
  std::vector<Entry> order;
  for (uint32_t v = 0; v < soup.vertices.size(); ++v) {
    const Voxel at = voxel_of(sheet.frame.snap(soup.vertices[v]));
    order.push_back({leaf_key(leaf_of_voxel(at)), offset_in_leaf(at), v});
  }
  std::sort(order.begin(), order.end(),
            [](const Entry& a, const Entry& b) { return a.leaf != b.leaf ? a.leaf < b.leaf : a.offset < b.offset; });
  std::vector<uint32_t> index(order.size());
  std::vector<uint64_t> keys;
  std::vector<LeafMask> masks;
  for (uint32_t i = 0; i < order.size(); ++i) {
    if (i && order[i].leaf == order[i - 1].leaf && order[i].offset == order[i - 1].offset)
      throw std::runtime_error("two vertices in one voxel: use a higher resolution");
    if (keys.empty() || keys.back() != order[i].leaf) {
      keys.push_back(order[i].leaf);
      masks.push_back({});
    }
    masks.back().word[order[i].offset >> 6] |= uint64_t(1) << (order[i].offset & 63);
    index[order[i].vertex] = i;
  }
  sheet.corners.leaf_key = to_buffer(keys);
  sheet.corners.mask = to_buffer(masks);
  index_host_leaves(sheet.corners, sheet.frame.extent_vox);
  cut_into_blocks(sheet.corners, sheet);

  const int64_t count = int64_t(order.size());
  sheet.position = Buffer<PointQ8>(count);
  for (int64_t i = 0; i < count; ++i) sheet.position[i] = sheet.frame.snap(soup.vertices[order[size_t(i)].vertex]);
  std::vector<TriangleIndices> triangles;
  for (const auto& t : soup.triangles) triangles.push_back({index[t[0]], index[t[1]], index[t[2]]});
  sheet.triangles = to_buffer(triangles);
  std::vector<Vec64> normal(order.size(), Vec64{0, 0, 0});
  std::vector<std::vector<uint32_t>> around(order.size());
  for (uint32_t t = 0; t < triangles.size(); ++t) {
    const TriangleIndices i = triangles[t];
    const Vec64 n = cross(difference(sheet.position[i.b], sheet.position[i.a]),
                          difference(sheet.position[i.c], sheet.position[i.a]));
    for (uint32_t v : {i.a, i.b, i.c}) {
      normal[v] = normal[v] + n;
      around[v].push_back(t);
    }
  }
  sheet.normal = Buffer<Normal8>(count);
  sheet.source_triangle = Buffer<uint32_t>(count);
  std::vector<uint32_t> first{0};
  std::vector<uint32_t> lists;
  for (int64_t i = 0; i < count; ++i) {
    sheet.normal[i] = normal8(normal[size_t(i)]);
    sheet.source_triangle[i] = 0;
    lists.insert(lists.end(), around[size_t(i)].begin(), around[size_t(i)].end());
    first.push_back(uint32_t(lists.size()));
  }
  sheet.vertex_first = to_buffer(first);
  sheet.vertex_triangles = to_buffer(lists);
  sheet.topology.components = components;
  sheet.topology.genus = genus;
  return sheet;
}

}  // namespace isoshell
