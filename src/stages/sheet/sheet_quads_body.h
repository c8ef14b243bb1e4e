// The part of build_sheet that turns the solid's boundary into a quad mesh: lattice corners, edges between them, faces.
#pragma once

#include "stages/sheet/sheet_solid_body.h"

namespace isoshell {

/// A boundary face of the solid: corners by vertex index, counter-clockwise seen from outside, the same corner first
/// whatever the direction: the one with the smallest coordinates.
struct Quad {
  uint32_t corner[4];
};

namespace sheet_steps {

/// Corner (x, y, z) lies between the voxels x-1 and x, and so on; it is on the boundary when its eight voxels differ.
/// Bits of the corners z = 0..8 in the row (x, y), each 0..8, of a window.
ISOSHELL_HD inline uint32_t corner_row(const SolidWindow& window, int x, int y) {
  const uint32_t a = window.row[x][y], b = window.row[x][y + 1], c = window.row[x + 1][y], d = window.row[x + 1][y + 1];
  const uint32_t any = a | b | c | d, all = a & b & c & d;
  return (any | any >> 1) & ~(all & all >> 1) & 0x1ff;
}

/// Neighbours without mask that hold corners of the boundary.
struct WantCornerLeaves {
  SolidView solid;
  View<uint32_t> wanted;
  ISOSHELL_HD void operator()(int64_t i) const {
    wanted[i] = 0;
    const Voxel l = leaf_of_key(solid.set.leaf_key[i]);
    SolidWindow window;
    load_window(solid, l, window);
    if (!is_mixed(window)) return;
    uint32_t want = 0;
    for (int x = 0; x < 9; ++x)
      for (int y = 0; y < 9; ++y) {
        const uint32_t row = corner_row(window, x, y);
        if (row & 255 && (x == 8 || y == 8)) want |= 1u << neighbour_number(x / 8, y / 8, 0);
        if (row >> 8) want |= 1u << neighbour_number(x / 8, y / 8, 1);
      }
    wanted[i] = without_mask(solid, l, want);
  }
};

struct MarkCorners {
  SolidView solid;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t i) const {
    mask[i] = LeafMask{};
    SolidWindow window;
    load_window(solid, leaf_of_key(solid.set.leaf_key[i]), window);
    if (!is_mixed(window)) return;
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) mask[i].word[x] |= uint64_t(corner_row(window, x, y) & 255) << (8 * y);
  }
};

/// Per corner: where it is, which of its six lattice edges lie on the boundary (bit f: towards face f), and the sum of
/// the normals of its boundary faces, components -4..4.
struct DescribeCorners {
  SolidView solid;
  VoxelSetView corners;
  View<PointQ8> position;
  View<uint8_t> edges;
  View<Normal8> lattice_normal;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel l = leaf_of_key(corners.leaf_key[i]);
    SolidWindow window;
    load_window(solid, l, window);
    for_each_active(corners, i, [&](int offset, int64_t v) { describe(window, l, offset, v); });
  }
  ISOSHELL_HD void describe(const SolidWindow& window, Voxel l, int offset, int64_t v) const {
    const Voxel c = voxel_at(l, offset);
    position[v] = {c.x * kOneVoxelQ8, c.y * kOneVoxelQ8, c.z * kOneVoxelQ8};
    const int x = offset >> 6, y = offset >> 3 & 7, z = offset & 7;
    uint32_t on = 0;  // bit 4 x + 2 y + z: the eight voxels around
    for (int o = 0; o < 4; ++o) on |= (window.row[x + (o >> 1)][y + (o & 1)] >> z & 3) << (2 * o);
    // The four voxels on each side of the corner; an edge is on the boundary when its four differ.
    const uint32_t side[6] = {0x0f, 0xf0, 0x33, 0xcc, 0x55, 0xaa};
    uint32_t bits = 0;
    int32_t n[6];
    for (int f = 0; f < 6; ++f) {
      const uint32_t four = on & side[f];
      if (four != 0 && four != side[f]) bits |= 1u << f;
      n[f] = popcount64(four);
    }
    edges[v] = uint8_t(bits);
    lattice_normal[v] = {int8_t(n[0] - n[1]), int8_t(n[2] - n[3]), int8_t(n[4] - n[5])};
  }
};

/// Solid voxels of row (x, y) of the leaf, 0..7 each, that show each face to an empty voxel; bit z + 1.
ISOSHELL_HD inline void exposed_faces(const SolidWindow& window, int x, int y, uint32_t exposed[6]) {
  const uint32_t s = window.row[x + 1][y + 1] & 0x1fe;
  exposed[0] = s & ~window.row[x][y + 1];
  exposed[1] = s & ~window.row[x + 2][y + 1];
  exposed[2] = s & ~window.row[x + 1][y];
  exposed[3] = s & ~window.row[x + 1][y + 2];
  exposed[4] = s & ~(window.row[x + 1][y + 1] << 1);
  exposed[5] = s & ~(window.row[x + 1][y + 1] >> 1);
}

struct CountFaces {
  SolidView solid;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    count[i] = 0;
    SolidWindow window;
    load_window(solid, leaf_of_key(solid.set.leaf_key[i]), window);
    if (!is_mixed(window)) return;
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) {
        uint32_t exposed[6];
        exposed_faces(window, x, y, exposed);
        for (const uint32_t e : exposed) count[i] += popcount64(e);
      }
  }
};

