#include "repair/holes/repair_junctions.h"

#include <algorithm>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

constexpr double kBeside = .001;  // of the edge's length

struct End {
  uint32_t vertex, other, edge;
  bool operator<(const End& o) const { return vertex != o.vertex ? vertex < o.vertex : other < o.other; }
};

/// Both ends of every boundary edge, in the order of their vertices.
std::vector<End> boundary_ends(const RepairMesh& mesh) {
  std::vector<End> ends;
  for (uint32_t h = 0; h < 3 * mesh.face_count(); ++h) {
    const uint32_t e = mesh.edge_of(h);
    if (!mesh.is_live(h / 3) || mesh.faces_at(e) != 1) continue;
    ends.push_back({mesh.from(h), mesh.to(h), e});
    ends.push_back({mesh.to(h), mesh.from(h), e});
  }
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// How far along from a to b a point beside that edge lies, 0 to 1; -1 for other points.
double place_beside(const WorldPoint& a, const WorldPoint& b, const WorldPoint& p) {
  const WorldPoint edge = b - a, to = p - a;
  const double whole_sq = length_sq(edge), along = dot(edge, to);
  const bool is_beside = length_sq(cross(edge, to)) <= kBeside * kBeside * whole_sq * whole_sq;
  return is_beside && along >= 0 && along <= whole_sq ? along / whole_sq : -1;
}

/// The edges of another boundary that runs beside a half-edge; none where no boundary does.
std::vector<uint32_t> boundary_beside(const RepairMesh& mesh, const std::vector<End>& ends, uint32_t half_edge) {
  const uint32_t a = mesh.from(half_edge), b = mesh.to(half_edge);
  std::vector<uint32_t> edges;
  double place = 0;
  for (uint32_t at = a; at != b;) {
    auto end = std::lower_bound(ends.begin(), ends.end(), End{at, 0, 0});
    double next = -1;
    for (; end != ends.end() && end->vertex == at; ++end) {
      if (end->edge == mesh.edge_of(half_edge)) continue;
      next = place_beside(mesh.position[a], mesh.position[b], mesh.position[end->other]);
      if (next > place) break;
    }
    if (!(next > place)) return {};
    edges.push_back(end->edge);
    place = next;
    at = end->other;
  }
  return edges;
}

}  // namespace

std::vector<uint32_t> edges_at_junctions(const RepairMesh& mesh) {
  const std::vector<End> ends = boundary_ends(mesh);
  std::vector<uint8_t> on_boundary(mesh.position.size(), 0);
  for (const End& end : ends) on_boundary[end.vertex] = 1;
  std::vector<uint32_t> found;
  for (uint32_t h = 0; h < 3 * mesh.face_count(); ++h) {
    const uint32_t a = mesh.from(h), b = mesh.to(h), e = mesh.edge_of(h);
    if (!mesh.is_live(h / 3) || mesh.faces_at(e) > 2 || !on_boundary[a] || !on_boundary[b]) continue;
    const std::vector<uint32_t> beside = boundary_beside(mesh, ends, h);
    found.insert(found.end(), beside.begin(), beside.end());
    if (!beside.empty()) found.push_back(e);
  }
  std::sort(found.begin(), found.end());
  found.erase(std::unique(found.begin(), found.end()), found.end());
  return found;
}

}  // namespace isoshell::repair
