// See reference_faces.h.
#include "implicit/level_sets/reference_faces.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "core/parallel_ranges.h"
#include "geometry/half_edges.h"
#include "geometry/triangle_grid.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "voxel/union_find.h"

namespace isoshell {
namespace {

constexpr double kFarthestVox = 0.5;
constexpr double kLeastCosine = 0.6;  // between normals; triangles of voxels' size turn by that on what is rough
constexpr int kRings = 2;             // of triangles as long as a voxel, around some of each patch
enum : uint8_t { kExterior, kInner };

WorldPoint place_of(const WallCrossing& crossing, const LabelVolume& lattice) {
  const int64_t nx = lattice.size_vox[0], ny = lattice.size_vox[1], far = crossing.face / 3;
  double at[3] = {double(far % nx), double(far / nx % ny), double(far / nx / ny)};
  at[crossing.face % 3] -= 1 - double(crossing.at);
  return lattice.origin_world + at[0] * lattice.step_world[0] + at[1] * lattice.step_world[1] +
         at[2] * lattice.step_world[2];
}

/// That of the crossing where it is known, and that of the face where not.
WorldPoint normal_of(const WallCrossing& crossing, const LabelVolume& lattice, const WorldPoint& outward) {
  const auto& [x, y, z] = crossing.normal;
  const WorldPoint normal = normalised(double(x) * lattice.step_world[0] + double(y) * lattice.step_world[1] +
                                       double(z) * lattice.step_world[2]);
  if (length_sq(normal) == 0) return outward;
  return dot(normal, outward) < 0 ? -1. * normal : normal;
}

/// Per triangle whether it has this value, and only such around it: so many rings of neighbours.
std::vector<uint8_t> cores_of(const TriangleSoup& walls, uint8_t value, const std::vector<uint8_t>& of) {
  std::vector<uint8_t> is_core(of.size()), is_near(walls.vertices.size(), 0);
  for (size_t t = 0; t < of.size(); ++t)
    is_core[t] = walls.regions.labels[t][1] == walls.regions.background && of[t] == value;
  for (int ring = 0; ring < kRings; ++ring) {
    for (size_t t = 0; t < of.size(); ++t)
      if (!is_core[t] && walls.regions.labels[t][1] == walls.regions.background)
        for (const uint32_t v : walls.triangles[t]) is_near[v] = 1;
    for (size_t t = 0; t < of.size(); ++t)
      for (const uint32_t v : walls.triangles[t]) is_core[t] = is_core[t] && !is_near[v];
  }
  return is_core;
}

/// Gives patches that have this value and are nowhere wide the other one, where they border on it within their wall.
void flip_strips(const TriangleSoup& walls, const EdgeSides& edges, uint8_t value, std::vector<uint8_t>& of) {
  std::vector<uint32_t> part(of.size());
  std::vector<uint8_t> is_bordering(of.size(), 0), is_wide(of.size(), 0);
  const View<uint32_t> sets{part.data(), int64_t(part.size())};
  for (uint32_t t = 0; t < part.size(); ++t) part[t] = t;
  const auto each_pair = [&](auto visit) {
    for_each_edge(edges, [&](uint32_t, uint32_t, View<const EdgeSide> sides) {
      if (sides.size != 2) return;
      const uint32_t a = sides[0].half_edge / 3, b = sides[1].half_edge / 3;
      if (walls.regions.labels[a] == walls.regions.labels[b]) visit(a, b);
    });
  };
  each_pair([&](uint32_t a, uint32_t b) {
    if (of[a] == of[b]) join(sets, a, b);
  });
  const std::vector<uint8_t> is_core = cores_of(walls, value, of);
  for (uint32_t t = 0; t < part.size(); ++t) {
    PointAtRoot{sets}(t);
    is_wide[part[t]] = is_wide[part[t]] || is_core[t];
  }
  each_pair([&](uint32_t a, uint32_t b) {
    if (of[a] != of[b]) is_bordering[part[a]] = is_bordering[part[b]] = 1;
  });
  for (uint32_t t = 0; t < part.size(); ++t)
    if (of[t] == value && !is_wide[part[t]] && is_bordering[part[t]]) of[t] = 1 - value;
}

/// From the reference to the nearest face between a region and the background.
double nearest_vox(const TriangleGrid& grid, const std::vector<WallCrossing>& crossings, const LabelVolume& lattice,
                   const TriangleSoup& walls) {
  const double distance_sq = joined_over(
      crossings.size(), double(INFINITY),
      [&](size_t t) {
        return walls.regions.labels[t][1] == walls.regions.background
                   ? grid.distance_sq(place_of(crossings[t], lattice))
                   : double(INFINITY);
      },
      [](double a, double b) { return std::min(a, b); });
  return std::sqrt(distance_sq) / length(lattice.step_world[0]);
}

}  // namespace

double mark_faces_on_reference(const TriangleSoup& reference, const std::string& name,
                               const std::vector<WallCrossing>& crossings, const LabelVolume& lattice,
                               TriangleSoup& walls) {
  if (reference.triangles.empty())
    throw Error(ErrorCode::nothing_to_mesh, "read", name + ": the reference has no triangle; give a mesh or level set");
  const TriangleGrid grid(reference.vertices, reference.triangles);
  const double farthest_world = kFarthestVox * length(lattice.step_world[0]);
  std::vector<uint8_t> of(walls.triangles.size(), kInner);
  for_each_index(size_t(0), of.size(), [&](size_t t) {
    if (walls.regions.labels[t][1] != walls.regions.background) return;
    const auto& [a, b, c] = walls.triangles[t];
    const WorldPoint outward = normalised(doubled_area(walls.vertices[a], walls.vertices[b], walls.vertices[c]));
    const WorldPoint normal = normal_of(crossings[t], lattice, outward);
    const MeshPoint near = grid.nearest_facing(place_of(crossings[t], lattice), normal, farthest_world);
    if (near.triangle == MeshPoint::kNoTriangle) return;
    const auto& [i, j, k] = reference.triangles[near.triangle];
    const WorldPoint other =
        normalised(doubled_area(reference.vertices[i], reference.vertices[j], reference.vertices[k]));
    if (dot(normal, other) >= kLeastCosine) of[t] = kExterior;
  });
  const EdgeSides edges = find_edge_sides(walls.triangles, walls.vertices.size());
  flip_strips(walls, edges, kInner, of);
  flip_strips(walls, edges, kExterior, of);
  Attribute material;
  material.name = kMaterialName;
  material.type = NumberType::i32;
  material.domain = AttributeDomain::face;
  material.labels = {"exterior", "inner"};
  material.values.assign(of.begin(), of.end());
  walls.attributes.push_back(std::move(material));
  if (std::find(of.begin(), of.end(), kExterior) != of.end()) return 0;
  return nearest_vox(grid, crossings, lattice, walls);
}

}  // namespace isoshell
