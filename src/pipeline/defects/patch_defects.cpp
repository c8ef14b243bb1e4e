// find_patch_defects (see patch_defects.h).
#include "pipeline/defects/patch_defects.h"

#include <algorithm>

#include "core/copy_product.h"
#include "features/mesh/mesh_fans.h"
#include "geometry/triangle_list.h"

namespace isoshell {
namespace {

/// An edge of a patch between vertices of the joined mesh.
struct JoinedEdge {
  uint64_t key;  ///< of the vertices of the joined mesh
  bool is_inside;
  std::array<uint32_t, 2> end;

  bool operator<(const JoinedEdge& o) const { return key < o.key; }
};

class Defects {
 public:
  explicit Defects(const SeededMesh& made)
      : mesh_(made.mesh),
        seeds_(made.seeds),
        triangles_(list_of(mesh_->triangles.view())),
        vertices_(size_t(mesh_->position.size())),
        is_wrong_(vertices_, 0),
        is_on_border_(vertices_, 0) {}

  std::vector<uint32_t> find() {
    look_at_edges();
    look_at_fans();
    look_at_joined_edges();
    look_at_joined_faces();
    std::vector<uint32_t> wrong;
    for (uint32_t v = 0; v < vertices_; ++v)
      if (is_wrong_[v]) wrong.push_back(v);
    return wrong;
  }

 private:
  void look_at_edges() {
    const EdgeSides sides = find_edge_sides(triangles_, vertices_);
    for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
      const bool is_inside = on_edge.size == 2 && start_of(on_edge[0]) != start_of(on_edge[1]);
      if (on_edge.size > 1 && !is_inside) is_wrong_[u] = is_wrong_[v] = 1;
      if (!is_inside) {
        not_inside_.push_back(edge_key(u, v));
        is_on_border_[u] = is_on_border_[v] = 1;
      }
      joined_.push_back({edge_key(joined(u), joined(v)), is_inside, {u, v}});
    });
  }

  void look_at_fans() {
    const MeshFans fans = find_fans(triangles_, int64_t(vertices_), not_inside_);
    std::vector<uint32_t> count(vertices_, 0);
    for (const uint32_t v : fans.vertex) ++count[v];
    for (size_t v = 0; v < vertices_; ++v)
      if (count[v] != 1 || bool(is_on_border_[v]) != (int64_t(v) < seeds_->fixed.count)) is_wrong_[v] = 1;
  }

  /// An edge inside of a patch must be the only one between its ends.
  void look_at_joined_edges() {
    std::sort(joined_.begin(), joined_.end());
    for (size_t begin = 0, end = 0; begin < joined_.size(); begin = end) {
      bool is_inside = false;
      for (; end < joined_.size() && joined_[end].key == joined_[begin].key; ++end)
        is_inside = is_inside || joined_[end].is_inside;
      for (size_t i = begin; is_inside && end > begin + 1 && i < end; ++i)
        for (const uint32_t v : joined_[i].end) is_wrong_[v] = 1;
    }
  }

  /// Two faces of the joined mesh with the same corners bound nothing.
  void look_at_joined_faces() {
    std::vector<std::pair<std::array<uint32_t, 3>, uint32_t>> faces;  ///< joined corners ascending, triangle
    for (uint32_t t = 0; t < triangles_.size(); ++t) {
      std::array<uint32_t, 3> c{joined(triangles_[t][0]), joined(triangles_[t][1]), joined(triangles_[t][2])};
      std::sort(c.begin(), c.end());
      if (int64_t(c[2]) < seeds_->fixed.count) faces.push_back({c, t});
    }
    std::sort(faces.begin(), faces.end());
    for (size_t i = 1; i < faces.size(); ++i)
      if (faces[i].first == faces[i - 1].first)
        for (const uint32_t t : {faces[i].second, faces[i - 1].second})
          for (const uint32_t v : triangles_[t]) is_wrong_[v] = 1;
  }

  uint32_t start_of(const EdgeSide& side) const { return triangles_[side.half_edge / 3][side.half_edge % 3]; }
  uint32_t joined(uint32_t v) const {
    const Buffer<uint32_t>& joined = seeds_->fixed.joined;
    return int64_t(v) < joined.size() ? joined[v] : v;
  }

  OnHost<DualMesh> mesh_;
  OnHost<SeedSet> seeds_;
  MeshTriangles triangles_;
  size_t vertices_;
  std::vector<char> is_wrong_, is_on_border_;
  std::vector<uint64_t> not_inside_;  ///< ascending
  std::vector<JoinedEdge> joined_;
};

}  // namespace

std::vector<uint32_t> find_patch_defects(const SeededMesh& made) { return Defects(made).find(); }

}  // namespace isoshell
