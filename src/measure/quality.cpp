// Quality of a mesh. Chunks of fixed size are summed in parallel and joined in order: one shape, one result.
#include "isoshell/quality.h"

#include <algorithm>
#include <cmath>

#include "core/parallel_ranges.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "measure/triangle_shape.h"

namespace isoshell {
namespace {

constexpr int64_t kChunk = 4096;

struct Moments {
  double sum = 0, sum_sq = 0;

  void add(double value) {
    sum += value;
    sum_sq += value * value;
  }
  void add(const Moments& other) {
    sum += other.sum;
    sum_sq += other.sum_sq;
  }
  double variation(double count) const {
    const double mean = sum / count;
    return mean > 0 ? std::sqrt(std::max(0.0, sum_sq / count - mean * mean)) / mean : 0;
  }
};

struct Part {
  double q_min = 1, q_sum = 0, theta_min = 180, theta_sum = 0, theta_max = 0;
  int64_t theta_min_at = -1, below_30 = 0;
  Moments edge, area;

  void add(const Part& other) {
    q_min = std::min(q_min, other.q_min);
    q_sum += other.q_sum;
    if (other.theta_min < theta_min) theta_min = other.theta_min, theta_min_at = other.theta_min_at;
    theta_sum += other.theta_sum;
    theta_max = std::max(theta_max, other.theta_max);
    below_30 += other.below_30;
    edge.add(other.edge);
    area.add(other.area);
  }
};

void measure_triangle(int64_t number, WorldPoint a, WorldPoint b, WorldPoint c, Part& part) {
  const TriangleShape shape = shape_of(a, b, c);
  const double q = shape.q, smallest = shape.smallest_deg();
  part.theta_max = std::max(part.theta_max, shape.largest_deg());
  for (const double edge : shape.edge) part.edge.add(edge);
  part.q_min = std::min(part.q_min, q);
  part.q_sum += q;
  if (smallest < part.theta_min) part.theta_min = smallest, part.theta_min_at = number;
  part.theta_sum += smallest;
  part.below_30 += smallest < 30;
  part.area.add(shape.area);
}

/// The triangles with the smallest angles below 30 degrees, the worst first; of equal ones the first.
std::vector<PoorAngle> poor_angles(const TriangleMesh& mesh) {
  std::vector<PoorAngle> found;
  for (size_t i = 0; i < mesh.triangles.size(); ++i) {
    const auto& t = mesh.triangles[i];
    const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    Part part;
    measure_triangle(int64_t(i), a, b, c, part);
    if (part.below_30 > 0) found.push_back({part.theta_min, int64_t(i), 1. / 3 * (a + b + c)});
  }
  const size_t kept = std::min(found.size(), size_t(MeshQuality::kMostPoorAngles));
  std::partial_sort(found.begin(), found.begin() + int64_t(kept), found.end(),
                    [](const PoorAngle& p, const PoorAngle& q) {
                      return p.degrees != q.degrees ? p.degrees < q.degrees : p.triangle < q.triangle;
                    });
  found.resize(kept);
  return found;
}

double irregular_share(const TriangleMesh& mesh) {
  std::vector<uint32_t> triangles_at(mesh.vertices.size());
  for (const auto& t : mesh.triangles)
    for (uint32_t v : t) ++triangles_at[v];
  int64_t used = 0, irregular = 0;
  for (uint32_t count : triangles_at) {
    used += count > 0;
    irregular += count > 0 && count != 6;
  }
  return double(irregular) / double(used);
}

}  // namespace

MeshQuality measure_quality(const TriangleMesh& mesh) {
  const int64_t count = int64_t(mesh.triangles.size());
  if (count == 0) return {};
  require_indices(mesh.triangles, mesh.vertices.size(), "quality");
  std::vector<Part> parts(size_t((count + kChunk - 1) / kChunk));
  for_each_index(size_t(0), parts.size(), [&](size_t c) {
    const int64_t end = std::min(count, int64_t(c + 1) * kChunk);
    for (int64_t i = int64_t(c) * kChunk; i < end; ++i) {
      const auto& t = mesh.triangles[size_t(i)];
      measure_triangle(i, mesh.vertices[t[0]], mesh.vertices[t[1]], mesh.vertices[t[2]], parts[c]);
    }
  });
  Part all;
  for (const Part& part : parts) all.add(part);

  MeshQuality quality;
  const double n = double(count);
  quality.q_min = all.q_min;
  quality.q_avg = all.q_sum / n;
  quality.theta_min_deg = all.theta_min;
  quality.theta_min_at = all.theta_min_at;
  quality.theta_avg_deg = all.theta_sum / n;
  quality.theta_max_deg = all.theta_max;
  quality.below_30_deg_pct = 100 * double(all.below_30) / n;
  quality.below_30_deg = all.below_30;
  if (all.below_30 > 0) quality.poor_angles = poor_angles(mesh);
  quality.dihedral = find_least_dihedral(mesh);
  quality.irregular_ratio = irregular_share(mesh);
  quality.edge_cv = all.edge.variation(3 * n);
  quality.area_cv = all.area.variation(n);
  return quality;
}

}  // namespace isoshell
