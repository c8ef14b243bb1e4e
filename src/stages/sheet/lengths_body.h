// Edge lengths of a sheet (see stages.h): how fast they may grow, how many seeds they ask for, their way onto coarse
// proxies, and the curvature that adaptivity makes them from.
#pragma once

#include <utility>

#include "isoshell/advanced/stages.h"
#include "stages/labels/label_body.h"
#include "stages/sheet/sheet_graph.h"
#include "stages/sparse/vertex_grid_body.h"
#include "voxel/atomic.h"

namespace isoshell {
namespace lengths {

/// The neighbours of all vertices, listed. The steps visit them again and again, and find them slowly among triangles.
struct NeighboursView {
  View<const uint32_t> first;
  View<const uint32_t> listed;
  View<const uint32_t> border_before;

  template <class Visit>
  ISOSHELL_HD void for_each(uint32_t v, Visit visit) const {
    for (uint32_t n = first[v]; n < first[v + 1]; ++n) visit(listed[n]);
    if (is_on_border(v)) visit(border_before[v]);
  }
  ISOSHELL_HD bool is_on_border(uint32_t v) const { return border_before.size > 0 && border_before[v] != kNone; }
};
struct ListNeighbours {
  SheetGraph graph;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t v) const {
    uint32_t at = graph.first[v];
    graph.for_each_corner(uint32_t(v), [&](uint32_t next, uint32_t) { out[at++] = next; });
  }
};
class Neighbours {
 public:
  template <class Exec>
  Neighbours(Exec& exec, const SurfaceMesh& surface)
      : surface_(surface), listed_(exec.template make<uint32_t>(surface.vertex_triangles.size())) {
    exec.for_each("list neighbours", surface.vertex_count(), ListNeighbours{graph_of(surface), listed_.view()});
  }
  NeighboursView view() const { return {surface_.vertex_first.view(), listed_.view(), surface_.border_before.view()}; }

 private:
  const SurfaceMesh& surface_;
  Buffer<uint32_t> listed_;
};

/// How much lengths may grow on the way between neighbours: the same there and back.
struct Slope {
  View<const PointQ8> position;
  int64_t slope_q16;
  ISOSHELL_HD uint32_t between(uint32_t u, uint32_t v) const {
    const int64_t way = int64_t(isqrt(uint64_t(distance_sq_q16(position[u], position[v]))));
    const int64_t growth = way * slope_q16 >> 16;
    return growth < UINT32_MAX ? uint32_t(growth) : UINT32_MAX;
  }
};
struct ListGrowth {
  NeighboursView neighbours;
  Slope slope;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t v) const {
    for (uint32_t n = neighbours.first[v]; n < neighbours.first[v + 1]; ++n)
      out[n] = slope.between(uint32_t(v), neighbours.listed[n]);
  }
};

/// Lowers the lengths of a block's own vertices until they obey the limit towards one another and towards the vertices
/// of other blocks, whose lengths are those of the round before; then wakes the vertices of others that this concerns.
/// The limit is a shortest path over the sheet's edges: it has one fixed point, in whatever order vertices come to it.
struct LimitBlock {
  NeighboursView neighbours;
  View<const uint32_t> growth_to;  ///< on the way to each that is listed
  Slope slope;
  View<const int64_t> block_first;
  View<const uint32_t> from;
  View<uint32_t> to;
  View<const uint32_t> awake;  ///< per block
  View<uint32_t> wake;
  View<uint32_t> due;  ///< per vertex: a neighbour was lowered since it was looked at
  View<uint32_t> due_next;

