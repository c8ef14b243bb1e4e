// find_mesh_faults (see mesh_faults.h).
#include "features/walls/mesh_faults.h"

#include <algorithm>
#include <array>
#include <cstdint>

#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

class MeshFaults {
 public:
  explicit MeshFaults(const WallMesh& mesh) : mesh_(mesh), is_faulty_(mesh.vertices().size(), 0) {}

  std::vector<uint32_t> find() {
    look_at_edges();
    look_at_triangles();
    for (uint32_t v = 0; v < is_faulty_.size(); ++v)
      if (!is_faulty_[v] && !mesh_.around(v).empty() && !has_fans_of_surface(v)) is_faulty_[v] = 1;
    std::vector<uint32_t> found;
    for (uint32_t v = 0; v < is_faulty_.size(); ++v)
      if (is_faulty_[v]) found.push_back(v);
    return found;
  }

 private:
  struct Side {
    uint64_t key;
    uint32_t triangle, edge;
    bool operator<(const Side& o) const { return key != o.key ? key < o.key : triangle < o.triangle; }
  };

  bool are_twins(const Side& s, const Side& t) const {
    const RegionTriangle &a = mesh_.triangles()[s.triangle], &b = mesh_.triangles()[t.triangle];
    return a.patch == b.patch && a.corner[s.edge] != b.corner[t.edge];
  }

  void look_at_edges() {
    std::vector<Side> sides;
    for (uint32_t t = 0; t < mesh_.triangles().size(); ++t) {
      const RegionTriangle& triangle = mesh_.triangles()[t];
      for (uint32_t i = 0; i < 3 && !triangle.is_gone(); ++i)
        sides.push_back({edge_key(triangle.corner[i], triangle.corner[(i + 1) % 3]), t, i});
    }
    std::sort(sides.begin(), sides.end());
    for (size_t begin = 0, end = 0; begin < sides.size(); begin = end) {
      const uint32_t curve = curve_of(sides[begin]);
      bool is_one = true;
      for (; end < sides.size() && sides[end].key == sides[begin].key; ++end)
        is_one = is_one && curve_of(sides[end]) == curve;
      if (curve == kNone) is_one = is_one && end == begin + 2 && are_twins(sides[begin], sides[begin + 1]);
      if (!is_one) is_faulty_[sides[begin].key >> 32] = is_faulty_[uint32_t(sides[begin].key)] = 1;
    }
  }
  uint32_t curve_of(const Side& s) const { return mesh_.triangles()[s.triangle].curve[s.edge]; }

  void look_at_triangles() {
    std::vector<std::array<uint32_t, 3>> corners;
    for (const RegionTriangle& t : mesh_.triangles()) {
      if (t.is_gone()) continue;
      corners.push_back(t.corner);
      std::sort(corners.back().begin(), corners.back().end());
    }
    std::sort(corners.begin(), corners.end());
    for (size_t i = 1; i < corners.size(); ++i)
      if (corners[i] == corners[i - 1])
        for (const uint32_t v : corners[i]) is_faulty_[v] = 1;
  }

  /// Of triangles whose edges are no faults: how often their fan begins at a curve, or that there is one closed fan.
  bool has_fans_of_surface(uint32_t v) const {
    const RegionVertex& vertex = mesh_.vertex(v);
    const std::vector<uint32_t>& around = mesh_.around(v);
    size_t begins = 0, reached = 0;
    for (const uint32_t t : around) {
      if (mesh_.triangles()[t].curve[corner_of(t, v)] == kNone) continue;
      ++begins;
      for (uint32_t s = t; s != kNone; s = next_around(s, v)) ++reached;
    }
    if (vertex.kind != RegionVertex::Kind::free) {
      const CutSurface& cut = mesh_.lookup().cut();
      const uint32_t place = cut.place[vertex.home];
      return reached == around.size() && int64_t(begins) == cut.copies_first[place + 1] - cut.copies_first[place];
    }
    uint32_t s = around[0];
    do {
      ++reached;
      s = next_around(s, v);
    } while (s != kNone && s != around[0] && reached <= around.size());
    return begins == 0 && reached == around.size();
  }
  size_t corner_of(uint32_t t, uint32_t v) const {
    const auto& corner = mesh_.triangles()[t].corner;
    return corner[0] == v ? 0 : corner[1] == v ? 1 : 2;
  }
  /// The triangle across the edge that ends at the vertex; kNone across a curve.
  uint32_t next_around(uint32_t t, uint32_t v) const {
    const RegionTriangle& triangle = mesh_.triangles()[t];
    const size_t into = (corner_of(t, v) + 2) % 3;
    if (triangle.curve[into] != kNone) return kNone;
    const uint32_t from = triangle.corner[into];
    return mesh_.find_around(v, [&](const RegionTriangle& s) { return s.edge_between(v, from) < 3; });
  }

  const WallMesh& mesh_;
  std::vector<char> is_faulty_;
};

}  // namespace

std::vector<uint32_t> find_mesh_faults(const WallMesh& mesh) { return MeshFaults(mesh).find(); }

}  // namespace isoshell
