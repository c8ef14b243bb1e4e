// See collapse_crossings.h.
#include "features/walls/collapse_crossings.h"

#include <algorithm>
#include <queue>
#include <tuple>
#include <unordered_set>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/half_edges.h"

namespace isoshell {
namespace {

constexpr int64_t kStepsBetweenLooks = 64;

class Crossings {
 public:
  explicit Crossings(WallMesh& mesh) : mesh_(mesh) {}

  void collapse(const Context& context) {
    std::vector<uint8_t> meets(mesh_.triangles().size());
    for_each_index(uint32_t(0), uint32_t(meets.size()), [&](uint32_t t) { meets[t] = meets_any(t); });
    for (uint32_t t = 0; t < meets.size(); ++t)
      if (meets[t]) add_edges_of(t);
    for (int64_t step = 0; !waiting_.empty(); ++step) {
      if (step % kStepsBetweenLooks == 0) check_cancel(context, "features");
      const auto [length_sq, u, v] = waiting_.top();
      waiting_.pop();
      is_waiting_.erase(edge_key(u, v));
      if (has_meeting_triangle(u, v) && (collapse(u, v) || collapse(v, u)))
        for (const uint32_t t : change_.number)
          if (meets_any(t)) add_edges_of(t);
    }
  }

 private:
  using Edge = std::tuple<double, uint32_t, uint32_t>;  ///< squared length, and the ends, the smaller one first

  bool meets_any(uint32_t triangle) const {
    return !mesh_.triangles()[triangle].is_gone() && mesh_.meets_any(triangle);
  }
  bool has_meeting_triangle(uint32_t u, uint32_t v) const {
    const std::vector<uint32_t>& around = mesh_.around(u);
    return std::any_of(around.begin(), around.end(),
                       [&](uint32_t t) { return mesh_.triangles()[t].has(v) && meets_any(t); });
  }
  void add_edges_of(uint32_t triangle) {
    const auto& corner = mesh_.triangles()[triangle].corner;
    for (size_t i = 0; i < 3; ++i) {
      const auto [u, v] = std::minmax(corner[i], corner[(i + 1) % 3]);
      if (is_waiting_.insert(edge_key(u, v)).second) waiting_.push({distance_sq(mesh_.at(u), mesh_.at(v)), u, v});
    }
  }
  bool collapse(uint32_t gone, uint32_t into) { return mesh_.collapse(gone, into, change_, WallMesh::Shapes::any); }

  WallMesh& mesh_;
  std::priority_queue<Edge, std::vector<Edge>, std::greater<>> waiting_;
  std::unordered_set<uint64_t> is_waiting_;  ///< by edge_key
  MeshChange change_;
};

}  // namespace

void collapse_crossings(WallMesh& mesh, const Context& context) {
  run_with_threads(context, [&] { Crossings(mesh).collapse(context); });
}

}  // namespace isoshell
