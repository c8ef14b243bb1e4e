// Resolution and vertex count from what was asked for and the area of the surface.
#include "pipeline/grid/choose_grid.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "geometry/world_vector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

// Default grid: a cell is about so many voxels wide, more when cells are few and large. What a grid loses of tips is as
// wide as its voxels.
constexpr double kVoxelsPerSpacing = 4.5, kMostVoxelsPerSpacing = 5.5;
constexpr double kFewestVoxels = 2e5;  // of the surface, unless cells are that wide
constexpr int32_t kMinDefaultResolution = 64;
constexpr double kAreaPerEdgeSq = 0.8660254037844386;  // of one vertex of the equilateral triangulation, sqrt(3) / 2

constexpr int64_t kUsualVertices = 10000;
constexpr int32_t kMinResolution = 8;
constexpr int64_t kMaxVertices = 2147483647;

int32_t resolution_for_voxel(double longest, double voxel_size) {
  return int32_t(std::clamp<double>(std::floor(longest / voxel_size + 0.5) + 1, 1, double(kMaxResolution) + 1));
}

double voxels_per_spacing(int64_t vertices) {
  return std::clamp(std::sqrt(kFewestVoxels / double(vertices)), kVoxelsPerSpacing, kMostVoxelsPerSpacing);
}

int32_t asked_voxel_resolution(double longest, double voxel_size) {
  const int32_t resolution = resolution_for_voxel(longest, voxel_size);
  if (resolution >= kMinResolution && resolution <= kMaxResolution) return resolution;
  std::ostringstream text;
  text << "a voxel size of " << voxel_size << " gives " << (resolution < kMinResolution ? "fewer than " : "more than ")
       << (resolution < kMinResolution ? kMinResolution : kMaxResolution) << " voxels along the longest side of "
       << longest << "; use " << longest / (kMaxResolution - 1) << " to " << longest / (kMinResolution - 1);
  throw Error(ErrorCode::usage, "grid", text.str());
}

}  // namespace

int64_t vertex_target(const RemeshOptions& options, double area_world) {
  if (!options.edge_length_world) return options.vertices.value_or(kUsualVertices);
  const double edge_world = *options.edge_length_world, per_vertex = kAreaPerEdgeSq * edge_world * edge_world;
  const double vertices = area_world / per_vertex;
  if (!(vertices <= double(kMaxVertices))) {  // a tiny length squares to 0
    std::ostringstream text;
    text << "an edge length of " << edge_world << " asks for more than " << kMaxVertices << " vertices; use at least "
         << std::sqrt(area_world / double(kMaxVertices) / kAreaPerEdgeSq);
    throw Error(ErrorCode::usage, "grid", text.str());
  }
  return std::max<int64_t>(4, std::llround(vertices));
}

int32_t first_resolution(const RemeshOptions& options, double area_world, WorldPoint lo, WorldPoint hi) {
  if (options.resolution) return *options.resolution;
  const double longest = std::max({hi.x - lo.x, hi.y - lo.y, hi.z - lo.z});
  if (options.voxel_size_world) return asked_voxel_resolution(longest, *options.voxel_size_world);
  const int64_t vertices = vertex_target(options, area_world);
  const double spacing = std::sqrt(area_world / double(vertices));
  return spacing > 0 ? resolution_for_cell(longest, spacing, vertices) : kMinDefaultResolution;
}

int32_t resolution_for_cell(double longest_world, double cell_world, int64_t vertices) {
  return std::clamp(resolution_for_voxel(longest_world, cell_world / voxels_per_spacing(vertices)),
                    kMinDefaultResolution, kMaxResolution);
}

int64_t vertex_target(const RemeshOptions& options, const Prepared& prepared) {
  if (prepared.vertices) return *prepared.vertices;
  return vertex_target(options, options.edge_length_world ? sheet_area_world(prepared.sheet) : 0);
}

double usual_edge_length(const RemeshOptions& options, double area_world) {
  if (options.edge_length_world) return *options.edge_length_world;
  return std::sqrt(area_world / double(vertex_target(options, area_world)) / kAreaPerEdgeSq);
}

double usual_edge_length(const RemeshOptions& options, const Prepared& p) {
  if (!p.vertices) return usual_edge_length(options, p.surface.topology.area_world);
  return std::sqrt(p.surface.topology.area_world / double(*p.vertices) / kAreaPerEdgeSq);
}

double sheet_area_world(const Sheet& sheet) {
  const Buffer<PointQ8> position = sheet.position.to_host();
  double area = 0;
  for (TriangleIndices t : sheet.triangles.to_host()) {
    const WorldPoint a = sheet.frame.to_world(position[t.a]), b = sheet.frame.to_world(position[t.b]),
                     c = sheet.frame.to_world(position[t.c]);
    area += triangle_area(a, b, c);
  }
  return area;
}

}  // namespace isoshell
