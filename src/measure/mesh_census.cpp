// The census of a mesh: its complex, the shapes of its triangles, its intersections.
#include "isoshell/mesh_census.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/triangle_list.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "measure/complex_counts.h"
#include "measure/self_intersections.h"
#include "measure/triangle_shape.h"

namespace isoshell {
namespace {

constexpr int64_t kChunk = 4096;
constexpr double kDegenerateHeight = 1e-7;  ///< of the longest edge

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "census", message); }

void check(const TriangleMesh& mesh) {
  if (mesh.triangles.empty()) refuse("the mesh has no triangle; give one that has");
  if (mesh.triangles.size() > UINT32_MAX / 3)
    refuse("the mesh has " + std::to_string(mesh.triangles.size()) + " triangles; at most " +
           std::to_string(UINT32_MAX / 3) + " can be numbered, split it");
  require_indices(mesh.triangles, mesh.vertices.size(), "census");
  for (const auto& t : mesh.triangles)
    for (const uint32_t v : t)
      if (!is_finite(mesh.vertices[v]))
        refuse("vertex " + std::to_string(v) + " is not finite; leave its triangles out");
}

template <size_t kBins>
void count_in(std::array<int64_t, kBins>& histogram, double part) {
  ++histogram[std::min(size_t(std::max(part, 0.0) * double(kBins)), kBins - 1)];
}

/// Sums over some triangles; the shares of `shapes` are counts until the end.
struct Part {
  TriangleShapes shapes;
  double area_sq = 0;

  Part() {
    shapes.q_min = 1;
    shapes.angle_min_deg = 180;
  }
  void add(const TriangleShape& t) {
    TriangleShapes& s = shapes;
    const double smallest = t.smallest_deg(), largest = t.largest_deg();
    s.q_min = std::min(s.q_min, t.q);
    s.q_mean += t.q;
    s.angle_min_deg = std::min(s.angle_min_deg, smallest);
    s.angle_max_deg = std::max(s.angle_max_deg, largest);
    s.smallest_angle_mean_deg += smallest;
    s.below_10_pct += smallest < 10;
    s.below_20_pct += smallest < 20;
    s.below_30_pct += smallest < 30;
    s.above_90_pct += largest > 90;
    s.above_120_pct += largest > 120;
    s.below_1 += smallest < 1;
    s.degenerate += !(t.longest > 0) || 2 * t.area / (t.longest * t.longest) < kDegenerateHeight;
    s.without_area += !(t.area > 0);
    s.area_world += t.area;
    area_sq += t.area * t.area;
    count_in(s.q_histogram, t.q);
    count_in(s.smallest_angle_histogram, smallest / 60);
    count_in(s.largest_angle_histogram, (largest - 60) / 120);
  }
  void add(const Part& other) {
    TriangleShapes& s = shapes;
    const TriangleShapes& o = other.shapes;
    s.q_min = std::min(s.q_min, o.q_min);
    s.angle_min_deg = std::min(s.angle_min_deg, o.angle_min_deg);
    s.angle_max_deg = std::max(s.angle_max_deg, o.angle_max_deg);
    for (double TriangleShapes::*sum :
         {&TriangleShapes::q_mean, &TriangleShapes::smallest_angle_mean_deg, &TriangleShapes::below_10_pct,
          &TriangleShapes::below_20_pct, &TriangleShapes::below_30_pct, &TriangleShapes::above_90_pct,
          &TriangleShapes::above_120_pct, &TriangleShapes::area_world})
      s.*sum += o.*sum;
    for (int64_t TriangleShapes::*count :
         {&TriangleShapes::below_1, &TriangleShapes::degenerate, &TriangleShapes::without_area})
      s.*count += o.*count;
    area_sq += other.area_sq;
    for (size_t i = 0; i < s.q_histogram.size(); ++i) s.q_histogram[i] += o.q_histogram[i];
    for (size_t i = 0; i < s.smallest_angle_histogram.size(); ++i) {
      s.smallest_angle_histogram[i] += o.smallest_angle_histogram[i];
      s.largest_angle_histogram[i] += o.largest_angle_histogram[i];
    }
  }
  TriangleShapes finished(double count) const {
    TriangleShapes s = shapes;
    s.q_mean /= count;
    s.smallest_angle_mean_deg /= count;
    for (double TriangleShapes::*share :
         {&TriangleShapes::below_10_pct, &TriangleShapes::below_20_pct, &TriangleShapes::below_30_pct,
          &TriangleShapes::above_90_pct, &TriangleShapes::above_120_pct})
      s.*share *= 100 / count;
    const double mean = s.area_world / count;
    if (mean > 0) s.area_variation = std::sqrt(std::max(0.0, area_sq / count - mean * mean)) / mean;
    return s;
  }
};

TriangleShape shape_of_repeated() {
  TriangleShape shape;
  shape.angle_deg = {0, 0, 180};
  return shape;
}

TriangleShapes measure_shapes(const TriangleMesh& mesh, int64_t dropped) {
  const int64_t count = int64_t(mesh.triangles.size());
  std::vector<Part> parts(size_t((count + kChunk - 1) / kChunk));
  for_each_index(size_t(0), parts.size(), [&](size_t c) {
    for (int64_t i = int64_t(c) * kChunk; i < std::min(count, int64_t(c + 1) * kChunk); ++i) {
      const auto& [p, q, r] = mesh.triangles[size_t(i)];
      const TriangleShape shape = shape_of(mesh.vertices[p], mesh.vertices[q], mesh.vertices[r]);
      const bool has_angles = p != q && q != r && r != p && shape.longest > 0;
      parts[c].add(has_angles ? shape : shape_of_repeated());
    }
  });
  Part all;
  for (const Part& part : parts) all.add(part);
  for (int64_t i = 0; i < dropped; ++i) all.add(shape_of_repeated());
  return all.finished(double(count + dropped));
}

}  // namespace

MeshCensus take_census(const TriangleMesh& mesh, Context& context, int64_t dropped) {
  check(mesh);
  return run_with_threads(context, [&] {
    const WorldBox box = box_of(mesh.vertices, mesh.triangles);
    const EdgeCensus edges = count_complex(mesh, .5 * (box.min + box.max), dropped);
    check_cancel(context, "census");
    const std::vector<uint32_t> first_at = first_at_position(mesh.vertices);
    const SelfIntersections crossing = find_self_intersections(mesh, first_at, context);
    MeshCensus census{edges.counts,
                      edges.valence,
                      edges.edges,
                      measure_shapes(mesh, dropped),
                      find_least_dihedral(mesh),
                      length(box.max - box.min),
                      crossing.pairs,
                      int64_t(crossing.triangles.size())};
    for (uint32_t v = 0; v < first_at.size(); ++v) census.counts.duplicate_vertices += first_at[v] != v;
    return census;
  });
}

int64_t count_intersecting_pairs(const TriangleMesh& mesh, Context& context) {
  check(mesh);
  return find_self_intersections(mesh, first_at_position(mesh.vertices), context).pairs;
}

TriangleMesh with_joined_vertices(const TriangleMesh& mesh) {
  WeldedVertices welded = weld_vertices(mesh.vertices, mesh.triangles);
  TriangleMesh joined{std::move(welded.position), mesh.triangles};
  for (auto& t : joined.triangles)
    for (uint32_t& v : t) v = welded.place[v];
  return joined;
}

}  // namespace isoshell
