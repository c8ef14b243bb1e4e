// coarsen (see coarsen.h).
#include "features/walls/coarsen.h"

#include <algorithm>
#include <initializer_list>
#include <limits>
#include <queue>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/walls/wall_blocks.h"
#include "geometry/triangle_search.h"

namespace isoshell {
namespace {

constexpr double kErrorWeight = 2;  ///< of the squared distance from the walls, beside that of a squared edge
constexpr double kTipWeight = 10;   ///< of the squared distance of a point that went from what is left
constexpr double kMostNarrow = 30;  ///< sum of the squared edges of a triangle over twice its area
constexpr double kNever = std::numeric_limits<double>::infinity();
constexpr double kCheap = 0.75;                    ///< squares of edges of the result: what costs less goes anyhow
constexpr double kMostSquares[] = {2, 8, kNever};  ///< that a collapse may cost, one after the other
constexpr double kShortSquare = 0.25;              ///< of an edge of the result: shorter ones are collapsed further
constexpr int64_t kManyVertices = 2;               ///< for one that is to stay: cheap ones go in all blocks at once
constexpr int64_t kHardlyAny = 1000;               ///< one of so many collapsed is not worth another look at all
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

/// What is known of the vertices.
struct Known {
  std::vector<Quadric> quadric;  ///< of the triangles that were around each and what it took in
  std::vector<WorldPoint> tip;   ///< the point farthest from its triangles, of its place and those it took in
  std::vector<double> least;     ///< cost with which each is in a queue; kNever: in none
};

/// Of some vertices: those of a block, or all.
class Coarsening {
 public:
  Coarsening(WallMesh& mesh, Known& known, WallMesh::Shapes shapes, double short_square,
             const WallBlocks* blocks = nullptr, size_t block = 0)
      : mesh_(mesh), known_(known), shapes_(shapes), short_square_(short_square), blocks_(blocks), block_(block) {}

  void add(uint32_t v) {
    if (!is_here(v)) return;
    mesh_.list_targets(v, targets_);
    for (const uint32_t w : targets_) push(v, cost(v, w));
  }
  /// Until so many vertices are left, or each costs so much.
  void run(int64_t vertices, double most_cost, const Context& context) {
    for (int64_t step = 0; !queue_.empty() && queue_.top().cost < most_cost; ++step) {
      if (mesh_.vertex_count() <= vertices) return;
      if (step % kStepsBetweenLooks == 0) check_cancel(context, "features");
      const Entry top = queue_.top();
      queue_.pop();
      if (!mesh_.around(top.vertex).empty() && top.cost == known_.least[top.vertex]) take(top.vertex);
    }
  }

 private:
  struct Entry {
    double cost;
    uint32_t vertex;

    bool operator<(const Entry& o) const { return cost != o.cost ? cost > o.cost : vertex > o.vertex; }
  };

  bool is_here(uint32_t v) const {
    return !blocks_ || (!mesh_.vertex(v).is_settled && blocks_->holds_around(block_, v));
  }

  /// Of taking a vertex into another one: the longest edge that comes of it, squared, more where triangles are narrow,
  /// and where its place or its tip are far from them.
  double cost(uint32_t gone, uint32_t into) const {
    double longest_sq = 0, worst = 1;
    double off_sq = distance_sq(mesh_.at(gone), mesh_.at(into)), tip_sq = distance_sq(known_.tip[gone], mesh_.at(into));
    for (const uint32_t t : mesh_.around(gone)) {
      const auto& c = mesh_.triangles()[t].corner;
      const size_t i = c[0] == gone ? 0 : c[1] == gone ? 1 : 2;
      const uint32_t v = c[(i + 1) % 3], w = c[(i + 2) % 3];
      if (v == into || w == into) continue;
      const WorldPoint &p = mesh_.at(into), &q = mesh_.at(v), &r = mesh_.at(w);
      const double pq = distance_sq(p, q), pr = distance_sq(p, r), doubled = length(doubled_area(p, q, r));
      longest_sq = std::max({longest_sq, pq, pr});
      off_sq = std::min(off_sq, nearest_of_triangle(mesh_.at(gone), p, q, r).distance_sq);
      tip_sq = std::min(tip_sq, nearest_of_triangle(known_.tip[gone], p, q, r).distance_sq);
      const double narrow = pq + pr + distance_sq(q, r);
      worst = narrow < kMostNarrow * doubled ? std::max(worst, narrow / (kTwoRootThree * doubled)) : kMostNarrow;
    }
    const double aimed_at = mesh_.aimed_at(gone);
    return (longest_sq * (1 + worst) / 2 + kErrorWeight * known_.quadric[gone].at(mesh_.at(into)) +
            kTipWeight * std::max(off_sq, tip_sq)) /
           (aimed_at * aimed_at);
  }

  void list_ways(uint32_t v) {
    mesh_.list_targets(v, targets_);
    ways_.clear();
    for (const uint32_t w : targets_) ways_.push_back({cost(v, w), w});
    std::sort(ways_.begin(), ways_.end());
  }
  void push(uint32_t v, double cost) {
    if (cost >= known_.least[v]) return;
    known_.least[v] = cost;
    queue_.push({cost, v});
  }

