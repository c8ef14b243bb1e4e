// See cells.h.
#include "repair/regions/cells.h"

#include <algorithm>
#include <cstddef>
#include <map>
#include <utility>

#include "core/index_sets.h"
#include "core/watched.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"
#include "measure/around_edge.h"
#include "repair/arrangement/step_frame.h"
#include "repair/solids/winding.h"

namespace isoshell::repair {
namespace {

/// Side 2 w is the front of wall w, and 2 w + 1 its back.
uint32_t side(uint32_t wall, bool is_back) { return 2 * wall + (is_back ? 1 : 0); }

class CellFinder {
 public:
  CellFinder(const Walls& walls, const Context& context)
      : walls_(walls),
        context_(context),
        count_(uint32_t(walls.triangle.size())),
        shells_(2 * int64_t(count_)),
        surfaces_(int64_t(count_)) {}

  Cells found() {
    join_around_edges();
    measure_shells();
    find_outer_sides();
    nest();
    return numbered();
  }

 private:
  /// Between two neighbours around an edge is one cell.
  void join_around_edges() {
    const EdgeSides edges = find_edge_sides(walls_.triangle, walls_.point.size());
    const StepFrame frame(walls_.box);
    std::vector<WorldPoint> on_lattice;
    for (const WorldPoint& p : walls_.point) on_lattice.push_back(as_world(frame.from(p)));
    CancelWatch watch(context_, "regions");
    for_each_edge(edges, [&](uint32_t u, uint32_t v, View<const EdgeSide> at_edge) {
      watch.check();
      std::vector<TriangleAtEdge> around = triangles_at_edge(walls_.triangle, u, at_edge);
      if (around.size() > 2) sort_around_edge(on_lattice, u, v, around);
      for (size_t i = 0; i < around.size(); ++i) {
        const TriangleAtEdge &here = around[i], &next = around[(i + 1) % around.size()];
        shells_.unite(side(here.triangle, !here.rises), side(next.triangle, next.rises));
        surfaces_.unite(here.triangle, next.triangle);
      }
    });
  }

  /// Six times what lies in a shell, about a corner of its surface: below 0 for the one that is around a surface.
  void measure_shells() {
    volume6_.assign(2 * size_t(count_), 0);
    for (uint32_t w = 0; w < count_; ++w) {
      const WorldPoint& o = walls_.point[walls_.triangle[surfaces_.root(w)][0]];
      const auto& [a, b, c] = walls_.triangle[w];
      const double volume6 = dot(walls_.point[a] - o, cross(walls_.point[b] - o, walls_.point[c] - o));
      volume6_[shells_.root(side(w, true))] += volume6;
      volume6_[shells_.root(side(w, false))] -= volume6;
    }
  }

  /// Per surface the shell that is around it.
  void find_outer_sides() {
    outer_.assign(count_, kNone);
    for (uint32_t s = 0; s < 2 * count_; ++s) {
      if (shells_.root(s) != s) continue;
      uint32_t& outer = outer_[surfaces_.root(s / 2)];
      if (outer == kNone || volume6_[s] < volume6_[outer]) outer = s;
    }
  }

  /// Of each surface the shells of others that are around one of its points. Around a surface lie the cells of those
  /// that it lies in, so the innermost is the one that lies in most others.
  void nest() {
    std::vector<uint32_t> roots;
    for (uint32_t w = 0; w < count_; ++w)
      if (surfaces_.root(w) == w) roots.push_back(w);
    if (roots.size() < 2) return;
    const RayColumns rays(walls_.point, walls_.triangle);
    std::vector<std::vector<uint32_t>> around(count_);
    for (const uint32_t r : roots) {
      check_cancel(context_, "regions");
      around[r] = shells_around(rays, r);
    }
    for (const uint32_t r : roots) {
      uint32_t innermost = kNone;
      size_t most = 0;
      for (const uint32_t shell : around[r]) {
        const size_t depth = around[surfaces_.root(shell / 2)].size() + 1;
        if (depth > most) innermost = shell;
        most = std::max(most, depth);
      }
      lies_in_.push_back({r, innermost});
    }
  }

  /// A ray from the surface's first wall leaves each shell that it is in once more often than it enters it.
  std::vector<uint32_t> shells_around(const RayColumns& rays, uint32_t root) {
    const auto& [a, b, c] = walls_.triangle[root];
    const WorldPoint middle = (1. / 3) * (walls_.point[a] + walls_.point[b] + walls_.point[c]);
    std::map<uint32_t, int> left;
    rays.for_each_crossing(
        middle, root, [&](uint32_t w) { return surfaces_.root(w) != root; },
        [&](uint32_t w, int sign) {  // 1: from the back to the front
          ++left[shells_.root(side(w, sign > 0))];
          --left[shells_.root(side(w, sign < 0))];
        });
    std::vector<uint32_t> shells;
    for (const auto& [shell, times] : left)
      if (times > 0 && shell != outer_[surfaces_.root(shell / 2)]) shells.push_back(shell);
    return shells;
  }

  /// Joins what nest() found, and numbers cells as they come up along the walls.
  Cells numbered() {
    IndexSets cells(2 * int64_t(count_) + 1);  // the last one is outside
    const uint32_t outside = 2 * count_;
    for (uint32_t s = 0; s < 2 * count_; ++s) cells.unite(s, shells_.root(s));
    for (const auto& [root, shell] : lies_in_) cells.unite(outer_[root], shell == kNone ? outside : shell);
    if (lies_in_.empty() && count_ > 0) cells.unite(outer_[surfaces_.root(0)], outside);
    std::vector<uint32_t> number(2 * size_t(count_) + 1, kNone);
    number[cells.root(outside)] = 0;
    Cells out;
    out.volume_world = {0};
    out.of_wall.resize(count_);
    for (uint32_t w = 0; w < count_; ++w)
      for (const bool is_back : {true, false}) {
        const uint32_t cell = cells.root(side(w, is_back));
        if (number[cell] == kNone) {
          number[cell] = uint32_t(out.volume_world.size());
          out.volume_world.push_back(0);
        }
        out.of_wall[w][is_back ? 1 : 0] = number[cell];
      }
    for (uint32_t s = 0; s < 2 * count_; ++s)
      if (const uint32_t cell = out.of_wall[s / 2][s % 2]; shells_.root(s) == s && cell != 0)
        out.volume_world[cell] += volume6_[s] / 6;
    return out;
  }

  const Walls& walls_;
  const Context& context_;
  uint32_t count_;
  IndexSets shells_;    ///< of sides that walls of one surface look on
  IndexSets surfaces_;  ///< of walls that are connected through edges
  std::vector<double> volume6_;
  std::vector<uint32_t> outer_;
  std::vector<std::pair<uint32_t, uint32_t>> lies_in_;  ///< of each surface the shell of another one
};

}  // namespace

Cells find_cells(const Walls& walls, const Context& context) { return CellFinder(walls, context).found(); }

}  // namespace isoshell::repair
