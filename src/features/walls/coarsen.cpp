// coarsen (see coarsen.h).
#include "features/walls/coarsen.h"

#include <algorithm>
#include <limits>
#include <queue>
#include <utility>

#include "core/watched.h"

namespace isoshell {
namespace {

constexpr double kErrorWeight = 2;  ///< of the squared distance from the walls, beside that of a squared edge
constexpr double kMostNarrow = 30;  ///< sum of the squared edges of a triangle over twice its area
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr int64_t kStepsBetweenLooks = 1024;

/// The mean of squared distances from planes, weighted by areas.
struct Quadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0, x = 0, y = 0, z = 0, c = 0, weight = 0;

  void add_plane(const WorldPoint& normal, const WorldPoint& on, double area) {
    const double d = -dot(normal, on);
    add({area * normal.x * normal.x, area * normal.x * normal.y, area * normal.x * normal.z, area * normal.y * normal.y,
         area * normal.y * normal.z, area * normal.z * normal.z, area * normal.x * d, area * normal.y * d,
         area * normal.z * d, area * d * d, area});
  }
  void add(const Quadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    x += o.x, y += o.y, z += o.z, c += o.c, weight += o.weight;
  }
  double at(const WorldPoint& p) const {
    const double sum = p.x * (xx * p.x + 2 * (xy * p.y + xz * p.z + x)) + p.y * (yy * p.y + 2 * (yz * p.z + y)) +
                       p.z * (zz * p.z + 2 * z) + c;
    return weight > 0 ? std::max(0., sum) / weight : 0;
  }
};

class Coarsening {
 public:
  explicit Coarsening(WallMesh& mesh)
      : mesh_(mesh), quadric_(mesh.vertices().size()), least_(mesh.vertices().size(), kNever) {
    for (const RegionTriangle& t : mesh.triangles()) {
      const WorldPoint& a = mesh.at(t.corner[0]);
      const WorldPoint n = doubled_area(a, mesh.at(t.corner[1]), mesh.at(t.corner[2]));
      if (const double size = length(n); size > 0)
        for (const uint32_t v : t.corner) quadric_[v].add_plane((1 / size) * n, a, size / 6);
    }
  }

  void run(int64_t vertices, const Context& context) {
    if (mesh_.vertex_count() <= vertices) return;
    for (uint32_t v = 0; v < least_.size(); ++v) push(v);
    for (int64_t step = 0; mesh_.vertex_count() > vertices && !queue_.empty(); ++step) {
      if (step % kStepsBetweenLooks == 0) check_cancel(context, "features");
      const Entry top = queue_.top();
      queue_.pop();
      if (!mesh_.around(top.vertex).empty() && top.cost == least_[top.vertex]) take(top.vertex);
    }
  }

 private:
  struct Entry {
    double cost;
    uint32_t vertex;

    bool operator<(const Entry& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
  };

  /// Of taking a vertex into another one: the longest edge that comes of it, squared, more where triangles are narrow.
  double cost(uint32_t gone, uint32_t into) const {
    double longest_sq = 0, worst = 1;
    for (const uint32_t t : mesh_.around(gone)) {
      const auto& c = mesh_.triangles()[t].corner;
      const size_t i = c[0] == gone ? 0 : c[1] == gone ? 1 : 2;
      const uint32_t v = c[(i + 1) % 3], w = c[(i + 2) % 3];
      if (v == into || w == into) continue;
      const WorldPoint &p = mesh_.at(into), &q = mesh_.at(v), &r = mesh_.at(w);
      const double pq = distance_sq(p, q), pr = distance_sq(p, r), doubled = length(doubled_area(p, q, r));
      longest_sq = std::max({longest_sq, pq, pr});
      const double narrow = pq + pr + distance_sq(q, r);
      worst = narrow < kMostNarrow * doubled ? std::max(worst, narrow / (kTwoRootThree * doubled)) : kMostNarrow;
    }
    const double aimed_at = mesh_.aimed_at(gone);
    return (longest_sq * (1 + worst) / 2 + kErrorWeight * quadric_[gone].at(mesh_.at(into))) / (aimed_at * aimed_at);
  }

  void list_ways(uint32_t v) {
    mesh_.list_targets(v, targets_);
    ways_.clear();
    for (const uint32_t w : targets_) ways_.push_back({cost(v, w), w});
    std::sort(ways_.begin(), ways_.end());
  }
  void push(uint32_t v, double cost) {
    if (cost >= least_[v]) return;
    least_[v] = cost;
    queue_.push({cost, v});
  }
  void push(uint32_t v) {
    mesh_.list_targets(v, targets_);
    for (const uint32_t w : targets_) push(v, cost(v, w));
  }

  /// Collapses the edge of a vertex that costs the least, of those that can be; later where all have become dearer.
  void take(uint32_t v) {
    const double expected = least_[v];
    least_[v] = kNever;
    list_ways(v);
    if (ways_.empty()) return;
    if (ways_[0].first > expected) return push(v, ways_[0].first);
    const auto way =
        std::find_if(ways_.begin(), ways_.end(), [&](const auto& w) { return mesh_.collapse(v, w.second); });
    if (way == ways_.end()) return;  // until something around it changes
    const uint32_t into = way->second;
    quadric_[into].add(quadric_[v]);
    mesh_.list_neighbours(into, around_);
    for (const uint32_t w : around_) push(w);
    push(into);
  }

  WallMesh& mesh_;
  std::vector<Quadric> quadric_;  ///< per vertex, of the triangles that were around it and what it took in
  std::vector<double> least_;     ///< per vertex the cost with which it is in the queue
  std::priority_queue<Entry> queue_;
  std::vector<uint32_t> targets_, around_;
  std::vector<std::pair<double, uint32_t>> ways_;
};

}  // namespace

void coarsen(WallMesh& mesh, int64_t vertices, const Context& context) { Coarsening(mesh).run(vertices, context); }

}  // namespace isoshell
