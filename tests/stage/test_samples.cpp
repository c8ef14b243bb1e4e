// The triangle lists and samples of sites against brute force.
#include <cmath>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "oracle/overlap_oracle.h"
#include "support/catch.h"
#include "support/site_shapes.h"
#include "support/test_context.h"
#include "voxel/closest_point.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

struct Point {
  double x, y, z;
};
Point operator-(Point a, Point b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
double dot(Point a, Point b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Point cross(Point a, Point b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }
Point at(PointQ8 p) { return {double(p.x), double(p.y), double(p.z)}; }

double distance_to_segment(Point p, Point a, Point b) {
  const Point e = b - a;
  const double t = dot(e, e) > 0 ? std::fmin(1, std::fmax(0, dot(p - a, e) / dot(e, e))) : 0;
  const Point d = {p.x - a.x - t * e.x, p.y - a.y - t * e.y, p.z - a.z - t * e.z};
  return std::sqrt(dot(d, d));
}

/// The least of the distances to the sides and, if p projects into the triangle, to its plane.
double distance_to_triangle(Point p, Point a, Point b, Point c) {
  const double sides =
      std::fmin(distance_to_segment(p, a, b), std::fmin(distance_to_segment(p, b, c), distance_to_segment(p, c, a)));
  const Point n = cross(b - a, c - a);
  if (dot(n, n) == 0) return sides;
  const bool inside =
      dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 && dot(cross(a - c, p - c), n) >= 0;
  return inside ? std::fabs(dot(p - a, n)) / std::sqrt(dot(n, n)) : sides;
}

struct Faults {
  int64_t list = 0, sample = 0, distance = 0;
};

Faults faults_of(const LatticeSurface& s, const SiteSet& sites, const SiteSamples& samples) {
  Faults faults;
  const VoxelSetView set = sites.voxels.view();
  for (int64_t l = 0; l < sites.voxels.leaf_count(); ++l)
    for_each_active(set, l, [&](int offset, int64_t site) {
      const Voxel v = voxel_at(leaf_of_key(set.leaf_key[l]), offset);
      const PointQ8 centre = {v.x * 256 + 128, v.y * 256 + 128, v.z * 256 + 128};
      std::vector<uint32_t> expect;
      int64_t best_sq = INT64_MAX;
      uint32_t best = kNone;
      PointQ8 point = {};
      double nearest = 1e300;
      for (int64_t t = 0; t < s.triangles.size(); ++t) {
        const TriangleIndices i = s.triangles[t];
        const PointQ8 a = s.points[i.a], b = s.points[i.b], c = s.points[i.c];
        if (!oracle::meets_by_axes(triangle_q8(a, b, c), v, kVoxelShift)) continue;
        expect.push_back(uint32_t(t));
        const PointQ8 p = closest_point_on_triangle(centre, a, b, c);
        if (distance_sq_q16(p, centre) < best_sq) best_sq = distance_sq_q16(p, centre), best = uint32_t(t), point = p;
        nearest = std::fmin(nearest, distance_to_triangle(at(centre), at(a), at(b), at(c)));
      }
      const std::vector<uint32_t> list(samples.triangles.begin() + samples.first[site],
                                       samples.triangles.begin() + samples.first[site + 1]);
      faults.list += list != expect;
      const SiteSample& got = samples.sample[site];
      faults.sample +=
          got.triangle != best || PointQ8{centre.x + got.dx, centre.y + got.dy, centre.z + got.dz} != point;
      faults.distance += std::fabs(std::sqrt(double(best_sq)) - nearest) > 1;
    });
  return faults;
}

}  // namespace

TEST_CASE("samples: every site lists its triangles and holds the point nearest to its centre", "[samples][stage]") {
  TestContext context;
  for (const auto& [name, soup] : shapes::ugly_soups())
    for (int32_t resolution : {5, 21}) {
      INFO(name << " at " << resolution);
      const LatticeSurface s = shapes::snapped(soup, resolution, context);
      const SiteSet sites = voxelize(s, context);
      const Faults faults = faults_of(s, sites, sample_sites(s, sites, context));
      CHECK(faults.list == 0);
      CHECK(faults.sample == 0);
      CHECK(faults.distance == 0);
    }
  const LatticeSurface s = shapes::on_voxel_boundaries(context);
  const SiteSet sites = voxelize(s, context);
  CHECK(faults_of(s, sites, sample_sites(s, sites, context)).list == 0);
}

TEST_CASE("samples: the point may leave the voxel, but not by more than half a diagonal from the centre",
          "[samples][stage]") {
  TestContext context;
  const LatticeSurface s = shapes::snapped(shapes::torus(2, .7, 48, 24), 80, context);
  const SiteSet sites = voxelize(s, context);
  const SiteSamples samples = sample_sites(s, sites, context);
  int64_t far = 0, outside = 0, wrong_normal = 0;
  for (const SiteSample& p : samples.sample) {
    far += std::sqrt(double(p.dx * p.dx + p.dy * p.dy + p.dz * p.dz)) > 128 * std::sqrt(3.0) + 1;
    outside += std::abs(p.dx) > 128 || std::abs(p.dy) > 128 || std::abs(p.dz) > 128;
    const TriangleIndices t = s.triangles[p.triangle];
    const Point n = cross(at(s.points[t.b]) - at(s.points[t.a]), at(s.points[t.c]) - at(s.points[t.a]));
    const double along = dot(n, {double(p.normal.x), double(p.normal.y), double(p.normal.z)}) / std::sqrt(dot(n, n));
    wrong_normal += along < 126;
  }
  CHECK(far == 0);
  CHECK(outside > 0);
  CHECK(wrong_normal == 0);
}

TEST_CASE("samples: order of the file and threads change nothing", "[samples][stage][parity]") {
  for (const auto& [name, soup] : shapes::ugly_soups()) {
    INFO(name);
    const auto run = [](const TriangleSoup& input, int threads) {
      TestContext context;
      context.threads = threads;
      const LatticeSurface s = shapes::snapped(input, 90, context);
      return digest(sample_sites(s, voxelize(s, context), context));
    };
    const uint64_t expect = run(soup, 1);
    for (uint64_t seed = 0; seed < 2; ++seed) CHECK(run(shapes::shuffled(soup, seed), 2) == expect);
  }
}
