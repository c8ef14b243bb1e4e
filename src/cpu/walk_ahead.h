// Walks on the CPU: each starts somewhere else on the sheet, and would wait for memory four times in a row.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/sheet_walk.h"

namespace isoshell {

/// Asks for what the walks of the next elements begin with, one array earlier than the next.
class WalkAhead {
 public:
  WalkAhead(const WalkOntoSheet& walk, View<const uint32_t> home) : walk_(walk), home_(home) {}

  inline __attribute__((always_inline)) void before(int64_t i) const {
    if (i + 4 * kApart >= home_.size) return;
    const auto first = [&](int n) { return walk_.vertex_first.data + home_[i + n * kApart]; };
    __builtin_prefetch(first(4));
    __builtin_prefetch(walk_.vertex_triangles.data + *first(3));
    for (int64_t n = first(2)[0]; n < first(2)[1]; ++n)
      __builtin_prefetch(walk_.triangles.data + walk_.vertex_triangles[n]);
    for (int64_t n = first(1)[0]; n < first(1)[1]; ++n) {
      const TriangleIndices t = walk_.triangles[walk_.vertex_triangles[n]];
      for (const uint32_t v : {t.a, t.b, t.c}) __builtin_prefetch(walk_.position.data + v);
    }
  }

 private:
  static constexpr int kApart = 3;  ///< elements between two requests that depend on each other
  const WalkOntoSheet walk_;
  const View<const uint32_t> home_;
};

/// Taken instead of the template of stages/sheet_walk.h.
template <class Step>
void for_each_walk(TbbExecutor& exec, const char* name, const WalkOntoSheet& walk, View<const uint32_t> home,
                   Step step) {
  exec.for_each(name, home.size, [step, ahead = WalkAhead(walk, home)](int64_t i) {
    ahead.before(i);
    step(i);
  });
}

}  // namespace isoshell
