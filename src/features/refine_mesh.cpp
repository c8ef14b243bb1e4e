// refine_mesh (see refine_mesh.h).
#include "features/refine_mesh.h"

#include <algorithm>
#include <string>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "core/world_vector.h"
#include "features/split_edges.h"
#include "isoshell/error.h"
#include "isoshell/voxel_set.h"

namespace isoshell {
namespace {

using Chain = std::vector<uint32_t>;  ///< vertices along an edge, with both ends

/// Fills some triangles. Vertices that are new inside of them are numbered from `first_new` on.
class Filling {
 public:
  explicit Filling(const FineMesh& mesh) : mesh_(mesh), first_new_(uint32_t(mesh.position.size())) {}

  /// Between three chains, each of which ends where the next one begins: where one has no inner points across the other
  /// two; else four parts, between the middles.
  void fill(const Chain& a, const Chain& b, const Chain& c) {
    if (a.size() == 2) return zip(b, c);
    if (b.size() == 2) return zip(c, a);
    if (c.size() == 2) return zip(a, b);
    const size_t i = middle_of(a), j = middle_of(b), k = middle_of(c);
    const Chain ab = straight(a[i], b[j]), bc = straight(b[j], c[k]), ca = straight(c[k], a[i]);
    fill(before(c, k, true), before(a, i, false), reversed(ca));
    fill(before(a, i, true), before(b, j, false), reversed(ab));
    fill(before(b, j, true), before(c, k, false), reversed(bc));
    fill(ab, bc, ca);
  }

  std::vector<WorldPoint> inside;
  std::vector<double> inside_length;
  MeshTriangles triangles;

 private:
  const WorldPoint& at(uint32_t v) const { return v < first_new_ ? mesh_.position[v] : inside[v - first_new_]; }
  double length_at(uint32_t v) const { return v < first_new_ ? mesh_.edge_length[v] : inside_length[v - first_new_]; }

  /// Two chains that meet in the last point of the first; an edge joins their other ends. From that edge on, each step
  /// takes the shorter diagonal; of two that are as long the one to the point that comes first.
  void zip(const Chain& there, const Chain& back) {
    size_t i = 0, j = back.size() - 1;  // at there[i] and back[j]
    const size_t last = there.size() - 1;
    while (i < last || j > 0) {
      const bool can_first = i < last && !(i + 1 == last && j > 1), can_second = j > 0 && !(j == 1 && i + 1 < last);
      bool first = can_first;
      if (can_first && can_second) {
        const WorldPoint &p = at(there[i + 1]), &q = at(back[j - 1]);
        const double to_p = distance_sq(p, at(back[j])), to_q = distance_sq(q, at(there[i]));
        first = to_p != to_q ? to_p < to_q : is_before(p, q);
      }
      if (first)
        triangles.push_back({there[i], there[i + 1], back[j]});
      else
        triangles.push_back({there[i], back[j - 1], back[j]});
      first ? ++i : --j;
      if (i == last && j == 1) return;  // what is left is the last edge of the second chain
      if (i + 1 == last && j == 0) return;
    }
  }

  /// The place of the middle point of a chain, the same from both ends.
  size_t middle_of(const Chain& chain) const {
    const size_t last = chain.size() - 1;
    return is_before(at(chain[0]), at(chain[last])) ? last / 2 : last - last / 2;
  }
  Chain before(const Chain& chain, size_t i, bool is_behind) const {
    return is_behind ? Chain(chain.begin() + int64_t(i), chain.end())
                     : Chain(chain.begin(), chain.begin() + int64_t(i) + 1);
  }
  static Chain reversed(Chain chain) {
    std::reverse(chain.begin(), chain.end());
    return chain;
  }
  /// A new chain inside.
  Chain straight(uint32_t u, uint32_t v) {
    const WorldPoint p = at(u), q = at(v);
    const double length_u = length_at(u), length_v = length_at(v);
    const int64_t parts = parts_of(p, q, longest_fine_edge((length_u + length_v) / 2));
    Chain chain{u};
    for (int64_t i = 1; i < parts; ++i) {
      chain.push_back(first_new_ + uint32_t(inside.size()));
      inside.push_back(point_between(p, q, i, parts));
      inside_length.push_back(value_between(length_u, length_v, i, parts));
    }
    chain.push_back(v);
    return chain;
  }

  const FineMesh& mesh_;
  uint32_t first_new_;
};

constexpr size_t kTogether = 256;  ///< triangles that are filled by one task

/// Appends what the tasks made, in their order.
void gather(const std::vector<Filling>& fillings, FineMesh& mesh) {
  const auto outside = uint32_t(mesh.position.size());
  std::vector<size_t> first_vertex{outside}, first_triangle{0};
  for (const Filling& f : fillings) {
    first_vertex.push_back(first_vertex.back() + f.inside.size());
    first_triangle.push_back(first_triangle.back() + f.triangles.size());
  }
  if (first_triangle.back() > kNone / 3)
    throw Error(ErrorCode::usage, "features",
                "the surface takes " + std::to_string(first_triangle.back()) + " triangles; at most " +
                    std::to_string(kNone / 3) + " can be numbered: ask for longer edges");
  mesh.position.resize(first_vertex.back());
  mesh.edge_length.resize(first_vertex.back());
  mesh.triangles.resize(first_triangle.back());
  for_each_index(size_t(0), fillings.size(), [&](size_t i) {
    const Filling& f = fillings[i];
    const auto shift = uint32_t(first_vertex[i]) - outside;
    const auto moved = [&](uint32_t v) { return v < outside ? v : v + shift; };
    std::transform(f.triangles.begin(), f.triangles.end(), mesh.triangles.begin() + int64_t(first_triangle[i]),
                   [&](const auto& t) {
                     return std::array{moved(t[0]), moved(t[1]), moved(t[2])};
                   });
    std::copy(f.inside.begin(), f.inside.end(), mesh.position.begin() + int64_t(first_vertex[i]));
    std::copy(f.inside_length.begin(), f.inside_length.end(), mesh.edge_length.begin() + int64_t(first_vertex[i]));
  });
}

}  // namespace

FineMesh refine_mesh(FineMesh mesh, Context& context) {
  const SplitEdges edges(mesh, context.memory_limit_bytes);
  const size_t tasks = (mesh.triangles.size() + kTogether - 1) / kTogether;
  std::vector<Filling> fillings(tasks, Filling(mesh));
  for_each_index(size_t(0), tasks, [&](size_t task) {
    Chain chain[3];
    for (size_t t = task * kTogether; t < std::min(mesh.triangles.size(), (task + 1) * kTogether); ++t) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      const auto& c = mesh.triangles[t];
      for (size_t i = 0; i < 3; ++i) {
        chain[i].clear();
        edges.append_chain(c[i], c[(i + 1) % 3], chain[i]);
        chain[i].push_back(c[(i + 1) % 3]);
      }
      fillings[task].fill(chain[0], chain[1], chain[2]);
    }
  });
  check_cancel(context, "features");
  gather(fillings, mesh);
  return mesh;
}

}  // namespace isoshell
