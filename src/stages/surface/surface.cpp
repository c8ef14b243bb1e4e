// From a soup in world units to the canonical surface on the lattice.
#include <algorithm>
#include <limits>
#include <vector>

#include "isoshell/error.h"
#include "stages/backend_table.h"

namespace isoshell {
namespace {

void require_triangles(const TriangleSoup& soup) {
  if (soup.triangles.empty())
    throw Error(ErrorCode::nothing_to_mesh, "surface", "the surface has 0 triangles; a mesh needs at least 1");
}

// Half-edges are numbered in 32 bits.
void require_countable(const TriangleSoup& soup) {
  constexpr size_t kMaxTriangles = 0xffffffffu / 3;
  if (soup.triangles.size() > kMaxTriangles || soup.vertices.size() > 0xffffffffu)
    throw Error(ErrorCode::usage, "surface",
                "the surface has " + std::to_string(soup.triangles.size()) + " triangles and " +
                    std::to_string(soup.vertices.size()) + " vertices; at most " + std::to_string(kMaxTriangles) +
                    " triangles can be numbered; split the file");
}

}  // namespace

WorldBox bounding_box(const TriangleSoup& soup) {
  require_triangles(soup);
  const double inf = std::numeric_limits<double>::infinity();
  WorldBox box{{inf, inf, inf}, {-inf, -inf, -inf}};
  std::vector<char> used(soup.vertices.size(), 0);  // each vertex once: triangles meet it six times
  for (const auto& t : soup.triangles)
    for (uint32_t v : t) used[v] = 1;
  for (size_t v = 0; v < used.size(); ++v) {
    if (!used[v]) continue;
    const WorldPoint& p = soup.vertices[v];
    box.min = {std::min(box.min.x, p.x), std::min(box.min.y, p.y), std::min(box.min.z, p.z)};
    box.max = {std::max(box.max.x, p.x), std::max(box.max.y, p.y), std::max(box.max.z, p.z)};
  }
  return box;
}

SoupTopology measure_topology(const TriangleSoup& soup, Context& context) {
  require_countable(soup);
  SoupTopology measured{{}, soup.dirt};
  measured.topology = backend_for(context).measure_topology(soup, measured.dirt, context);
  return measured;
}

LatticeSurface snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context) {
  require_triangles(soup);
  require_countable(soup);
  LatticeSurface surface = backend_for(context).snap_surface(soup, frame, context);
  surface.first_cap = soup.first_cap;
  return surface;
}

}  // namespace isoshell
