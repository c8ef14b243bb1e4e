// Nearest seed of every active voxel (paper section 3.2), by cubes of voxels: a list of candidates a cube, eighths of
// the cube where the list does not fit, and one search a voxel where seeds are as dense as voxels. All give the same
// labels.
#pragma once

#include "stages/sparse/point_grid_body.h"
#include "voxel/leaf_candidates.h"

namespace isoshell {

/// Which of `count` candidates is nearest to the voxel at (x, y, z) of a leaf, as the smallest linear form
/// |a|^2 - 2 a.v, a from the centre of the leaf's voxel 0. T = int32_t holds it while every |a| < 64 voxels on each
/// axis.
template <class T>
struct CandidateForms {
  T constant[kMaxCandidates], per_x[kMaxCandidates], per_y[kMaxCandidates], per_z[kMaxCandidates];

  ISOSHELL_HD CandidateForms(const Candidates& candidates, PointQ8 origin) {
    for (int c = 0; c < candidates.count; ++c) {
      const Vec64 a = difference(candidates.point[c].position, origin);
      constant[c] = T(dot(a, a));
      per_x[c] = T(-2 * kOneVoxelQ8 * a.x);
      per_y[c] = T(-2 * kOneVoxelQ8 * a.y);
      per_z[c] = T(-2 * kOneVoxelQ8 * a.z);
    }
  }
  ISOSHELL_HD static bool fits(const Candidates& candidates, PointQ8 origin) {
    if (sizeof(T) == 8) return true;
    for (int c = 0; c < candidates.count; ++c) {
      const Vec64 a = difference(candidates.point[c].position, origin);
      const int64_t limit = 64 * kOneVoxelQ8;
      if (a.x <= -limit || a.x >= limit || a.y <= -limit || a.y >= limit || a.z <= -limit || a.z >= limit) return false;
    }
    return true;
  }
};

/// What labelling does with its labels: writes them down.
struct WriteLabels {
  VoxelSetView voxels;
  View<uint32_t> label;

  struct Block {
    const WriteLabels& to;
    int64_t leaf;
    const Candidates& candidates;
    ISOSHELL_HD void run(int candidate, int x, int y, int z, int count) const {
      for (int i = z; i < z + count; ++i) to.voxel(leaf, x << 6 | y << 3 | i, candidates.point[candidate].id);
    }
    ISOSHELL_HD void finish() const {}
  };
  ISOSHELL_HD Block open(int64_t leaf, const Candidates& candidates) const { return {*this, leaf, candidates}; }
  ISOSHELL_HD void voxel(int64_t leaf, int offset, uint32_t seed) const {
    label[voxels.first[leaf] + rank_in_leaf(voxels.mask[leaf], offset)] = seed;
  }
};

/// Number of the smallest form at z, the first of equals. `line`: the forms at z = 0 of a row.
template <class T>
ISOSHELL_HD inline int smallest_form(const CandidateForms<T>& form, const T* line, int count, int z) {
  int best = 0;
  T least = T(line[0] + z * form.per_z[0]);
  for (int c = 1; c < count; ++c) {
    const T here = T(line[c] + z * form.per_z[c]);
    best = here < least ? c : best;
    least = here < least ? here : least;
  }
  return best;
}

/// Labels the rows of a cube. A cell is convex, ties included, so a run of voxels whose ends share a label has that
/// label.
template <class T, class Sink>
ISOSHELL_HD inline void label_block_as(const Candidates& candidates, const LeafCube& block, PointQ8 origin,
                                       Sink& sink) {
  const CandidateForms<T> form(candidates, origin);
  T line[kMaxCandidates];
  for (int x = block.x; x < block.x + block.edge; ++x)
    for (int y = block.y; y < block.y + block.edge; ++y) {
      uint32_t bits = uint32_t(block.row[x - block.x] >> (8 * y)) & 255;
      if (bits == 0) continue;
      for (int c = 0; c < candidates.count; ++c) line[c] = T(form.constant[c] + x * form.per_x[c] + y * form.per_y[c]);
      while (bits) {
        const int z = lowest_bit(bits), length = lowest_bit(~(bits >> z));
        bits &= ~uint32_t(0) << (z + length);
        const int first = smallest_form(form, line, candidates.count, z);
        const int last = length == 1 ? first : smallest_form(form, line, candidates.count, z + length - 1);
        if (first == last) {
          sink.run(first, x, y, z, length);
          continue;
        }
        sink.run(first, x, y, z, 1);
        for (int i = z + 1; i < z + length - 1; ++i)
          sink.run(smallest_form(form, line, candidates.count, i), x, y, i, 1);
        sink.run(last, x, y, z + length - 1, 1);
      }
    }
}

/// Edge of the cubes that get one candidate list each: a leaf, or a part of one when seeds are closer, so that lists
/// stay short and a voxel costs about the same whatever the number of seeds.
inline int cube_edge_for(int64_t seed_spacing_vox) { return seed_spacing_vox >= 6 ? 8 : seed_spacing_vox >= 3 ? 4 : 2; }

/// One leaf: label its active voxels and hand the labels to the sink.
template <class Sink>
struct LabelLeaf {
  VoxelSetView voxels;
  PointGridView grid;
  Sink sink;
  int first_edge;  ///< see cube_edge_for

