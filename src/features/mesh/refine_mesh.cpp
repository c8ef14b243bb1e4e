// refine_mesh (see refine_mesh.h).
#include "features/mesh/refine_mesh.h"

#include <algorithm>
#include <string>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "features/mesh/edge_subdivision.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

/// Vertices along an edge, with both ends, that lie elsewhere.
class Chain {
 public:
  explicit Chain(const std::vector<uint32_t>& along) : Chain(along.data(), 1, along.size()) {}

  size_t size() const { return size_; }
  uint32_t operator[](size_t i) const { return first_[int64_t(i) * step_]; }
  Chain up_to(size_t i) const { return {first_, step_, i + 1}; }
  Chain from(size_t i) const { return {first_ + int64_t(i) * step_, step_, size_ - i}; }
  Chain reversed() const { return {first_ + int64_t(size_ - 1) * step_, -step_, size_}; }

 private:
  Chain(const uint32_t* first, int64_t step, size_t size) : first_(first), step_(step), size_(size) {}

  const uint32_t* first_;
  int64_t step_;
  size_t size_;
};

/// Fills some triangles. Vertices that are new inside of them are numbered from `first_new` on.
class Filling {
 public:
  explicit Filling(const FineMesh& mesh) : mesh_(mesh), first_new_(uint32_t(mesh.position.size())) {}

  /// Between three chains, each of which ends where the next one begins: where one has no inner points across the other
  /// two; else four parts, between the middles.
  void fill(Chain a, Chain b, Chain c) {
    if (a.size() == 2 && b.size() == 2 && c.size() == 2) return triangles.push_back({b[0], c[0], a[0]});
    if (a.size() == 2) return zip(b, c);
    if (b.size() == 2) return zip(c, a);
    if (c.size() == 2) return zip(a, b);
    const size_t i = middle_of(a), j = middle_of(b), k = middle_of(c);
    const std::vector<uint32_t> ab = straight(a[i], b[j]), bc = straight(b[j], c[k]), ca = straight(c[k], a[i]);
    fill(c.from(k), a.up_to(i), Chain(ca).reversed());
    fill(a.from(i), b.up_to(j), Chain(ab).reversed());
    fill(b.from(j), c.up_to(k), Chain(bc).reversed());
    fill(Chain(ab), Chain(bc), Chain(ca));
  }

  std::vector<WorldPoint> inside;
  std::vector<double> inside_length;
  MeshTriangles triangles;
  std::vector<uint32_t> source_face;

 private:
  const WorldPoint& at(uint32_t v) const { return v < first_new_ ? mesh_.position[v] : inside[v - first_new_]; }
  double length_at(uint32_t v) const { return v < first_new_ ? mesh_.edge_length[v] : inside_length[v - first_new_]; }

  /// Two chains that meet in the last point of the first; an edge joins their other ends. From that edge on, each step
  /// takes the shorter diagonal; of two that are as long the one to the point that comes first.
  void zip(Chain there, Chain back) {
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
  size_t middle_of(Chain chain) const {
    const size_t last = chain.size() - 1;
    return is_before(at(chain[0]), at(chain[last])) ? last / 2 : last - last / 2;
  }
  /// A new chain inside.
  std::vector<uint32_t> straight(uint32_t u, uint32_t v) {
    const WorldPoint p = at(u), q = at(v);
    const double length_u = length_at(u), length_v = length_at(v);
    const int64_t parts = parts_of(p, q, longest_fine_edge(mesh_, (length_u + length_v) / 2));
    std::vector<uint32_t> chain{u};
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

constexpr size_t kTasks = 1024;        ///< into which the triangles are shared: where they are few, some are large
constexpr size_t kMostTogether = 256;  ///< triangles that are filled by one task

/// Puts what the tasks made behind the vertices, in their order, and in the place of the triangles.
void gather(const std::vector<Filling>& fillings, FineMesh& mesh) {
  const auto outside = uint32_t(mesh.position.size());
  std::vector<size_t> first_vertex{outside}, first_triangle{0};
  for (const Filling& f : fillings) {
    first_vertex.push_back(first_vertex.back() + f.inside.size());
    first_triangle.push_back(first_triangle.back() + f.triangles.size());
  }
  if (first_triangle.back() > kNone / 3)
    throw NoRoom("features", "the surface takes " + std::to_string(first_triangle.back()) + " triangles; at most " +
                                 std::to_string(kNone / 3) + " can be numbered: ask for longer edges");
  mesh.position.resize(first_vertex.back());
  mesh.edge_length.resize(first_vertex.back());
  mesh.triangles.resize(first_triangle.back());
  if (!mesh.source_face.empty()) mesh.source_face.resize(first_triangle.back());
  for_each_index(size_t(0), fillings.size(), [&](size_t i) {
    const Filling& f = fillings[i];
    const auto shift = uint32_t(first_vertex[i]) - outside;
    const auto moved = [&](uint32_t v) { return v < outside ? v : v + shift; };
    std::transform(f.triangles.begin(), f.triangles.end(), mesh.triangles.begin() + int64_t(first_triangle[i]),
                   [&](const auto& t) {
                     return std::array{moved(t[0]), moved(t[1]), moved(t[2])};
                   });
    std::copy(f.source_face.begin(), f.source_face.end(), mesh.source_face.begin() + int64_t(first_triangle[i]));
    std::copy(f.inside.begin(), f.inside.end(), mesh.position.begin() + int64_t(first_vertex[i]));
    std::copy(f.inside_length.begin(), f.inside_length.end(), mesh.edge_length.begin() + int64_t(first_vertex[i]));
  });
}

}  // namespace

FineMesh refine_mesh(FineMesh mesh, Context& context, const std::vector<uint64_t>* only) {
  const EdgeSubdivision edges(mesh, context.memory_limit_bytes, only);
  const size_t together = std::clamp<size_t>(mesh.triangles.size() / kTasks, 1, kMostTogether);
  const size_t tasks = (mesh.triangles.size() + together - 1) / together;
  std::vector<Filling> fillings(tasks, Filling(mesh));
  for_each_index(size_t(0), tasks, [&](size_t task) {
    std::vector<uint32_t> chain[3];
    for (size_t t = task * together; t < std::min(mesh.triangles.size(), (task + 1) * together); ++t) {
      if (context.cancel.load(std::memory_order_relaxed)) return;
      const auto& c = mesh.triangles[t];
      for (size_t i = 0; i < 3; ++i) {
        chain[i].clear();
        edges.append_chain(c[i], c[(i + 1) % 3], chain[i]);
        chain[i].push_back(c[(i + 1) % 3]);
      }
      fillings[task].fill(Chain(chain[0]), Chain(chain[1]), Chain(chain[2]));
      if (!mesh.source_face.empty())
        fillings[task].source_face.resize(fillings[task].triangles.size(), mesh.source_face[t]);
    }
  });
  check_cancel(context, "features");
  gather(fillings, mesh);
  return mesh;
}

}  // namespace isoshell
