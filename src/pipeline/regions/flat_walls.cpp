// See flat_walls.h.
#include "pipeline/regions/flat_walls.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <utility>
#include <vector>

#include "geometry/world_vector.h"
#include "measure/self_intersections.h"

namespace isoshell {
namespace {

constexpr double kFlat = 1e-7;  // of a patch's own size: by how far its vertices may be off its plane
constexpr double kFarthestVox =
    32. / 256;                       // that a vertex is moved: part of an edge that no check has to look at again
constexpr double kLeastSine = 1e-3;  // between planes that give a line or a point

struct Plane {
  WorldPoint at{0, 0, 0}, normal{0, 0, 0};  ///< of no length: the patch is not flat
};

/// Per triangle of the walls its patch, which has all that was cut from it.
std::vector<uint32_t> patches_of_walls(const CutSurface& cut, const RegionWalls& walls) {
  std::vector<uint32_t> of_face(walls.regions.labels.size(), 0), patch;
  for (size_t t = 0; t < cut.fine->triangles.size(); ++t)
    of_face[cut.fine->source_face[t]] = cut.surface.patch[cut.corner[3 * t]];
  for (const uint32_t face : walls.mesh.source_face) patch.push_back(of_face[face]);
  return patch;
}

/// Through the mean of each patch, along the sum of its normals.
std::vector<Plane> planes_of_patches(const CutSurface& cut, const RegionWalls& walls) {
  const FeatureMesh& mesh = walls.mesh;
  const std::vector<uint32_t> patch = patches_of_walls(cut, walls);
  std::vector<Plane> planes(patch_count(cut));
  std::vector<double> area(planes.size(), 0), farthest(planes.size(), 0), reach(planes.size(), 0);
  for (size_t t = 0; t < patch.size(); ++t) {
    const auto& [a, b, c] = mesh.triangles[t];
    const WorldPoint &p = mesh.vertices[a], &q = mesh.vertices[b], &r = mesh.vertices[c];
    const double here = triangle_area(p, q, r);
    Plane& plane = planes[patch[t]];
    plane.normal = plane.normal + doubled_area(p, q, r);
    plane.at = plane.at + (here / 3) * (p + q + r);
    area[patch[t]] += here;
  }
  for (size_t p = 0; p < planes.size(); ++p) {
    planes[p].normal = normalised(planes[p].normal);
    if (area[p] > 0) planes[p].at = (1 / area[p]) * planes[p].at;
  }
  for (size_t t = 0; t < patch.size(); ++t)
    for (const uint32_t v : mesh.triangles[t]) {
      const uint32_t p = patch[t];
      const WorldPoint to = mesh.vertices[v] - planes[p].at;
      farthest[p] = std::max(farthest[p], std::abs(dot(to, planes[p].normal)));
      reach[p] = std::max(reach[p], length(to));
    }
  for (size_t p = 0; p < planes.size(); ++p)
    if (farthest[p] > kFlat * reach[p]) planes[p].normal = {0, 0, 0};
  return planes;
}

/// The nearest point that is on all of these planes, but for those that nearly go along others before them.
WorldPoint nearest_on(const std::vector<Plane>& planes, const WorldPoint& from) {
  WorldPoint at = from;
  std::vector<WorldPoint> fixed;  // directions of length 1, at right angles
  for (const Plane& plane : planes) {
    WorldPoint free = plane.normal;
    for (const WorldPoint& f : fixed) free = free - dot(free, f) * f;
    const double sine = length(free);
    if (sine < kLeastSine) continue;
    at = at - (dot(at - plane.at, plane.normal) / (sine * sine)) * free;
    fixed.push_back((1 / sine) * free);
  }
  return at;
}

/// Nowhere where that is far.
void move_to(const WorldPoint& there, const CutSurface& cut, WorldPoint& p) {
  if (distance_sq(there, p) <= std::pow(kFarthestVox * cut.frame.voxel_size, 2)) p = there;
}

/// Corners, to the vertices that they were as the walls came in.
void put_on_corners(const CutSurface& cut, const RegionWalls& walls, View<const uint32_t> home, TriangleMesh& mesh) {
  std::vector<uint32_t> fine_vertex(size_t(cut.surface.vertex_count()), 0);
  for (size_t c = 0; c < cut.corner.size(); ++c) fine_vertex[cut.corner[c]] = cut.fine->triangles[c / 3][c % 3];
  for (const uint32_t v : mesh.features.corners)
    if (const uint32_t of_walls = fine_vertex[home[v]]; of_walls < walls.mesh.vertices.size())
      move_to(walls.mesh.vertices[of_walls], cut, mesh.vertices[v]);
}

void move_to_planes(const CutSurface& cut, const RegionWalls& walls, TriangleMesh& mesh) {
  const std::vector<Plane> planes = planes_of_patches(cut, walls);
  std::vector<std::pair<uint32_t, uint32_t>> at_vertex;  // vertex, patch
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    const uint32_t patch = mesh.features.patch[t];
    if (length_sq(planes[patch].normal) == 0) continue;
    for (const uint32_t v : mesh.triangles[t]) at_vertex.push_back({v, patch});
  }
  std::sort(at_vertex.begin(), at_vertex.end());
  at_vertex.erase(std::unique(at_vertex.begin(), at_vertex.end()), at_vertex.end());
  for (size_t begin = 0, end = 0; begin < at_vertex.size(); begin = end) {
    const uint32_t v = at_vertex[begin].first;
    std::vector<Plane> meeting;
    for (; end < at_vertex.size() && at_vertex[end].first == v; ++end) meeting.push_back(planes[at_vertex[end].second]);
    move_to(nearest_on(meeting, mesh.vertices[v]), cut, mesh.vertices[v]);
  }
}

/// Whether a triangle turned by 60 degrees or more, as needles do.
bool has_turned(const std::array<uint32_t, 3>& t, const std::vector<WorldPoint>& from,
                const std::vector<WorldPoint>& to) {
  const WorldPoint was = doubled_area(from[t[0]], from[t[1]], from[t[2]]),
                   is = doubled_area(to[t[0]], to[t[1]], to[t[2]]);
  return !(2 * dot(was, is) > length(was) * length(is));
}

/// Triangles that turned, or meet others.
std::vector<uint32_t> spoiled_triangles(const TriangleMesh& mesh, const std::vector<WorldPoint>& before,
                                        Context& context) {
  std::vector<uint32_t> spoiled = find_self_intersections(mesh, first_at_position(mesh.vertices), context).triangles;
  for (uint32_t t = 0; t < mesh.triangles.size(); ++t)
    if (has_turned(mesh.triangles[t], before, mesh.vertices)) spoiled.push_back(t);
  return spoiled;
}

/// Moves vertices of triangles back; whether any were elsewhere.
bool move_back(const std::vector<uint32_t>& triangles, const std::vector<WorldPoint>& before, TriangleMesh& mesh) {
  bool has_moved = false;
  for (const uint32_t t : triangles)
    for (const uint32_t v : mesh.triangles[t]) {
      has_moved = has_moved || !(mesh.vertices[v] == before[v]);
      mesh.vertices[v] = before[v];
    }
  return has_moved;
}

}  // namespace

void put_on_planes(const CutSurface& cut, const RegionWalls& walls, View<const uint32_t> home, TriangleMesh& mesh,
                   Context& context) {
  const std::vector<WorldPoint> before = mesh.vertices;
  move_to_planes(cut, walls, mesh);
  put_on_corners(cut, walls, home, mesh);
  if (mesh.vertices == before) return;
  while (move_back(spoiled_triangles(mesh, before, context), before, mesh)) {
  }
}

}  // namespace isoshell