/// Vertex indices of the corners 0..8 of a leaf: the leaf's own and seven neighbours'.
struct CornerLookup {
  VoxelSetView corners;
  uint32_t leaf[8];
  ISOSHELL_HD CornerLookup(const VoxelSetView& set, Voxel l) : corners(set) {
    for (int n = 0; n < 8; ++n) leaf[n] = find_leaf(set, {l.x + (n >> 2), l.y + (n >> 1 & 1), l.z + (n & 1)});
  }
  ISOSHELL_HD uint32_t operator()(int x, int y, int z) const {
    const uint32_t number = leaf[(x >> 3) << 2 | (y >> 3) << 1 | z >> 3];
    const int offset = (x & 7) << 6 | (y & 7) << 3 | (z & 7);
    return uint32_t(corners.first[number] + rank_in_leaf(corners.mask[number], offset));
  }
};

struct ListFaces {
  SolidView solid;
  VoxelSetView corners;
  View<const int64_t> first;
  View<Quad> quads;
  ISOSHELL_HD void operator()(int64_t i) const {
    if (first[i + 1] == first[i]) return;
    const Voxel l = leaf_of_key(solid.set.leaf_key[i]);
    SolidWindow window;
    load_window(solid, l, window);
    const CornerLookup corner(corners, l);
    int64_t at = first[i];
    for (int x = 0; x < 8; ++x)
      for (int y = 0; y < 8; ++y) {
        uint32_t exposed[6];
        exposed_faces(window, x, y, exposed);
        list_row(corner, x, y, exposed, quads, at);
      }
  }
  /// Faces of one row, from place `at` on.
  template <class Corner>
  ISOSHELL_HD static void list_row(const Corner& corner, int x, int y, const uint32_t exposed[6],
                                   const View<Quad>& quads, int64_t& at) {
    uint32_t any = 0;
    for (int f = 0; f < 6; ++f) any |= exposed[f];
    for (; any; any &= any - 1) {
      const int bit = lowest_bit(any);
      for (int f = 0; f < 6; ++f)
        if (exposed[f] >> bit & 1) quads[at++] = face_of(corner, x, y, bit - 1, f);
    }
  }
  /// Walks round face f of a voxel: along u then v on the positive side, v then u on the negative, with (u, v) the axes
  /// after the face's own, so that the turn is to the left seen from outside.
  template <class Corner>
  ISOSHELL_HD static Quad face_of(const Corner& corner, int x, int y, int z, int f) {
    const int axis = f >> 1, u = (axis + 1) % 3, v = (axis + 2) % 3;
    Quad quad;
    for (int k = 0; k < 4; ++k) {
      int p[3] = {x, y, z};
      p[axis] += f & 1;
      p[f & 1 ? u : v] += k == 1 || k == 2;
      p[f & 1 ? v : u] += k >= 2;
      quad.corner[k] = corner(p[0], p[1], p[2]);
    }
    return quad;
  }
};

}  // namespace sheet_steps

/// The boundary of a solid as a quad mesh on the lattice.
struct QuadMesh {
  VoxelSet corners;
  Buffer<PointQ8> position;        ///< of corner (x, y, z): 256 (x, y, z)
  Buffer<uint8_t> edges;           ///< bit f: the edge towards face f is on the boundary
  Buffer<Normal8> lattice_normal;  ///< sum of the normals of the faces around, not scaled
  Buffer<Quad> quads;              ///< in the order of (solid voxel, face)
};

template <class Exec>
QuadMesh list_boundary(Exec& exec, Solid& solid) {
  using namespace sheet_steps;
  Buffer<uint32_t> wanted = exec.template make<uint32_t>(solid.set.leaf_count());
  exec.for_each("leaves of corners", wanted.size(), WantCornerLeaves{solid.view(), wanted.view()});
  give_masks(exec, solid, wanted.view());

  const SolidView view = solid.view();
  const int64_t leaves = view.set.leaf_key.size;
  QuadMesh mesh;
  {
    Buffer<LeafMask> mask = exec.template make<LeafMask>(leaves);
    exec.for_each("corners", leaves, MarkCorners{view, mask.view()});
    mesh.corners = voxel_set_of(exec, view.set.leaf_key, mask.view(), BlockExtent(view.set).vox);
  }
  const int64_t vertices = mesh.corners.voxel_count();
  mesh.position = exec.template make<PointQ8>(vertices);
  mesh.edges = exec.template make<uint8_t>(vertices);
  mesh.lattice_normal = exec.template make<Normal8>(vertices);
  exec.for_each(
      "describe corners", mesh.corners.leaf_count(),
      DescribeCorners{view, mesh.corners.view(), mesh.position.view(), mesh.edges.view(), mesh.lattice_normal.view()});
  Buffer<int64_t> first = exec.template make<int64_t>(leaves + 1);
  exec.fill(first.view().part(leaves, 1), int64_t(0));
  exec.for_each("count faces", leaves, CountFaces{view, first.view()});
  const int64_t faces = exec.exclusive_scan(first.view());
  mesh.quads = exec.template make<Quad>(faces);
  exec.for_each("list faces", leaves, ListFaces{view, mesh.corners.view(), first.view(), mesh.quads.view()});
  return mesh;
}

}  // namespace isoshell
