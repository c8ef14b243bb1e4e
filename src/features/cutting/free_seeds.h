// The free seeds of a cut surface, which are inside of its patches.
#pragma once

#include "features/cutting/cut_surface.h"
#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Counts and places free seeds, patch by patch: none ever moves to another one.
class FreeSeeds {
 public:
  using Counts = std::vector<int64_t>;  ///< per patch

  /// The surface must outlive it. Cost: O(surface).
  explicit FreeSeeds(const CutSurface& cut);

  /// As many as it takes for `vertices` places in all, where fixed seeds that are joined are one place. Patches share
  /// them by what Euler's formula leaves for their inside: a patch with area A, a border of b seeds and Euler
  /// characteristic x has 2 / sqrt(3) A / e^2 - b / 2 + x inner vertices. A patch has no more than half of its
  /// vertices; what there is no room for goes to others. A loop of the border that is shorter than three edges has more
  /// seeds than edges of that length: b counts the edges. Throws: usage when the fixed seeds alone are more than that,
  /// or no patch has room.
  Counts counts(const SeedSet& fixed, int64_t vertices) const;
  /// Places that it takes at least.
  int64_t fewest(const SeedSet& fixed) const;
  /// Places that lengths ask for: all fixed ones, and inside of each patch what its area leaves beside its border. More
  /// than vertices_of_lengths says, where patches have more on their borders than that.
  double by_length(const SeedSet& fixed) const;
  /// Closed patches without fixed seeds, and the handles of these.
  int64_t closed_parts(const SeedSet& fixed) const;
  /// As many as have the finer counts once there is a seed on each of their dual's edges, where `fixed` are those of
  /// the coarser level.
  Counts coarser(const SeedSet& fixed, const Counts& finer) const;

  /// As many in all as are wanted, and in each patch what it had before, as far as that is within an eighth of what
  /// is wanted there, or eight.
  Counts as_before(const Counts& wanted, const Counts& before) const;

  /// Spread at random, as place_seeds does it: each in a triangle that has a vertex off the border, which is its home.
  SeedSet add(SeedSet fixed, const Counts& counts, uint64_t seed) const;
  /// Those of a coarser level, or of another mesh, the first ones of each patch, and the middles of its inner edges,
  /// the longest first; at random where these are too few.
  SeedSet add_finer(SeedSet fixed, const Counts& counts, const SeededMesh& coarse, uint64_t seed) const;

 private:
  struct Patch {
    int64_t share = 0;                ///< of the seeds: its doubled area, less where edges are longer
    int64_t euler = 0, inside = 0;    ///< Euler characteristic; vertices off the border
    std::vector<uint32_t> triangles;  ///< those with a vertex inside
    std::vector<int64_t> before;      ///< per one of these the shares of those before it
    int64_t share_inside = 0;         ///< of all of these
  };
  struct FreeSeed {
    PointQ8 position;
    uint32_t home;
  };
  using Placed = std::vector<std::vector<FreeSeed>>;  ///< per patch

  size_t patch_of(uint32_t vertex) const { return cut_.surface.patch[vertex]; }
  bool is_inside(uint32_t vertex) const { return cut_.place[vertex] == kNone; }
  /// A loop of a border that is shorter than three edges.
  struct TinyLoop {
    size_t patch;
    double edges;  ///< of the length aimed at, all around it
  };

  int64_t seed_share(TriangleIndices t) const;
  void find_tiny_loops();
  std::vector<double> on_border_by_length(const SeedSet& fixed) const;
  Counts fixed_of(const SeedSet& fixed) const;
  void fill(int64_t seeds, std::vector<double> demand, std::vector<double> area, Counts& counts) const;
  FreeSeed seed_in(uint32_t triangle, uint64_t random) const;
  void spread(const Patch& patch, int64_t count, uint64_t seed, std::vector<FreeSeed>& out) const;
  uint32_t inside_near(uint32_t from, PointQ8 target) const;
  Placed middles_of_edges(const SeededMesh& coarse, Placed placed, const Counts& counts) const;
  SeedSet with_fixed(SeedSet fixed, const Placed& placed) const;

  const CutSurface& cut_;
  std::vector<Patch> patches_;
  std::vector<TinyLoop> tiny_loops_;
  std::vector<uint32_t> tiny_loop_of_;  ///< per vertex; kNone elsewhere; empty: there are none
};

}  // namespace isoshell
