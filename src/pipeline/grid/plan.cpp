// See plan.h.
#include "pipeline/grid/plan.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

// Default grid: a cell is about so many voxels wide, more when cells are few and large. What a grid loses of tips is as
// wide as its voxels.
constexpr double kVoxelsPerSpacing = 4.5, kMostVoxelsPerSpacing = 5.5;
constexpr double kFewestVoxels = 2e5;                  // of the surface, unless cells are that wide
constexpr double kAreaPerEdgeSq = 0.8660254037844386;  // of one vertex of the equilateral triangulation, sqrt(3) / 2

constexpr int64_t kUsualVertices = 10000;
constexpr int32_t kMinResolution = 8;
constexpr int64_t kMinVertices = 4, kMaxVertices = 2147483647;
constexpr double kLongestOfFewest = 1.0690449676496976;  // 3.5 vertices round to 4: sqrt(4 / 3.5)

int32_t resolution_for_voxel(double longest, double voxel_size) {
  return int32_t(std::clamp<double>(std::floor(longest / voxel_size + 0.5) + 1, 1, double(kMaxResolution) + 1));
}

double voxels_per_spacing(int64_t vertices) {
  return std::clamp(std::sqrt(kFewestVoxels / double(vertices)), kVoxelsPerSpacing, kMostVoxelsPerSpacing);
}

int32_t requested_voxel_resolution(double longest, double voxel_size) {
  const int32_t resolution = resolution_for_voxel(longest, voxel_size);
  if (resolution >= kMinResolution && resolution <= kMaxResolution) return resolution;
  std::ostringstream text;
  text << "a voxel size of " << voxel_size << " gives " << (resolution < kMinResolution ? "fewer than " : "more than ")
       << (resolution < kMinResolution ? kMinResolution : kMaxResolution) << " voxels along the longest side of "
       << longest << "; use " << longest / (kMaxResolution - 1) << " to " << longest / (kMinResolution - 1);
  throw Error(ErrorCode::usage, "grid", text.str());
}

[[noreturn]] void refuse_edge_length(double edge_world, const std::string& asked, const char* bound, int64_t vertices,
                                     double area_world) {
  std::ostringstream text;
  text << "an edge length of " << edge_world << " asks for " << asked << " vertices; use at " << bound << " "
       << target_of(vertices, area_world).edge_length_world;
  throw Error(ErrorCode::usage, "grid", text.str());
}

/// Of an input's own area: that of a sheet is another one, and lengths of a field are no option to correct.
void check_longest_edge(const RemeshOptions& options, double area_world) {
  if (!options.edge_length_world) return;
  if (*options.edge_length_world > target_of(kMinVertices, area_world).edge_length_world * kLongestOfFewest)
    refuse_edge_length(*options.edge_length_world, "fewer than " + std::to_string(kMinVertices), "most", kMinVertices,
                       area_world);
}

}  // namespace

int64_t vertices_of_edge(double edge_world, double area_world) {
  const double vertices = area_world / (kAreaPerEdgeSq * edge_world * edge_world);
  if (!(vertices <= double(kMaxVertices)))  // a tiny length squares to 0
    refuse_edge_length(edge_world, "more than " + std::to_string(kMaxVertices), "least", kMaxVertices, area_world);
  return std::max(kMinVertices, int64_t(std::llround(vertices)));
}

Target target_of(int64_t vertices, double area_world) {
  return {vertices, std::sqrt(area_world / double(vertices) / kAreaPerEdgeSq)};
}

Target target_of(const RemeshOptions& options, double area_world) {
  if (!options.edge_length_world) return target_of(options.vertices.value_or(kUsualVertices), area_world);
  return {vertices_of_edge(*options.edge_length_world, area_world), *options.edge_length_world};
}

Plan plan_of(const RemeshOptions& checked_options, const InputTopology& input, const WorldBox& box) {
  check_longest_edge(checked_options, input.area_world);
  return {checked_options, input, box, target_of(checked_options, input.area_world)};
}

int32_t Plan::first_resolution() const {
  if (options.resolution) return *options.resolution;
  const double longest = longest_side(box);
  if (options.voxel_size_world) return requested_voxel_resolution(longest, *options.voxel_size_world);
  const double spacing = std::sqrt(input.area_world / double(target.vertices));
  return spacing > 0 ? resolution_for_cell(longest, spacing, target.vertices) : kMinDefaultResolution;
}

LatticeFrame Plan::frame(int32_t resolution) const {
  const std::optional<double>& size = options.voxel_size_world;
  return size && resolution == resolution_for_voxel(longest_side(box), *size)
             ? LatticeFrame::on_multiples(box.min, box.max, *size)
             : LatticeFrame::around(box.min, box.max, resolution);
}

RelaxOptions relax_options(const RemeshOptions& options) {
  RelaxOptions relax;
  relax.max_passes = options.max_passes.value_or(options.method == Method::shell ? 200 : 100);
  if (options.tolerance) relax.tolerance_ppb = int32_t(*options.tolerance * 1e9);
  if (options.max_step_vox) relax.max_step_q8 = int32_t(*options.max_step_vox * kOneVoxelQ8);
  return relax;
}

OptimizeOptions optimize_options(const RemeshOptions& options) {
  OptimizeOptions optimize;
  optimize.fit = options.fit;
  optimize.uniform_area = options.uniform_area;
  return optimize;
}

int32_t resolution_for_cell(double longest_world, double cell_world, int64_t vertices) {
  return std::clamp(resolution_for_voxel(longest_world, cell_world / voxels_per_spacing(vertices)),
                    kMinDefaultResolution, kMaxResolution);
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
