// Disjoint sets in one array of parents, joined from any thread. Roots hang below smaller roots only, so when all joins
// are done every set's root is its smallest member, whatever the schedule was.
#pragma once

#include "isoshell/advanced/buffer.h"
#include "voxel/atomic.h"

namespace isoshell {

/// Root of i; shortens the path on the way. Safe beside joins.
ISOSHELL_HD inline uint32_t find_root(View<uint32_t> parent, uint32_t i) {
  for (;;) {
    const uint32_t p = atomic_load(parent[i]);
    if (p == i) return i;
    const uint32_t g = atomic_load(parent[p]);
    if (g == p) return p;
    atomic_min(parent[i], g);
    i = g;
  }
}

/// Joins the sets of a and b.
ISOSHELL_HD inline void join(View<uint32_t> parent, uint32_t a, uint32_t b) {
  for (;;) {
    a = find_root(parent, a);
    b = find_root(parent, b);
    if (a == b) return;
    if (a < b) {
      const uint32_t c = a;
      a = b;
      b = c;
    }
    if (atomic_exchange_if(parent[a], a, b)) return;
  }
}

/// Step before all joins.
struct StartAlone {
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const { parent[i] = uint32_t(i); }
};

/// Step after all joins: every parent becomes the root. Other elements may still shorten paths, so it is written
/// atomically.
struct PointAtRoot {
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const { atomic_min(parent[i], find_root(parent, uint32_t(i))); }
};

}  // namespace isoshell
