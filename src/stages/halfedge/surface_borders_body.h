// The borders of a surface mesh as chains, from what is around each vertex.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace borders {

/// Joins both ends of a border edge to one loop.
struct JoinLoop {
  View<const uint32_t> before;
  View<uint32_t> loop;
  ISOSHELL_HD void operator()(int64_t v) const {
    if (before[v] != kNone) join(loop, uint32_t(v), before[v]);
  }
};
/// The smallest vertex of a loop.
struct BeginsLoop {
  View<const uint32_t> before, loop;
  ISOSHELL_HD bool operator()(int64_t v) const { return before[v] != kNone && loop[v] == v; }
};
/// From the first vertex of a loop along the border.
template <class Visit>
ISOSHELL_HD inline void follow_loop(View<const uint32_t> after, uint32_t first, Visit visit) {
  uint32_t v = first;
  do {
    visit(v);
    v = after[v];
  } while (v != first);
}
struct CountLoop {
  View<const uint32_t> after, begin;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t i) const {
    int64_t n = 0;
    follow_loop(after, begin[i], [&](uint32_t) { ++n; });
    count[i] = n;
  }
};
struct FillLoop {
  View<const uint32_t> after, begin;
  View<const int64_t> first;
  View<uint32_t> vertex;
  ISOSHELL_HD void operator()(int64_t i) const {
    int64_t at = first[i];
    follow_loop(after, begin[i], [&](uint32_t v) { vertex[at++] = v; });
  }
};

}  // namespace borders

/// Finds the chains of a surface that knows border_before. `after` is what that is the inverse of: per vertex the next
/// one on its border. Every component of a border is a loop. Cost: O(vertices), a thread a loop.
template <class Exec>
void chain_borders(Exec& exec, View<const uint32_t> after, SurfaceMesh& surface) {
  using namespace borders;
  const int64_t vertices = surface.vertex_count();
  const View<const uint32_t> before = surface.border_before.view();
  Buffer<uint32_t> loop = exec.template make<uint32_t>(vertices);
  exec.for_each("start loops", vertices, StartAlone{loop.view()});
  exec.for_each("join loops", vertices, JoinLoop{before, loop.view()});
  exec.for_each("root loops", vertices, PointAtRoot{loop.view()});
  const Buffer<uint32_t> begin = exec.select(vertices, BeginsLoop{before, loop.view()});

  const int64_t loops = begin.size();
  Chains& chains = surface.chains;
  chains.first = exec.template make<int64_t>(loops + 1);
  exec.fill(chains.first.view().part(loops, 1), int64_t(0));
  exec.for_each("count loops", loops, CountLoop{after, begin.view(), chains.first.view()});
  chains.vertex = exec.template make<uint32_t>(exec.exclusive_scan(chains.first.view()));
  exec.for_each("fill loops", loops, FillLoop{after, begin.view(), chains.first.view(), chains.vertex.view()});
  chains.kind = exec.template make<ChainKind>(loops);
  exec.fill(chains.kind.view(), ChainKind::border);
  chains.is_loop = exec.template make<uint8_t>(loops);
  exec.fill(chains.is_loop.view(), uint8_t(1));
}

}  // namespace isoshell