  /// Collapses the edge of a vertex that costs the least, of those that can be; later where all have become dearer.
  void take(uint32_t v) {
    const double expected = known_.least[v];
    known_.least[v] = kNever;
    if (!is_here(v)) return;
    list_ways(v);
    if (ways_.empty()) return;
    if (ways_[0].first > expected) return push(v, ways_[0].first);
    const WorldPoint gone = mesh_.at(v);
    const auto way = std::find_if(ways_.begin(), ways_.end(), [&](const auto& w) {
      return mesh_.collapse(v, w.second, scratch_, shapes_, short_square_);
    });
    if (way == ways_.end()) return;  // until something around it changes
    const uint32_t into = way->second;
    known_.quadric[into].add(known_.quadric[v]);
    known_.tip[into] = farthest({known_.tip[into], known_.tip[v], gone}, into);
    mesh_.list_neighbours(into, around_);
    for (const uint32_t w : around_)
      if (!blocks_ || (is_here(w) && known_.least[w] == kNever)) add(w);  // in a block the others wait for their turn
    add(into);
  }

  /// Of some points the one that is farthest from the triangles around a vertex.
  WorldPoint farthest(std::initializer_list<WorldPoint> points, uint32_t v) const {
    WorldPoint out = mesh_.at(v);
    double farthest_sq = 0;
    for (const WorldPoint& p : points) {
      double off_sq = distance_sq(p, mesh_.at(v));
      for (const uint32_t t : mesh_.around(v)) {
        const auto& c = mesh_.triangles()[t].corner;
        off_sq = std::min(off_sq, nearest_of_triangle(p, mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2])).distance_sq);
      }
      if (off_sq > farthest_sq) farthest_sq = off_sq, out = p;
    }
    return out;
  }

  WallMesh& mesh_;
  Known& known_;
  const WallMesh::Shapes shapes_;
  const double short_square_;
  const WallBlocks* blocks_;  ///< null: everything is here
  size_t block_;
  std::priority_queue<Entry> queue_;
  std::vector<uint32_t> targets_, around_;
  std::vector<std::pair<double, uint32_t>> ways_;
  MeshChange scratch_;
};

Known known_of(const WallMesh& mesh) {
  const size_t count = mesh.vertices().size();
  Known known{std::vector<Quadric>(count), {}, std::vector<double>(count, kNever)};
  for (const RegionVertex& v : mesh.vertices()) known.tip.push_back(v.position);
  for (const RegionTriangle& t : mesh.triangles()) {
    if (t.is_gone()) continue;
    const WorldPoint &a = mesh.at(t.corner[0]), n = mesh.normal(t);
    if (const double size = length(n); size > 0)
      for (const uint32_t v : t.corner) known.quadric[v].add_plane((1 / size) * n, a, size / 6);
  }
  return known;
}

/// The square of the edge of equilateral triangles that so many vertices make, in terms of the lengths aimed at.
double square_of_edges(const WallMesh& mesh, int64_t vertices) {
  double doubled = 0;
  for (const RegionTriangle& t : mesh.triangles()) {
    if (t.is_gone()) continue;
    const double aimed_at = mesh.aimed_at(t.corner[0]);
    doubled += length(mesh.normal(t)) / (aimed_at * aimed_at);
  }
  return 2 * doubled / (kTwoRootThree * double(vertices));
}

/// Collapses what costs far less than the last collapses will, in all blocks at once.
void coarsen_in_blocks(WallMesh& mesh, int64_t vertices, double square, Known& known, const Context& context) {
  const double side_q8 = side_of_blocks_q8(mesh, vertices);
  for (const bool is_shifted : {false, true}) {
    const WallBlocks blocks(mesh, side_q8, is_shifted);
    for_each_index(size_t(0), blocks.size(), [&](size_t b) {
      Coarsening here(mesh, known, WallMesh::Shapes::good, kShortSquare * square, &blocks, b);
      for (const uint32_t v : blocks.vertices_of(b)) here.add(v);
      here.run(0, kCheap * square, context);
      for (const uint32_t v : blocks.vertices_of(b)) known.least[v] = kNever;
    });
  }
}

/// Collapses what costs less than `most_cost`, the cheapest first.
void coarsen_all(WallMesh& mesh, int64_t vertices, double most_cost, WallMesh::Shapes shapes, double short_square,
                 Known& known, const Context& context) {
  if (mesh.vertex_count() <= vertices) return;
  std::fill(known.least.begin(), known.least.end(), kNever);
  Coarsening all(mesh, known, shapes, short_square);
  for (uint32_t v = 0; v < mesh.vertices().size(); ++v) all.add(v);
  all.run(vertices, most_cost, context);
}

}  // namespace

void coarsen(WallMesh& mesh, int64_t vertices, const Context& context) {
  if (mesh.vertex_count() <= vertices) return;
  Known known = known_of(mesh);
  const double square = square_of_edges(mesh, vertices);
  if (mesh.vertex_count() > kManyVertices * vertices) coarsen_in_blocks(mesh, vertices, square, known, context);
  // Long edges are collapsed last, and not instead of short ones whose triangles would be bad; the count goes before
  // shapes.
  for (const double squares : kMostSquares)
    for (const auto shapes : {WallMesh::Shapes::good, WallMesh::Shapes::any})
      coarsen_all(mesh, vertices, squares * square, shapes, kShortSquare * square, known, context);
  // What could not be collapsed may be once others were, also far from it.
  for (int64_t before = INT64_MAX;
       mesh.vertex_count() > vertices && before - mesh.vertex_count() > before / kHardlyAny;) {
    before = mesh.vertex_count();
    coarsen_all(mesh, vertices, kNever, WallMesh::Shapes::any, kShortSquare * square, known, context);
  }
}

}  // namespace isoshell
