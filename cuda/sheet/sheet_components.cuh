// Components of the quad mesh on the device. Its lattice edges connect what its quads connect: first inside every leaf,
// in shared memory, then between leaves.
#pragma once

#include "cuda/runtime/executor_cuda.cuh"
#include "cuda/sparse/leaf_cooperative.cuh"
#include "stages/sheet/sheet_components_body.h"

namespace isoshell {
namespace component_steps {

struct LeafEdges {
  VoxelSetView corners;
  View<const uint8_t> edges;
  View<uint32_t> parent;
};
struct JoinInsideLeaf {
  LeafEdges of;
};
struct JoinAcrossLeaves {
  LeafEdges of;
};

/// A leaf's vertices as disjoint sets, by their offsets: their order is that of the vertices.
struct LeafSets {
  uint32_t parent[512];
  uint16_t offset[512], rank[512];
};

/// Calls visit(face, neighbour's offset, whether it lies in the leaf) for the edges towards larger coordinates.
template <class Visit>
__device__ inline void for_each_rising_edge(uint8_t edges, int offset, Visit visit) {
  const int at[3] = {offset >> 6, offset >> 3 & 7, offset & 7}, step[3] = {64, 8, 1};
  for (int axis = 0; axis < 3; ++axis)
    if (edges >> (2 * axis + 1) & 1) visit(2 * axis + 1, offset + step[axis], at[axis] < 7);
}

}  // namespace component_steps

template <>
struct CooperativeKernel<component_steps::JoinInsideLeaf>
    : leaf_cooperative::CooperativeLeaf<component_steps::JoinInsideLeaf, component_steps::LeafSets> {
  static __device__ void run(const component_steps::JoinInsideLeaf& step, int64_t leaf, Shared& sets, int lane) {
    const component_steps::LeafEdges& of = step.of;
    const int count = leaf_cooperative::list_active(of.corners.mask[leaf], sets.offset, lane);
    const int64_t first = of.corners.first[leaf];
    for (int k = lane; k < count; k += 32) {
      const int offset = sets.offset[k];
      sets.parent[offset] = uint32_t(offset);
      sets.rank[offset] = uint16_t(k);
    }
    __syncwarp();
    const View<uint32_t> parent = {sets.parent, 512};
    for (int k = lane; k < count; k += 32) {
      const int offset = sets.offset[k];
      component_steps::for_each_rising_edge(of.edges[first + k], offset, [&](int, int other, bool inside) {
        if (inside) join(parent, uint32_t(offset), uint32_t(other));
      });
    }
    __syncwarp();
    for (int k = lane; k < count; k += 32)
      of.parent[first + k] = uint32_t(first + sets.rank[find_root(parent, sets.offset[k])]);
  }
};

template <>
struct CooperativeKernel<component_steps::JoinAcrossLeaves>
    : leaf_cooperative::CooperativeLeaf<component_steps::JoinAcrossLeaves, leaf_cooperative::Offsets> {
  static __device__ void run(const component_steps::JoinAcrossLeaves& step, int64_t leaf, Shared& shared, int lane) {
    const component_steps::LeafEdges& of = step.of;
    const int count = leaf_cooperative::list_active(of.corners.mask[leaf], shared.offset, lane);
    const int64_t first = of.corners.first[leaf];
    const Voxel l = leaf_of_key(of.corners.leaf_key[leaf]);
    for (int k = lane; k < count; k += 32) {
      const int offset = shared.offset[k];
      component_steps::for_each_rising_edge(of.edges[first + k], offset, [&](int face, int, bool inside) {
        if (inside) return;
        const int64_t other = find_voxel(of.corners, step_through(voxel_at(l, offset), face));
        join(of.parent, uint32_t(first + k), uint32_t(other));
      });
    }
  }
};

struct JoinComponentsByLeaves {
  static void run(CudaExecutor& exec, const QuadMesh& mesh, View<uint32_t> parent) {
    const component_steps::LeafEdges of{mesh.corners.view(), mesh.edges.view(), parent};
    exec.for_each("join inside leaves", mesh.corners.leaf_count(), component_steps::JoinInsideLeaf{of});
    exec.for_each("join across leaves", mesh.corners.leaf_count(), component_steps::JoinAcrossLeaves{of});
  }
};

}  // namespace isoshell
