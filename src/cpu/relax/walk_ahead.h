// Walks on the CPU: each starts somewhere else on the sheet, and would wait for memory four times in a row.
#pragma once

#include "cpu/executor_tbb.h"
#include "cpu/sheet/foot_simd.h"
#include "stages/sheet/sheet_walk.h"

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

/// Walks to the targets of elements one after the other; the triangles at their ends are taken in lanes.
template <class Step>
class WalksSimd {
 public:
  WalksSimd(const WalkOntoSheet& walk, View<uint32_t> home, const Step& step) : walk_(walk), home_(home), step_(step) {}
  ~WalksSimd() { arrive(); }

  void add(int64_t i, PointQ8 target) {
    if (feet_ + kMostAround > FootSimd::kLanes) arrive();
    const uint32_t vertex = walk_to(home_[i], target);
    if (walk_.vertex_first[vertex + 1] - walk_.vertex_first[vertex] > kMostAround)
      return step_.arrives(i, vertex, walk_.closest_around(vertex, target));
    element_[walks_] = i, vertex_[walks_] = vertex, first_[walks_] = feet_;
    ++walks_;
    feet_ += around_;
  }

 private:
  static constexpr int kMostAround = 24;  ///< triangles around a vertex, where it goes in lanes

  /// walk.nearest_vertex, which leaves what it saw last in the lanes from feet_ on.
  uint32_t walk_to(uint32_t from, PointQ8 p) {
    int64_t best = distance_sq_q16(walk_.position[from], p);
    for (;;) {
      uint32_t next = from;
      around_ = 0;
      for (int64_t n = walk_.vertex_first[from]; n < walk_.vertex_first[from + 1]; ++n) {
        const TriangleIndices t = walk_.triangles[walk_.vertex_triangles[n]];
        const PointQ8 a = walk_.position[t.a], b = walk_.position[t.b], c = walk_.position[t.c];
        const int at = feet_ + (around_ < kMostAround ? around_++ : 0);
        lanes_.p.set(at, p), lanes_.a.set(at, a), lanes_.b.set(at, b), lanes_.c.set(at, c);
        const uint32_t v = t.a == from ? t.b : (t.b == from ? t.c : t.a);
        const PointQ8 q = t.a == from ? b : (t.b == from ? c : a);
        const int64_t d = distance_sq_q16(q, p);
        const bool nearer = (d < best) | ((d == best) & (v < next));
        best = nearer ? d : best, next = nearer ? v : next;
      }
      if (walk_.is_on_border(from)) {
        const uint32_t v = walk_.border_before[from];
        const int64_t d = distance_sq_q16(walk_.position[v], p);
        if (d < best || (d == best && v < next)) best = d, next = v;
      }
      if (next == from) return from;
      from = next;
    }
  }
  void arrive() {
    lanes_.find(feet_);
    first_[walks_] = feet_;
    for (int w = 0; w < walks_; ++w) {
      int best = first_[w];
      for (int k = best + 1; k < first_[w + 1]; ++k) best = lanes_.distance_sq[k] < lanes_.distance_sq[best] ? k : best;
      step_.arrives(element_[w], vertex_[w], lanes_.foot.at(best));
    }
    walks_ = feet_ = 0;
  }

  const WalkOntoSheet walk_;
  const View<uint32_t> home_;
  const Step& step_;
  FootSimd lanes_;
  int walks_ = 0, feet_ = 0, around_ = 0;
  int64_t element_[FootSimd::kLanes];
  uint32_t vertex_[FootSimd::kLanes];
  int first_[FootSimd::kLanes + 1];
};

/// PlainWalks of stages/sheet/sheet_walk.h, a run of elements after the other.
class WalksAhead {
 public:
  template <class Step>
  static void for_each(CpuExecutor& exec, const char* name, const WalkOntoSheet& walk, View<const uint32_t> home,
                       Step step) {
    exec.for_each(name, runs(home.size), [step, home, ahead = WalkAhead(walk, home)](int64_t run) {
      const int64_t end = end_of(run, home.size);
      for (int64_t i = run * kRun; i < end; ++i) {
        ahead.before(i, end);
        step(i);
      }
    });
  }

  template <class Step>
  static void to_targets(CpuExecutor& exec, const char* name, const WalkOntoSheet& walk, View<uint32_t> home,
                         Step step) {
    exec.for_each(name, runs(home.size), [walk, step, home, ahead = WalkAhead(walk, home)](int64_t run) {
      const int64_t end = end_of(run, home.size);
      WalksSimd<Step> walks(walk, home, step);
      for (int64_t i = run * kRun; i < end; ++i) {
        ahead.before(i, end);
        PointQ8 target;
        if (step.aims(i, target)) walks.add(i, target);
      }
    });
  }

 private:
  static constexpr int64_t kRun = 128;  ///< elements
  static int64_t runs(int64_t count) { return (count + kRun - 1) / kRun; }
  static int64_t end_of(int64_t run, int64_t count) { return std::min(count, (run + 1) * kRun); }
};

}  // namespace isoshell
