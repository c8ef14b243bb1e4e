// graded_lengths (see vertex_graph.h).
#include <algorithm>

#include "core/parallel_ranges.h"
#include "features/mesh/vertex_graph.h"

namespace isoshell {
namespace {

/// Vertices that are listed once, from any thread and in any order.
class VertexList {
 public:
  explicit VertexList(uint32_t vertices) : listed_(vertices) {}

  void add(uint32_t v) { listed_[__atomic_fetch_add(&count_, 1, __ATOMIC_RELAXED)] = v; }
  void clear() { count_ = 0; }
  bool empty() const { return count_ == 0; }
  template <class Visit>
  void for_each(Visit visit) const {
    for_each_index(uint32_t(0), count_, [&](uint32_t i) { visit(listed_[i]); });
  }
  double least(const std::vector<double>& value) const {
    double least = value[listed_[0]];
    for (uint32_t i = 1; i < count_; ++i) least = std::min(least, value[listed_[i]]);
    return least;
  }

 private:
  Buffer<uint32_t> listed_;
  uint32_t count_ = 0;
};

/// Lengths that spread. What a thread lowers it lists, unless it is listed.
class SpreadingLengths {
 public:
  SpreadingLengths(const VertexGraph& graph, const std::vector<double>& own, double growth)
      : graph_(graph),
        growth_(growth),
        value_(own),
        is_listed_(own.size(), 0),
        now_(uint32_t(own.size())),
        next_(uint32_t(own.size())),
        later_(uint32_t(own.size())) {}

  std::vector<double> graded() {
    if (value_.empty()) return {};
    const double longest = *std::max_element(value_.begin(), value_.end()), band = growth_ * longest;
    for_each_index(uint32_t(0), uint32_t(value_.size()), [&](uint32_t v) {
      if (value_[v] == longest) return;
      bool spreads = false;
      graph_.for_each(v, [&](uint32_t u, double way) { spreads |= grown(value_[v], way) < value_[u]; });
      is_listed_[v] = spreads;
      if (spreads) later_.add(v);
    });
    while (!later_.empty()) {
      const double end = later_.least(value_) + band;
      std::swap(now_, later_);
      later_.clear();
      for (; !now_.empty(); std::swap(now_, next_)) {
        next_.clear();
        now_.for_each([&](uint32_t v) { load(value_[v]) <= end ? spread(v) : later_.add(v); });
      }
    }
    return std::move(value_);
  }

 private:
  double grown(double length, double way) const { return length + growth_ * way; }
  void spread(uint32_t v) {
    __atomic_exchange_n(&is_listed_[v], uint8_t(0), __ATOMIC_ACQ_REL);  // who lowers it from now on lists it again
    const double length = load(value_[v]);
    graph_.for_each(v, [&](uint32_t u, double way) {
      if (lower(value_[u], grown(length, way)) && !__atomic_exchange_n(&is_listed_[u], uint8_t(1), __ATOMIC_ACQ_REL))
        next_.add(u);
    });
  }
  static double load(const double& value) {
    double seen;
    __atomic_load(&value, &seen, __ATOMIC_RELAXED);
    return seen;
  }
  static bool lower(double& value, double to) {
    double seen = load(value);
    while (to < seen)
      if (__atomic_compare_exchange(&value, &seen, &to, true, __ATOMIC_RELAXED, __ATOMIC_RELAXED)) return true;
    return false;
  }

  const VertexGraph& graph_;
  double growth_;
  std::vector<double> value_;
  std::vector<uint8_t> is_listed_;
  VertexList now_, next_, later_;
};

}  // namespace

std::vector<double> graded_lengths(const VertexGraph& graph, const std::vector<double>& own, double growth) {
  return SpreadingLengths(graph, own, growth).graded();
}

}  // namespace isoshell
