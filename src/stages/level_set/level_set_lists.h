// The triangles that reach each leaf, listed from the triangles' side.
#pragma once

#include "stages/level_set/level_set_triangles.h"
#include "voxel/atomic.h"

namespace isoshell {
namespace level_set_steps {

/// A triangle with one of the blocks of leaves that it may reach: what one thread looks through, however large the
/// triangle is.
struct Tile {
  uint32_t triangle, block;
};

/// Which blocks and leaves have a voxel centre that may be less than the band from a triangle.
struct ReachOfTriangle {
  Triangles triangles;
  VoxelSetView leaves;
  double band_vox;

  /// Calls visit(number of a block in the table).
  template <class Visit>
  ISOSHELL_HD void for_each_block(int64_t t, Visit visit) const {
    const Range all = leaves_of(t);
    const int32_t* const dims = leaves.block_dims;
    for_each_cube({all.lo.x >> 4, all.lo.y >> 4, all.lo.z >> 4}, {all.hi.x >> 4, all.hi.y >> 4, all.hi.z >> 4},
                  [&](Voxel b) {
                    const uint32_t number = (uint32_t(b.x) * dims[1] + b.y) * dims[2] + b.z;
                    if (leaves.block_table[number] != kNone && is_near(t, b, 128)) visit(number);
                  });
  }

  /// Calls visit(number of a leaf).
  template <class Visit>
  ISOSHELL_HD void for_each_leaf(Tile tile, Visit visit) const {
    const Range all = leaves_of(tile.triangle);
    const uint32_t wide = uint32_t(leaves.block_dims[1]), deep = uint32_t(leaves.block_dims[2]);
    const Voxel first{int32_t(tile.block / (wide * deep)) * 16, int32_t(tile.block / deep % wide) * 16,
                      int32_t(tile.block % deep) * 16};
    for_each_cube(
        {larger_of(all.lo.x, first.x), larger_of(all.lo.y, first.y), larger_of(all.lo.z, first.z)},
        {smaller_of(all.hi.x, first.x + 15), smaller_of(all.hi.y, first.y + 15), smaller_of(all.hi.z, first.z + 15)},
        [&](Voxel at) {
          const uint32_t leaf = find_leaf(leaves, at);
          if (leaf != kNone && is_near(tile.triangle, at, 8)) visit(leaf);
        });
  }

 private:
  struct Range {
    Voxel lo, hi;
  };

  ISOSHELL_HD Range leaves_of(int64_t t) const {
    using triangle_search::larger;
    using triangle_search::smaller;
    const WorldPoint* const c = triangles.of(t);
    const WorldPoint a = c[0], b = c[1], d = c[2];
    const auto first = [&](double p, double q, double r) {
      return int32_t(larger(smaller(smaller(p, q), r) - band_vox - 1, 0)) >> 3;
    };
    const auto last = [&](double p, double q, double r, int32_t blocks) {
      return int32_t(larger(smaller(larger(larger(p, q), r) + band_vox + 1, blocks * 128.0 - 1), 0)) >> 3;
    };
    const int32_t* const dims = leaves.block_dims;
    return {{first(a.x, b.x, d.x), first(a.y, b.y, d.y), first(a.z, b.z, d.z)},
            {last(a.x, b.x, d.x, dims[0]), last(a.y, b.y, d.y, dims[1]), last(a.z, b.z, d.z, dims[2])}};
  }

  /// Whether some voxel centre of a cube of so many voxels a side may be less than the band away.
  ISOSHELL_HD bool is_near(int64_t t, Voxel cube, int side) const {
    const double half = side / 2.0, half_of_centres = half - 0.5;
    const WorldPoint middle{side * cube.x + half, side * cube.y + half, side * cube.z + half};
    const Disc& disc = triangles.disc[t];
    if (!disc.is_near_cube(middle, half_of_centres, band_vox)) return false;
    constexpr double kSmall = 4;  // the disc says as much as the triangle, nearly
    if (disc.radius <= kSmall) return true;
    const double within = band_vox + half_of_centres * 1.7320508075688772 + Disc::kSlack;
    return triangles.nearest(middle, t).distance_sq <= within * within;
  }

  ISOSHELL_HD static int32_t smaller_of(int32_t a, int32_t b) { return a < b ? a : b; }
  ISOSHELL_HD static int32_t larger_of(int32_t a, int32_t b) { return a > b ? a : b; }
  template <class Visit>
  ISOSHELL_HD static void for_each_cube(Voxel from, Voxel to, Visit visit) {
    for (int32_t x = from.x; x <= to.x; ++x)
      for (int32_t y = from.y; y <= to.y; ++y)
        for (int32_t z = from.z; z <= to.z; ++z) visit(Voxel{x, y, z});
  }
};

struct CountTiles {
  ReachOfTriangle reach;
  ISOSHELL_HD int64_t operator()(int64_t t) const {
    int64_t tiles = 0;
    reach.for_each_block(t, [&](uint32_t) { ++tiles; });
    return tiles;
  }
};

struct FillTiles {
  ReachOfTriangle reach;
  View<const int64_t> first;
  View<Tile> tile;
  ISOSHELL_HD void operator()(int64_t t) const {
    int64_t at = first[t];
    reach.for_each_block(t, [&](uint32_t block) { tile[at++] = {uint32_t(t), block}; });
  }
};

struct CountListed {
  ReachOfTriangle reach;
  View<const Tile> tile;
  View<uint32_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    reach.for_each_leaf(tile[i], [&](uint32_t leaf) { atomic_add(count[leaf], 1u); });
  }
};

/// Fills lists from their ends. Their order does not matter: what is made of them are minima.
struct ListTriangles {
  ReachOfTriangle reach;
  View<const Tile> tile;
  View<const int64_t> first;
  View<uint32_t> left, listed;
  ISOSHELL_HD void operator()(int64_t i) const {
    reach.for_each_leaf(
        tile[i], [&](uint32_t leaf) { listed[first[leaf] + atomic_take_one_below(left[leaf])] = tile[i].triangle; });
  }
};

struct ListedIn {
  View<const uint32_t> count;
  ISOSHELL_HD int64_t operator()(int64_t leaf) const { return count[leaf]; }
};

/// The triangles that reach each leaf.
struct Lists {
  Buffer<int64_t> first;  ///< of each leaf, and an end
  Buffer<uint32_t> triangle;
};

template <class Exec>
Lists list_triangles(Exec& exec, const ReachOfTriangle& reach) {
  const int64_t leaves = reach.leaves.leaf_key.size, triangles = reach.triangles.count();
  Buffer<int64_t> first_tile = exec.template make<int64_t>(triangles);
  Buffer<Tile> tile = exec.template make<Tile>(exec.exclusive_scan_of(triangles, CountTiles{reach}, first_tile.view()));
  exec.for_each("fill tiles", triangles, FillTiles{reach, first_tile.view(), tile.view()});
  Buffer<uint32_t> count = exec.template make<uint32_t>(leaves);
  exec.fill(count.view(), 0u);
  exec.for_each("count triangles", tile.size(), CountListed{reach, tile.view(), count.view()});
  Lists lists{exec.template make<int64_t>(leaves + 1), {}};
  lists.triangle =
      exec.template make<uint32_t>(exec.exclusive_scan_of(leaves, ListedIn{count.view()}, lists.first.view()));
  exec.for_each("list triangles", tile.size(),
                ListTriangles{reach, tile.view(), lists.first.view(), count.view(), lists.triangle.view()});
  return lists;
}

}  // namespace level_set_steps
}  // namespace isoshell
