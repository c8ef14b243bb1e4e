// The solid that a sheet bounds, from its boundary faces: which voxels are in it, and which are near its boundary.
#pragma once

#include "isoshell/advanced/sheet.h"
#include "stages/sparse/drop_empty_leaves.h"
#include "stages/sparse/marked_leaves.h"
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

struct SolidVoxelOf {
  BoundaryFaces faces;
  ISOSHELL_HD Voxel operator()(int64_t face) const { return faces[face].solid_voxel(); }
};

/// The voxels of the solid that have a boundary face.
template <class Exec>
VoxelSet rim_of(Exec& exec, const BoundaryFaces& faces, const int32_t extent_vox[3]) {
  return voxel_set_of_voxels(exec, extent_vox, faces.count(), SolidVoxelOf{faces});
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

/// Where rows of voxels along z enter the solid and leave it: the faces across z by (x, y, z), ascending, each with
/// whether the solid lies below it.
struct RowsOfSolid {
  View<const uint64_t> key;

  ISOSHELL_HD static uint64_t key_of(Voxel v, bool is_solid_below) {
    return uint64_t(v.x) << 40 | uint64_t(v.y) << 20 | uint64_t(v.z) << 1 | uint64_t(is_solid_below);
  }
  /// The voxels of the solid in a plane of a leaf.
  ISOSHELL_HD uint64_t plane_at(Voxel leaf, int x) const {
    uint64_t plane = 0;
    for (int y = 0; y < 8; ++y) plane |= row_at({leaf.x * 8 + x, leaf.y * 8 + y, leaf.z * 8}) << (8 * y);
    return plane;
  }

 private:
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
  /// Eight voxels, a bit each: every one is what the next face above it has below.
  ISOSHELL_HD uint64_t row_at(Voxel first) const {
    const uint64_t of_row = key_of({first.x, first.y, 0}, false), end_of_row = key_of({first.x, first.y + 1, 0}, false);
    int64_t face = first_from(of_row + key_of({0, 0, first.z + 1}, false));
    uint64_t row = 0;
    for (int z = 0; z < 8; ++z) {
      const uint64_t above = of_row + key_of({0, 0, first.z + z + 1}, false);
      while (face < key.size && key[face] < above) ++face;
      if (face == key.size || key[face] >= end_of_row) break;
      row |= (key[face] & 1) << z;
    }
    return row;
  }
};

struct IsAcrossZ {
  BoundaryFaces faces;
  ISOSHELL_HD bool operator()(int64_t face) const { return faces[face].axis == 2; }
};

struct KeyOfRow {
  BoundaryFaces faces;
  View<const uint32_t> across;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const BoundaryFace face = faces[across[i]];
    key[i] = RowsOfSolid::key_of(face.corner, face.is_solid_below);
  }
};

template <class Exec>
Buffer<uint64_t> rows_of_solid(Exec& exec, const BoundaryFaces& faces) {
  const Buffer<uint32_t> across = exec.select(faces.count(), IsAcrossZ{faces});
  Buffer<uint64_t> key = exec.template make<uint64_t>(across.size());
  exec.for_each("key rows", across.size(), KeyOfRow{faces, across.view(), key.view()});
  exec.sort(key.view());
  return key;
}

}  // namespace isoshell::level_set_steps
