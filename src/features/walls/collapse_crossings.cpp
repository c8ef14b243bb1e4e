// See collapse_crossings.h.
#include "features/walls/collapse_crossings.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/watched.h"

namespace isoshell {
namespace {

constexpr int64_t kStepsBetweenLooks = 1024;

class Crossings {
 public:
  Crossings(WallMesh& mesh, double longest_q8) : mesh_(mesh), longest_sq_q8_(longest_q8 * longest_q8) {}

  void collapse(const Context& context) {
    std::vector<uint8_t> meets(mesh_.triangles().size());
    for_each_index(uint32_t(0), uint32_t(meets.size()), [&](uint32_t t) { meets[t] = meets_any(t); });
    for (uint32_t t = 0; t < meets.size(); ++t)
      if (meets[t]) add(t);
    for (int64_t step = 0; !waiting_.empty(); ++step) {
      if (step % kStepsBetweenLooks == 0) check_cancel(context, "features");
      const Edge shortest = waiting_.top();
      waiting_.pop();
      collapse(shortest);
    }
  }

 private:
  struct Edge {
    double length_sq;
    uint32_t u, v, triangle;

    bool operator<(const Edge& o) const {
      return std::make_tuple(length_sq, u, v, triangle) > std::make_tuple(o.length_sq, o.u, o.v, o.triangle);
    }
  };

  bool meets_any(uint32_t triangle) const {
    bool meets = false;
    if (!mesh_.triangles()[triangle].is_gone()) mesh_.for_each_met(triangle, [&](uint32_t) { meets = true; });
    return meets;
  }
  void add(uint32_t triangle) {
    const auto& corner = mesh_.triangles()[triangle].corner;
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = std::min(corner[i], corner[(i + 1) % 3]), v = std::max(corner[i], corner[(i + 1) % 3]);
      const double length_sq = distance_sq(mesh_.at(u), mesh_.at(v));
      if (length_sq < longest_sq_q8_) waiting_.push({length_sq, u, v, triangle});
    }
  }
  void collapse(const Edge& edge) {
    const RegionTriangle& t = mesh_.triangles()[edge.triangle];
    if (t.is_gone() || !t.has(edge.u) || !t.has(edge.v) || !meets_any(edge.triangle)) return;
    uint32_t into = edge.v;
    if (!mesh_.collapse(edge.u, edge.v, change_, WallMesh::Shapes::any)) {
      into = edge.u;
      if (!mesh_.collapse(edge.v, edge.u, change_, WallMesh::Shapes::any)) return;
    }
    const std::vector<uint32_t> around = mesh_.around(into);
    for (const uint32_t s : around)
      if (meets_any(s)) add(s);
  }

  WallMesh& mesh_;
  double longest_sq_q8_;
  std::priority_queue<Edge> waiting_;
  MeshChange change_;
};

}  // namespace

void collapse_crossings(WallMesh& mesh, double longest_q8, const Context& context) {
  Crossings(mesh, longest_q8).collapse(context);
}

}  // namespace isoshell