  /// visit(u, growth) for every neighbour u of v.
  template <class Visit>
  ISOSHELL_HD void for_each_neighbour(uint32_t v, Visit visit) const {
    for (uint32_t n = neighbours.first[v]; n < neighbours.first[v + 1]; ++n) visit(neighbours.listed[n], growth_to[n]);
    if (neighbours.is_on_border(v)) visit(neighbours.border_before[v], slope.between(neighbours.border_before[v], v));
  }
  ISOSHELL_HD uint32_t beyond(uint32_t length, uint32_t growth) const {
    return length < UINT32_MAX - growth ? length + growth : UINT32_MAX;
  }
  ISOSHELL_HD bool lower(uint32_t v, int64_t begin, int64_t end) const {
    if (!due[v]) return false;
    due[v] = 0;
    uint32_t least = to[v];
    for_each_neighbour(v, [&](uint32_t u, uint32_t growth) {
      const uint32_t here = beyond(u >= begin && u < end ? to[u] : from[u], growth);
      least = here < least ? here : least;
    });
    if (least == to[v]) return false;
    to[v] = least;
    for_each_neighbour(v, [&](uint32_t u, uint32_t growth) {
      if (u >= begin && u < end && beyond(least, growth) < to[u]) due[u] = 1;
    });
    return true;
  }
  ISOSHELL_HD int64_t block_of(int64_t v) const {
    int64_t lo = 0, hi = block_first.size - 1;
    while (hi - lo > 1) {
      const int64_t mid = (lo + hi) / 2;
      (block_first[mid] <= v ? lo : hi) = mid;
    }
    return lo;
  }
  ISOSHELL_HD void operator()(int64_t block) const {
    if (!awake[block]) return;
    const int64_t begin = block_first[block], end = block_first[block + 1];
    for (bool lowered = true; lowered;) {
      lowered = false;
      for (int64_t v = begin; v < end; ++v) lowered |= lower(uint32_t(v), begin, end);
      for (int64_t v = end - 1; lowered && v >= begin; --v) lower(uint32_t(v), begin, end);
    }
    for (int64_t v = begin; v < end; ++v) {
      if (to[v] == from[v]) continue;
      for_each_neighbour(uint32_t(v), [&](uint32_t u, uint32_t growth) {
        if ((u >= begin && u < end) || beyond(to[v], growth) >= from[u]) return;
        atomic_or(due_next[u], 1u);
        atomic_or(wake[block_of(u)], 1u);
      });
    }
  }
};
struct IsAwake {
  View<const uint32_t> awake;
  ISOSHELL_HD int64_t operator()(int64_t block) const { return awake[block]; }
};
struct FindRange {
  View<const uint32_t> at;
  View<uint32_t> range;  ///< least and largest
  ISOSHELL_HD void operator()(int64_t v) const {
    atomic_min(range[0], at[v]);
    atomic_max(range[1], at[v]);
  }
};

struct CopyLength {
  VertexGridView vertices;
  View<const uint32_t> from;
  View<const PointQ8> position;
  int halvings;
  View<uint32_t> to;
  ISOSHELL_HD void operator()(int64_t v) const {
    const PointQ8 p = position[v];
    to[v] = from[nearest_vertex(vertices, {p.x << halvings, p.y << halvings, p.z << halvings}).id];
  }
};

constexpr int32_t kUnit = 1 << 14;  ///< length of a normal

struct StartNormal {
  View<const Normal8> normal;
  View<PointQ8> out;
  ISOSHELL_HD void operator()(int64_t v) const {
    const Normal8 n = normal[v];
    out[v] = {n.x * (kUnit / 128), n.y * (kUnit / 128), n.z * (kUnit / 128)};
  }
};
/// The mean of a vertex and its neighbours.
struct MeanNormal {
  NeighboursView neighbours;
  View<const PointQ8> from;
  View<PointQ8> to;
  ISOSHELL_HD void operator()(int64_t v) const {
    PointQ8 sum = from[v];
    int32_t count = 1;
    neighbours.for_each(uint32_t(v), [&](uint32_t u) {
      sum = {sum.x + from[u].x, sum.y + from[u].y, sum.z + from[u].z};
      ++count;
    });
    to[v] = {sum.x / count, sum.y / count, sum.z / count};
  }
};
struct UnitNormal {
  View<PointQ8> normal;
  ISOSHELL_HD void operator()(int64_t v) const {
    const PointQ8 n = normal[v];
    const int64_t length = int64_t(isqrt(uint64_t(distance_sq_q16(n, {0, 0, 0}))));
    if (length == 0) return;
    normal[v] = {int32_t(int64_t(n.x) * kUnit / length), int32_t(int64_t(n.y) * kUnit / length),
                 int32_t(int64_t(n.z) * kUnit / length)};
  }
};
/// How much the normal turns a voxel, the root of the mean square over the edges of a vertex, in 1/65536.
struct TurnOfNormal {
  NeighboursView neighbours;
  View<const PointQ8> position, normal;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t v) const {
    uint64_t turn_sq = 0, way_sq = 0;
    neighbours.for_each(uint32_t(v), [&](uint32_t u) {
      turn_sq += uint64_t(distance_sq_q16(normal[u], normal[v]));
      way_sq += uint64_t(distance_sq_q16(position[u], position[v]));
    });
    constexpr uint64_t kScale = uint64_t(65536 / kUnit * kOneVoxelQ8) * (65536 / kUnit * kOneVoxelQ8);
    out[v] = way_sq > 0 ? uint32_t(isqrt(turn_sq * kScale / way_sq)) : 0;
  }
};
struct MeanValue {
  NeighboursView neighbours;
  View<const uint32_t> from;
  View<uint32_t> to;
  ISOSHELL_HD void operator()(int64_t v) const {
    uint64_t sum = from[v], count = 1;
    neighbours.for_each(uint32_t(v), [&](uint32_t u) { sum += from[u], ++count; });
    to[v] = uint32_t((sum + count / 2) / count);
  }
};

