// The solid that a sheet bounds, from its boundary faces: which voxels are in it, and which are near its boundary.
#pragma once

#include "isoshell/advanced/sheet.h"
#include "stages/sparse/reach.h"
#include "voxel/leaf.h"

namespace isoshell::level_set_steps {

/// A face of a voxel: the lattice corner of its smallest coordinates, its axis, and whether the solid lies below it.
struct BoundaryFace {
  Voxel corner;
  int axis;
  bool is_solid_below;

  ISOSHELL_HD Voxel solid_voxel() const {
    const int below = is_solid_below ? 1 : 0;
    return {corner.x - (axis == 0 ? below : 0), corner.y - (axis == 1 ? below : 0), corner.z - (axis == 2 ? below : 0)};
  }
};

/// Two triangles of the sheet are a face, in the order of its faces.
struct BoundaryFaces {
  View<const TriangleIndices> triangles;
  View<const Voxel> corner;  ///< of each vertex

  ISOSHELL_HD int64_t count() const { return triangles.size / 2; }
  ISOSHELL_HD BoundaryFace operator[](int64_t face) const {
    const TriangleIndices t = triangles[2 * face];
    const Voxel a = corner[t.a], b = corner[t.b], c = corner[t.c];
    const auto least = [](int32_t p, int32_t q, int32_t r) { return p < q ? (p < r ? p : r) : (q < r ? q : r); };
    const int32_t ab[3] = {b.x - a.x, b.y - a.y, b.z - a.z}, ac[3] = {c.x - a.x, c.y - a.y, c.z - a.z};
    int axis = 0;
    while (axis < 2 && (ab[axis] != 0 || ac[axis] != 0)) ++axis;
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return {
        {least(a.x, b.x, c.x), least(a.y, b.y, c.y), least(a.z, b.z, c.z)}, axis, ab[u] * ac[v] - ab[v] * ac[u] > 0};
  }
};

struct ListCorners {
  VoxelSetView corners;
  View<Voxel> corner;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    for_each_active(corners, leaf,
                    [&](int offset, int64_t i) { corner[i] = voxel_at(leaf_of_key(corners.leaf_key[leaf]), offset); });
  }
};

struct KeyOfSolidVoxel {
  BoundaryFaces faces;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t face) const {
    const Voxel v = faces[face].solid_voxel();
    key[face] = leaf_key(leaf_of_voxel(v)) << 9 | uint64_t(offset_in_leaf(v));
  }
};

struct StartsLeaf {
  View<const uint64_t> key;
  ISOSHELL_HD bool operator()(int64_t i) const { return i == 0 || key[i] >> 9 != key[i - 1] >> 9; }
};

struct FillLeaf {
  View<const uint64_t> key;
  View<const uint32_t> start;
  View<uint64_t> leaf_key;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t l) const {
    leaf_key[l] = key[start[l]] >> 9;
    LeafMask here{};
    for (int64_t i = start[l]; i < key.size && key[i] >> 9 == leaf_key[l]; ++i)
      here.word[key[i] >> 6 & 7] |= uint64_t(1) << (key[i] & 63);
    mask[l] = here;
  }
};

/// The voxels of the solid that have a boundary face.
template <class Exec>
VoxelSet rim_of(Exec& exec, const BoundaryFaces& faces, const int32_t extent_vox[3]) {
  Buffer<uint64_t> key = exec.template make<uint64_t>(faces.count());
  exec.for_each("key rim", faces.count(), KeyOfSolidVoxel{faces, key.view()});
  exec.sort(key.view());
  const Buffer<uint32_t> start = exec.select(key.size(), StartsLeaf{key.view()});
  Buffer<uint64_t> leaf_key = exec.template make<uint64_t>(start.size());
  Buffer<LeafMask> mask = exec.template make<LeafMask>(start.size());
  exec.for_each("fill rim", start.size(), FillLeaf{key.view(), start.view(), leaf_key.view(), mask.view()});
  return voxel_set_of(exec, leaf_key.view(), mask.view(), extent_vox);
}

struct MeetLeaf {
  VoxelSetView one, other;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const uint32_t there = find_leaf(other, leaf_of_key(one.leaf_key[leaf]));
    for (int w = 0; w < 8; ++w)
      mask[leaf].word[w] = there == kNone ? 0 : one.mask[leaf].word[w] & other.mask[there].word[w];
  }
};

/// The voxels of both sets.
template <class Exec>
VoxelSet intersection(Exec& exec, const VoxelSetView& one, const VoxelSetView& other) {
  Buffer<LeafMask> mask = exec.template make<LeafMask>(one.leaf_key.size);
  exec.for_each("voxels of both", mask.size(), MeetLeaf{one, other, mask.view()});
  return voxel_set_of(exec, one.leaf_key, mask.view(), BlockExtent(one).vox);
}

/// Where rows of voxels along x enter the solid and leave it: (y, z, x) of the faces across x, ascending.
struct RowsOfSolid {
  View<const uint64_t> key;

  ISOSHELL_HD static uint64_t key_of(Voxel v) { return uint64_t(v.y) << 32 | uint64_t(v.z) << 16 | uint64_t(v.x); }
  ISOSHELL_HD int64_t first_from(uint64_t least) const {
    int64_t lo = 0, hi = key.size;
    while (lo < hi) {
      const int64_t middle = lo + (hi - lo) / 2;
      if (key[middle] < least)
        lo = middle + 1;
      else
        hi = middle;
    }
    return lo;
  }
  /// The eight voxels of a row in a leaf, a bit each, lowest x first.
  ISOSHELL_HD uint32_t row_at(Voxel first) const {
    const int64_t begin = first_from(key_of({0, first.y, first.z}));
    int64_t at = first_from(key_of(first));
    uint32_t is_solid = uint32_t(at - begin) & 1, row = 0;
    const uint64_t of_row = key_of({0, first.y, first.z});
    for (int32_t x = 0; x < 8; ++x) {
      for (; at < key.size && key[at] == of_row + uint64_t(first.x + x); ++at) is_solid ^= 1;
      row |= is_solid << x;
    }
    return row;
  }
  ISOSHELL_HD LeafMask leaf_at(Voxel leaf) const {
    LeafMask mask{};
    for (int y = 0; y < 8; ++y)
      for (int z = 0; z < 8; ++z) {
        const uint32_t row = row_at({leaf.x * 8, leaf.y * 8 + y, leaf.z * 8 + z});
        for (int x = 0; x < 8; ++x) mask.word[x] |= uint64_t(row >> x & 1) << (8 * y + z);
      }
    return mask;
  }
};

struct IsAcrossX {
  BoundaryFaces faces;
  ISOSHELL_HD bool operator()(int64_t face) const { return faces[face].axis == 0; }
};

struct KeyOfRow {
  BoundaryFaces faces;
  View<const uint32_t> across;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const { key[i] = RowsOfSolid::key_of(faces[across[i]].corner); }
};

template <class Exec>
Buffer<uint64_t> rows_of_solid(Exec& exec, const BoundaryFaces& faces) {
  const Buffer<uint32_t> across = exec.select(faces.count(), IsAcrossX{faces});
  Buffer<uint64_t> key = exec.template make<uint64_t>(across.size());
  exec.for_each("key rows", across.size(), KeyOfRow{faces, across.view(), key.view()});
  exec.sort(key.view());
  return key;
}

}  // namespace isoshell::level_set_steps