  ISOSHELL_HD void operator()(int64_t leaf) const { label_cube<8>(leaf, 0, 0, 0); }

  /// By one list, or by eighths.
  template <int kEdge>
  ISOSHELL_HD void label_cube(int64_t leaf, int x, int y, int z) const {
    const LeafCube cube = cube_of_leaf(voxels.mask[leaf], kEdge, x, y, z);
    if (cube.empty() || (kEdge <= first_edge && label(leaf, cube))) return;
    if constexpr (kEdge > 2) {
      constexpr int kHalf = kEdge / 2;
      for (int octant = 0; octant < 8; ++octant)
        label_cube<kHalf>(leaf, x + (octant >> 2) * kHalf, y + (octant >> 1 & 1) * kHalf, z + (octant & 1) * kHalf);
    } else {
      label_each(leaf, cube);
    }
  }

  /// False when the candidates do not fit; nothing was handed over then.
  ISOSHELL_HD bool label(int64_t leaf, const LeafCube& block) const {
    const PointQ8 origin = voxel_centre(voxel_at(leaf_of_key(voxels.leaf_key[leaf]), 0));
    Candidates candidates(box_of_centres(block, origin));
    gather_candidates(grid, candidates);
    if (candidates.overflow || candidates.count == 0) return false;
    auto into = sink.open(leaf, candidates);
    if (CandidateForms<int32_t>::fits(candidates, origin))
      label_block_as<int32_t>(candidates, block, origin, into);
    else
      label_block_as<int64_t>(candidates, block, origin, into);
    into.finish();
    return true;
  }

  ISOSHELL_HD void label_each(int64_t leaf, const LeafCube& block) const {
    const Voxel at = leaf_of_key(voxels.leaf_key[leaf]);
    for (int x = 0; x < block.edge; ++x)
      for (uint64_t bits = block.row[x]; bits; bits &= bits - 1) {
        const int offset = (block.x + x) << 6 | lowest_bit(bits);
        sink.voxel(leaf, offset, nearest_point(grid, voxel_centre(voxel_at(at, offset))).id);
      }
  }
};

/// Per active voxel the seed of the smallest (squared distance from the voxel's centre, seed id).
template <class Exec>
Buffer<uint32_t> label_nearest(Exec& exec, const VoxelSet& voxels, PointGrid& grid, View<const PointQ8> seeds,
                               int edge) {
  Buffer<uint32_t> label = exec.template make<uint32_t>(voxels.voxel_count());
  fill_point_grid(exec, grid, seeds);
  exec.for_each("nearest seed", voxels.leaf_count(),
                LabelLeaf<WriteLabels>{voxels.view(), grid.view(), WriteLabels{voxels.view(), label.view()}, edge});
  return label;
}

}  // namespace isoshell