/// The lengths with their range.
template <class Exec>
EdgeLengths with_range(Exec& exec, Buffer<uint32_t> at) {
  Buffer<uint32_t> range = exec.template make<uint32_t>(2);
  exec.fill(range.view().part(0, 1), UINT32_MAX);
  exec.fill(range.view().part(1, 1), 0u);
  exec.for_each("range of lengths", at.size(), FindRange{at.view(), range.view()});
  const uint32_t least = exec.value(View<const uint32_t>(range.view()), 0);
  const uint32_t largest = exec.value(View<const uint32_t>(range.view()), 1);
  return {std::move(at), least, largest};
}

/// The means, so many times.
template <class Exec>
void smooth_values(Exec& exec, const NeighboursView& neighbours, int32_t rounds, Buffer<uint32_t>& values) {
  Buffer<uint32_t> smooth = exec.template make<uint32_t>(values.size());
  for (int32_t r = 0; r < rounds; ++r) {
    exec.for_each("mean values", values.size(), MeanValue{neighbours, values.view(), smooth.view()});
    std::swap(values, smooth);
  }
}

}  // namespace lengths

/// `raw` lies in the executor's memory.
template <class Exec>
EdgeLengths limit_edge_lengths_body(Exec& exec, const SurfaceMesh& surface, Buffer<uint32_t> raw, int64_t slope_q16) {
  using namespace lengths;
  const int64_t blocks = surface.blocks.count(), vertices = surface.vertex_count();
  const Neighbours neighbours(exec, surface);
  const Slope slope{surface.position.view(), slope_q16};
  Buffer<uint32_t> growth = exec.template make<uint32_t>(neighbours.view().listed.size);
  exec.for_each("list growth", vertices, ListGrowth{neighbours.view(), slope, growth.view()});
  Buffer<uint32_t> next = exec.template make<uint32_t>(vertices);
  Buffer<uint32_t> awake = exec.template make<uint32_t>(blocks), wake = exec.template make<uint32_t>(blocks);
  Buffer<uint32_t> due = exec.template make<uint32_t>(vertices), due_next = exec.template make<uint32_t>(vertices);
  exec.fill(awake.view(), 1u);
  exec.fill(due.view(), 1u);
  exec.fill(due_next.view(), 0u);  // what is due is done in its round
  do {
    exec.fill(wake.view(), 0u);
    exec.copy(View<const uint32_t>(raw.view()), next.view());
    exec.for_each("limit lengths", blocks,
                  LimitBlock{neighbours.view(), growth.view(), slope, surface.blocks.first.view(), raw.view(),
                             next.view(), awake.view(), wake.view(), due.view(), due_next.view()});
    std::swap(raw, next);
    std::swap(due, due_next);
    std::swap(awake, wake);
  } while (exec.sum(blocks, IsAwake{awake.view()}) > 0);
  return with_range(exec, std::move(raw));
}

/// `at` lies in the executor's memory.
template <class Exec>
EdgeLengths smooth_edge_lengths_body(Exec& exec, const SurfaceMesh& surface, Buffer<uint32_t> at, int32_t rounds) {
  using namespace lengths;
  smooth_values(exec, Neighbours(exec, surface).view(), rounds, at);
  return with_range(exec, std::move(at));
}

template <class Exec>
int64_t seed_shares_body(Exec& exec, const SurfaceMesh& surface) {
  return exec.sum(surface.triangles.size(),
                  label::ShareOfSeeds{{surface.position.view(), surface.triangles.view()}, lengths_of(surface)});
}

template <class Exec>
EdgeLengths transfer_edge_lengths_body(Exec& exec, const SurfaceMesh& from, int halvings, const SurfaceMesh& to) {
  const VertexGrid grid(exec, from);
  Buffer<uint32_t> at = exec.template make<uint32_t>(to.vertex_count());
  exec.for_each("copy lengths", to.vertex_count(),
                lengths::CopyLength{grid.view(), from.lengths.at.view(), to.position.view(), halvings, at.view()});
  return {std::move(at), from.lengths.least, from.lengths.largest};
}

template <class Exec>
Buffer<uint32_t> measure_curvature_body(Exec& exec, const SurfaceMesh& surface, int32_t rounds) {
  using namespace lengths;
  const int64_t vertices = surface.vertex_count();
  const Neighbours neighbours(exec, surface);
  Buffer<PointQ8> normal = exec.template make<PointQ8>(vertices), mean = exec.template make<PointQ8>(vertices);
  exec.for_each("start normals", vertices, StartNormal{surface.normal.view(), normal.view()});
  for (int32_t r = 0; r < rounds; ++r) {
    exec.for_each("mean normals", vertices, MeanNormal{neighbours.view(), normal.view(), mean.view()});
    std::swap(normal, mean);
  }
  exec.for_each("unit normals", vertices, UnitNormal{normal.view()});
  Buffer<uint32_t> turn = exec.template make<uint32_t>(vertices);
  exec.for_each("turn of normals", vertices,
                TurnOfNormal{neighbours.view(), surface.position.view(), normal.view(), turn.view()});
  smooth_values(exec, neighbours.view(), rounds * 2 / 3, turn);
  return turn;
}

}  // namespace isoshell
