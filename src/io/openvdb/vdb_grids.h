// Products as OpenVDB grids. Grids come from OpenVDB's own registry, and leaves are filled outside the tree: so this
// code instantiates little of OpenVDB's templates, and all leaves of a grid can be made at once.
#pragma once

#include <openvdb/Grid.h>
#include <openvdb/tree/Tree.h>

#include <cstring>
#include <memory>
#include <vector>

#include "core/parallel_ranges.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/leaf.h"

namespace isoshell {

template <class T>
using VdbGrid = openvdb::Grid<typename openvdb::tree::Tree4<T, 5, 4, 3>::Type>;
using VdbFloatGrid = VdbGrid<float>;
using VdbIntGrid = VdbGrid<int32_t>;
using VdbVec3fGrid = VdbGrid<openvdb::Vec3f>;
using VdbVec3iGrid = VdbGrid<openvdb::Vec3i>;

template <class GridT>
using VdbLeaf = typename GridT::TreeType::LeafNodeType;

template <class GridT>
typename GridT::Ptr new_vdb_grid(const char* name, const typename GridT::ValueType& background) {
  auto grid = std::static_pointer_cast<GridT>(openvdb::GridBase::createGrid(GridT::gridType()));
  grid->tree().root().setBackground(background, false);
  grid->setName(name);
  return grid;
}

/// Makes `count` leaves at once by fill(leaf number, values) -> mask and hangs them into the grid's tree. `leaf_at`
/// gives leaf coordinates.
template <class GridT, class LeafAt, class Fill>
void add_vdb_leaves(GridT& grid, int64_t count, LeafAt leaf_at, Fill fill) {
  using Leaf = VdbLeaf<GridT>;
  std::vector<std::unique_ptr<Leaf>> leaves(static_cast<size_t>(count));
  const auto background = grid.background();
  for_each_index(int64_t(0), count, [&](int64_t l) {
    const Voxel at = leaf_at(l);
    auto leaf = std::make_unique<Leaf>(openvdb::Coord(at.x * 8, at.y * 8, at.z * 8), background, false);
    const LeafMask mask = fill(l, leaf->buffer().data());
    typename Leaf::NodeMaskType on;
    static_assert(Leaf::NodeMaskType::WORD_COUNT == 8, "our masks and OpenVDB's have the same words");
    for (openvdb::Index w = 0; w < 8; ++w) on.template getWord<openvdb::Index64>(w) = mask.word[w];
    leaf->setValueMask(on);
    leaves[size_t(l)] = std::move(leaf);
  });
  for (auto& leaf : leaves) grid.tree().root().addLeaf(leaf.release());
}

/// A grid whose active voxels are `voxels`, moved by whole leaves, each with value_at(its index).
template <class GridT, class ValueAt>
typename GridT::Ptr make_voxel_grid(const char* name, const typename GridT::ValueType& background,
                                    const VoxelSet& voxels, ValueAt value_at, Voxel by_vox = {0, 0, 0}) {
  auto grid = new_vdb_grid<GridT>(name, background);
  const VoxelSetView view = voxels.view();
  add_vdb_leaves(
      *grid, voxels.leaf_count(),
      [&](int64_t l) {
        const Voxel leaf = leaf_of_key(view.leaf_key[l]);
        return Voxel{leaf.x + by_vox.x / 8, leaf.y + by_vox.y / 8, leaf.z + by_vox.z / 8};
      },
      [&](int64_t l, typename GridT::ValueType* values) {
        for_each_active(view, l, [&](int offset, int64_t i) { values[offset] = value_at(l, offset, i); });
        return view.mask[l];
      });
  return grid;
}

/// An array as a grid: element i is voxel (i & 511) of leaf (i >> 9), leaves numbered by leaf key, so that they fill
/// the nodes of the tree one after another. T has the size of the grid's value.
template <class GridT, class T>
typename GridT::Ptr make_table_grid(const char* name, View<const T> elements) {
  using Value = typename GridT::ValueType;
  static_assert(sizeof(T) == sizeof(Value));
  auto grid = new_vdb_grid<GridT>(name, Value(0));
  add_vdb_leaves(
      *grid, (elements.size + 511) / 512, [](int64_t l) { return leaf_of_key(uint64_t(l)); },
      [&](int64_t l, Value* values) {
        const int64_t count = std::min<int64_t>(512, elements.size - l * 512);
        std::memcpy(static_cast<void*>(values), elements.data + l * 512, size_t(count) * sizeof(T));
        LeafMask mask{};
        for (int64_t w = 0; w < 8 && w * 64 < count; ++w)
          mask.word[w] = count - w * 64 >= 64 ? ~uint64_t(0) : (uint64_t(1) << (count - w * 64)) - 1;
        return mask;
      });
  return grid;
}

}  // namespace isoshell
