// The part of relax_on_sheet that measures the cells: area and centre of each, and the energy, by blocks of vertices.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/labels/edge_lengths.h"
#include "stages/relax/pass_state.h"
#include "voxel/atomic.h"
#include "voxel/cell_sum.h"

namespace isoshell {
namespace relax_sheet {

/// Area and centre of a cell relative to its seed: mass is the doubled area (q16), first three times the doubled first
/// moment.
struct CellSum {
  int64_t mass, first_x, first_y, first_z;
};

/// A triangle with its doubled area, times the density where lengths vary, and what its moments about the block's
/// origin are made of: most triangles lie in one cell, and need no more.
struct PatchTriangle {
  uint32_t a, b, c, area2;
  Local corner_sum;
  int64_t squares;

  ISOSHELL_HD PieceSum whole() const {
    return {area2, int64_t(area2) * corner_sum.x, int64_t(area2) * corner_sum.y, int64_t(area2) * corner_sum.z,
            area2 * squares};
  }
};

/// Triangles by the block of their smallest vertex: so all of a block's triangles are close to it.
struct Patches {
  Buffer<int64_t> first;  ///< block_count + 1
  Buffer<PatchTriangle> triangles;
};

struct VisitPatch {
  VertexBlocksView blocks;
  View<const TriangleIndices> triangles;
  View<const uint32_t> vertex_first;
  View<const uint32_t> vertex_triangles;

  template <class Visit>
  ISOSHELL_HD void visit(int64_t block, Visit each) const {
    for (int64_t v = blocks.first[block]; v < blocks.first[block + 1]; ++v)
      for (int64_t n = vertex_first[v]; n < vertex_first[v + 1]; ++n) {
        const uint32_t index = vertex_triangles[n];
        const TriangleIndices t = triangles[index];
        if (t.a >= v && t.b >= v && t.c >= v) each(t, index);
      }
  }
};

struct CountPatch {
  VisitPatch patch;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t block) const {
    int64_t n = 0;
    patch.visit(block, [&](TriangleIndices, uint32_t) { ++n; });
    count[block] = n;
  }
};

struct FillPatch {
  VisitPatch patch;
  View<const PointQ8> position;
  EdgeLengthsView lengths;
  View<const int64_t> first;
  View<PatchTriangle> out;
  ISOSHELL_HD void operator()(int64_t block) const {
    int64_t at = first[block];
    const PointQ8 origin = patch.blocks.centre[block];
    patch.visit(block, [&](TriangleIndices t, uint32_t) {
      const Vec64 n = cross(difference(position[t.b], position[t.a]), difference(position[t.c], position[t.a]));
      const Local a = local(position[t.a], origin), b = local(position[t.b], origin), c = local(position[t.c], origin);
      const uint32_t mass = lengths.mass(uint32_t(isqrt(uint64_t(dot(n, n)))), t);
      out[at++] = {t.a, t.b, t.c, mass, corner_sum(a, b, c), sum_of_squares(a, b, c)};
    });
  }
};

template <class Exec>
Patches make_patches(Exec& exec, const SurfaceMesh& surface) {
  const int64_t blocks = surface.blocks.count();
  const VisitPatch visit{surface.blocks.view(), surface.triangles.view(), surface.vertex_first.view(),
                         surface.vertex_triangles.view()};
  Patches patches;
  patches.first = exec.template make<int64_t>(blocks + 1);
  exec.fill(patches.first.view().part(blocks, 1), int64_t(0));
  exec.for_each("count patch triangles", blocks, CountPatch{visit, patches.first.view()});
  exec.exclusive_scan(patches.first.view());
  patches.triangles = exec.template make<PatchTriangle>(surface.triangles.size());
  exec.for_each(
      "fill patch triangles", blocks,
      FillPatch{visit, surface.position.view(), lengths_of(surface), patches.first.view(), patches.triangles.view()});
  return patches;
}

/// Sums of a few cells while a block is worked on; what does not fit goes straight to the cell.
template <int kSlots>
class LocalSums {
 public:
  ISOSHELL_HD LocalSums() {
    for (int i = 0; i < kSlots; ++i) label_[i] = kNone;
  }
  /// Null when every slot is taken by other labels.
  ISOSHELL_HD PieceSum* of(uint32_t label) {
    for (int probe = 0; probe < kSlots; ++probe) {
      const int slot = int((label * 2654435761u >> 16) + uint32_t(probe)) & (kSlots - 1);
      if (label_[slot] == label) return &sum_[slot];
      if (label_[slot] == kNone) {
        label_[slot] = label;
        sum_[slot] = {0, 0, 0, 0, 0};
        return &sum_[slot];
      }
    }
    return nullptr;
  }
  template <class Visit>
  ISOSHELL_HD void for_each(Visit visit) const {
    for (int i = 0; i < kSlots; ++i)
      if (label_[i] != kNone) visit(label_[i], sum_[i]);
  }

