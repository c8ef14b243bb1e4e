// Walks on the CPU: each starts somewhere else on the sheet, and would wait for memory four times in a row.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/sheet_walk.h"

namespace isoshell {

/// Asks for what the walks of the next elements begin with, one array earlier than the next.
class WalkAhead {
 public:
  WalkAhead(const WalkOntoSheet& walk, View<const uint32_t> home) : walk_(walk), home_(home) {}

  /// Called before element i, whose thread goes on to `end`; other threads may be writing what is beyond. Inlined by
  /// force: a function that only asks for memory is taken for one without effect, and its call is left out.
  inline __attribute__((always_inline)) void before(int64_t i, int64_t end) const {
    if (i + 4 * kApart >= end) return;
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
  constexpr int64_t kRun = 128;
  exec.for_each(name, (home.size + kRun - 1) / kRun, [step, home, ahead = WalkAhead(walk, home)](int64_t run) {
    const int64_t end = std::min(home.size, (run + 1) * kRun);
    for (int64_t i = run * kRun; i < end; ++i) {
      ahead.before(i, end);
      step(i);
    }
  });
}

}  // namespace isoshell
