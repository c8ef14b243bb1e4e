#include "features/weld_for_features.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <tuple>

#include "core/parallel_ranges.h"

namespace isoshell {
namespace {

/// Vertices of the soup that triangles use, by position, then by number.
std::vector<uint32_t> used_by_position(const TriangleSoup& soup) {
  std::vector<uint8_t> is_used(soup.vertices.size(), 0);
  for (const auto& t : soup.triangles)
    for (const uint32_t v : t) is_used[v] = 1;
  std::vector<uint32_t> used;
  for (uint32_t v = 0; v < is_used.size(); ++v)
    if (is_used[v]) used.push_back(v);
  const auto key = [&](uint32_t v) {
    const WorldPoint& p = soup.vertices[v];
    return std::tuple(p.x, p.y, p.z, v);
  };
  tbb::parallel_sort(used.begin(), used.end(), [&](uint32_t a, uint32_t b) { return key(a) < key(b); });
  return used;
}

/// Per vertex of the soup its vertex in the mesh.
std::vector<uint32_t> weld_vertices(const TriangleSoup& soup, FeatureMesh& mesh) {
  std::vector<uint32_t> welded(soup.vertices.size(), 0);
  for (const uint32_t v : used_by_position(soup)) {
    const WorldPoint& p = soup.vertices[v];
    const bool is_known = !mesh.vertices.empty() && mesh.vertices.back().x == p.x && mesh.vertices.back().y == p.y &&
                          mesh.vertices.back().z == p.z;
    if (!is_known) mesh.vertices.push_back({p.x + 0.0, p.y + 0.0, p.z + 0.0});  // -0 becomes 0
    welded[v] = uint32_t(mesh.vertices.size() - 1);
  }
  return welded;
}

struct WeldedTriangle {
  std::array<uint32_t, 3> corner;  ///< the smallest first
  uint32_t source_face;

  bool is_degenerate() const { return corner[0] == corner[1] || corner[1] == corner[2] || corner[2] == corner[0]; }
  std::array<uint32_t, 3> ascending() const {
    return {corner[0], std::min(corner[1], corner[2]), std::max(corner[1], corner[2])};
  }
};

}  // namespace

FeatureMesh weld_for_features(const TriangleSoup& soup) {
  FeatureMesh mesh;
  const std::vector<uint32_t> welded = weld_vertices(soup, mesh);
  std::vector<WeldedTriangle> all(soup.triangles.size());
  for_each_index(size_t(0), all.size(), [&](size_t t) {
    std::array<uint32_t, 3> c = soup.triangles[t];
    for (uint32_t& v : c) v = welded[v];
    std::rotate(c.begin(), std::min_element(c.begin(), c.end()), c.end());
    all[t] = {c, uint32_t(t)};
  });
  all.erase(std::remove_if(all.begin(), all.end(), [](const WeldedTriangle& t) { return t.is_degenerate(); }),
            all.end());

  tbb::parallel_sort(all.begin(), all.end(), [](const WeldedTriangle& a, const WeldedTriangle& b) {
    return std::tuple(a.ascending(), a.source_face) < std::tuple(b.ascending(), b.source_face);
  });
  const auto is_repeat = [](const WeldedTriangle& a, const WeldedTriangle& b) {
    return a.ascending() == b.ascending();
  };
  all.erase(std::unique(all.begin(), all.end(), is_repeat), all.end());
  for (const WeldedTriangle& t : all) {
    mesh.triangles.push_back(t.corner);
    mesh.source_face.push_back(t.source_face);
  }
  return mesh;
}

}  // namespace isoshell