 private:
  uint32_t label_[kSlots];
  PieceSum sum_[kSlots];
};

/// Moves sums from an origin to the seed at `d` from it, adds them to the seed's cell, and returns their energy. Far
/// seeds take that past 64 bits.
ISOSHELL_HD inline Int128 add_to_cell(CellSum& cell, const PieceSum& s, Local d) {
  atomic_add(cell.mass, s.mass);
  atomic_add(cell.first_x, s.first_x - 3 * s.mass * d.x);
  atomic_add(cell.first_y, s.first_y - 3 * s.mass * d.y);
  atomic_add(cell.first_z, s.first_z - 3 * s.mass * d.z);
  return Int128(s.second) - 8 * (Int128(s.first_x) * d.x + Int128(s.first_y) * d.y + Int128(s.first_z) * d.z) +
         Int128(12 * square(d)) * s.mass;
}

/// Adds the pieces of one block's triangles to their cells, and writes the block's part of the energy.
template <int kSlots = 64>
struct SumBlock {
  View<const PointQ8> centre;  ///< of the blocks
  View<const int64_t> first;
  View<const PatchTriangle> triangles;
  View<const PointQ8> position;
  View<const uint32_t> label;
  View<const PointQ8> seed;
  View<CellSum> cell;
  View<SplitSum> energy;
  View<const PassState> state;

  ISOSHELL_HD void operator()(int64_t block) const {
    if (state[0].converged) return;
    const PointQ8 origin = centre[block];
    LocalSums<kSlots> sums;
    uint32_t last = kNone;
    PieceSum* last_sum = nullptr;
    Int128 block_energy = 0;
    const auto flush = [&](uint32_t id, const PieceSum& sum) {
      block_energy += add_to_cell(cell[id], sum, local(seed[id], origin));
    };
    const auto add = [&](uint32_t id, const PieceSum& piece) {
      if (id != last) last = id, last_sum = sums.of(id);
      if (last_sum)
        *last_sum = *last_sum + piece;
      else
        flush(id, piece);
    };
    for (int64_t t = first[block]; t < first[block + 1]; ++t) add_triangle(triangles[t], origin, add);
    sums.for_each(flush);
    energy[block] = SplitSum::of(block_energy);
  }

 private:
  template <class Add>
  ISOSHELL_HD void add_triangle(const PatchTriangle& t, PointQ8 origin, Add add) const {
    const uint32_t id[3] = {label[t.a], label[t.b], label[t.c]};
    if (id[0] == id[1] && id[1] == id[2]) return add(id[0], t.whole());
    const Local p[3] = {local(position[t.a], origin), local(position[t.b], origin), local(position[t.c], origin)};
    const SplitTriangle split{{p[0], p[1], p[2]},
                              {local(seed[id[0]], origin), local(seed[id[1]], origin), local(seed[id[2]], origin)},
                              t.area2};
    const auto add_piece = [&](int corner, const PieceSum& piece) { add(id[corner], piece); };
    if (id[1] == id[2])
      split.two_cells(0, add_piece);
    else if (id[2] == id[0])
      split.two_cells(1, add_piece);
    else if (id[0] == id[1])
      split.two_cells(2, add_piece);
    else
      split.three_cells(add_piece);
  }
};

}  // namespace relax_sheet
}  // namespace isoshell
