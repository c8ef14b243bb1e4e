// Level sets: exact distances to the surface, and a sign for closed surfaces, soups and scans with holes.
#include <algorithm>
#include <cmath>
#include <random>

#include "geometry/triangle_search.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/remesh.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/solid_soup.h"
#include "support/test_context.h"
#include "voxel/leaf.h"

using namespace isoshell;

namespace {

constexpr double kBandVox = 3;

RemeshOptions on_grid(int32_t resolution) {
  RemeshOptions options;
  options.vertices = 500;
  options.resolution = resolution;
  options.features = {Features::Creases::off, 0};
  options.level_set_band_vox = 3;
  return options;
}

LevelSet level_set_of(const TriangleSoup& soup, int32_t resolution) {
  TestContext context;
  return to_host(level_set(prepare(soup, on_grid(resolution), context), kBandVox, context));
}

TriangleSoup joined(const TriangleSoup& a, const TriangleSoup& b) {
  TriangleSoup soup = a;
  const auto shift = uint32_t(a.vertices.size());
  soup.vertices.insert(soup.vertices.end(), b.vertices.begin(), b.vertices.end());
  for (const auto& t : b.triangles) soup.triangles.push_back({t[0] + shift, t[1] + shift, t[2] + shift});
  return soup;
}

WorldPoint centre_of(const LevelSet& set, Voxel v) {
  const LatticeFrame& f = set.frame;
  return {f.origin.x + (v.x + .5) * f.voxel_size, f.origin.y + (v.y + .5) * f.voxel_size,
          f.origin.z + (v.z + .5) * f.voxel_size};
}

double distance_to(const TriangleSoup& soup, WorldPoint p) {
  double least_sq = std::numeric_limits<double>::infinity();
  for (const auto& t : soup.triangles)
    least_sq = std::min(
        least_sq, nearest_of_triangle(p, soup.vertices[t[0]], soup.vertices[t[1]], soup.vertices[t[2]]).distance_sq);
  return std::sqrt(least_sq);
}

/// Calls visit(voxel centre, distance in world units) for every n-th voxel of the band.
template <class Visit>
void for_each_nth(const LevelSet& set, int64_t n, Visit visit) {
  for (int64_t i = 0; i < set.distance_vox.size(); i += n)
    visit(centre_of(set, voxel_of_index(set.voxels.view(), i)), set.distance_vox[i] * set.frame.voxel_size);
}

/// Neighbours in the band whose values differ by more than a voxel: there a sign is wrong.
int64_t jumps(const LevelSet& set) {
  int64_t count = 0;
  const VoxelSetView voxels = set.voxels.view();
  for (int64_t i = 0; i < set.distance_vox.size(); ++i) {
    const Voxel v = voxel_of_index(voxels, i);
    for (const Voxel next : {Voxel{v.x + 1, v.y, v.z}, Voxel{v.x, v.y + 1, v.z}, Voxel{v.x, v.y, v.z + 1}})
      if (const int64_t j = find_voxel(voxels, next);
          j >= 0 && std::abs(set.distance_vox[i] - set.distance_vox[j]) > 1 + 1e-4f)
        ++count;
  }
  return count;
}

}  // namespace

TEST_CASE("level set: every value is the distance to the nearest of all triangles, negative inside", "[level_set]") {
  const TriangleSoup ball = shapes::sphere({1, 2, 3}, 5, 24);
  const LevelSet set = level_set_of(ball, 40);
  REQUIRE(set.distance_vox.size() == set.voxels.voxel_count());
  int64_t inside = 0;
  for_each_nth(set, 7, [&](WorldPoint p, double distance) {
    REQUIRE(std::abs(distance) == Approx(distance_to(ball, p)).margin(1e-6));
    REQUIRE(std::abs(distance) < kBandVox * set.frame.voxel_size);
    const double from_middle = std::sqrt((p.x - 1) * (p.x - 1) + (p.y - 2) * (p.y - 2) + (p.z - 3) * (p.z - 3));
    if (std::abs(from_middle - 5) > .1) REQUIRE((distance < 0) == (from_middle < 5));
    inside += distance < 0 ? 1 : 0;
  });
  CHECK(inside > 1000);
  CHECK(jumps(set) == 0);
  // No voxel of the band is missing.
  const VoxelSetView voxels = set.voxels.view();
  for (int32_t x = 0; x < set.frame.extent_vox[0]; x += 2)
    for (int32_t y = 0; y < set.frame.extent_vox[1]; y += 3)
      for (int32_t z = 0; z < set.frame.extent_vox[2]; z += 3)
        if (find_voxel(voxels, {x, y, z}) < 0)
          REQUIRE(distance_to(ball, centre_of(set, {x, y, z})) > (kBandVox - 1e-6) * set.frame.voxel_size);
}

TEST_CASE("level set: faces of a box that lie on voxel centres are zero and let no side through", "[level_set]") {
  const TriangleSoup box = shapes::box({0, 0, 0}, {8, 8, 8});
  const LevelSet set = level_set_of(box, 33);  // faces lie in the middle of voxels
  int64_t zeros = 0;
  for_each_nth(set, 1, [&](WorldPoint p, double distance) {
    const double outside = std::max({-p.x, p.x - 8, -p.y, p.y - 8, -p.z, p.z - 8});
    REQUIRE(std::abs(distance) == Approx(distance_to(box, p)).margin(1e-6));
    if (std::abs(outside) > 1e-6) REQUIRE((distance < 0) == (outside < 0));
    zeros += distance == 0 ? 1 : 0;
  });
  CHECK(zeros > 1000);
  CHECK(jumps(set) == 0);
}

TEST_CASE("level set: a ball with missing and flipped faces keeps the sides of the whole one", "[level_set]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 48);
  TriangleSoup broken = ball;
  broken.triangles.clear();
  std::mt19937 random(7);
  for (auto t : ball.triangles) {
    const auto draw = random() % 100;
    if (draw < 5) continue;
    if (draw < 30) std::swap(t[1], t[2]);
    broken.triangles.push_back(t);
  }
  const LevelSet set = level_set_of(broken, 96);
  for_each_nth(set, 1, [&](WorldPoint p, double distance) {
    const double from_middle = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z);
    if (std::abs(from_middle - 5) > set.frame.voxel_size) REQUIRE((distance < 0) == (from_middle < 5));
  });
  CHECK(jumps(set) == 0);
}

TEST_CASE("level set: doubled walls and walls inside of a solid have no side of their own", "[level_set]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 32), twice = shapes::sphere({0, 0, 0}, 4.97, 32);
  CHECK(jumps(level_set_of(joined(ball, twice), 64)) == 0);
  const TriangleSoup united = joined(shapes::sphere({0, 0, 0}, 5, 32), shapes::sphere({4, 0, 0}, 5, 32));
  const LevelSet set = level_set_of(united, 64);
  for_each_nth(set, 1, [&](WorldPoint p, double distance) {
    const double to_first = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 5,
                 to_second = std::sqrt((p.x - 4) * (p.x - 4) + p.y * p.y + p.z * p.z) - 5;
    if (std::abs(std::min(to_first, to_second)) > set.frame.voxel_size)
      REQUIRE((distance < 0) == (std::min(to_first, to_second) < 0));
  });
}

TEST_CASE("level set: a wide band of a ball with gaps that voxels bridge is that of the ball", "[level_set]") {
  const TriangleSoup ball = shapes::sphere({0, 0, 0}, 5, 64);
  TriangleSoup slit = ball;
  slit.triangles.clear();
  for (const auto& t : ball.triangles)  // a slit around the middle
    if (std::abs(ball.vertices[t[0]].z) > .2 || std::abs(ball.vertices[t[1]].z) > .2) slit.triangles.push_back(t);
  RemeshOptions options = on_grid(64);
  options.closing_vox = 4;
  TestContext context;
  const LevelSet set = to_host(level_set(prepare(slit, options, context), 8, context));
  for_each_nth(set, 1, [&](WorldPoint p, double distance) {
    const double from_middle = std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - 5;
    if (std::abs(from_middle) > 2 * set.frame.voxel_size) REQUIRE((distance < 0) == (from_middle < 0));
    REQUIRE(std::abs(distance) == Approx(std::abs(from_middle)).margin(2 * set.frame.voxel_size));
  });
  CHECK(jumps(set) == 0);
}

TEST_CASE("level set: a sheet without thickness has that of its crust", "[level_set]") {
  TriangleSoup sheet;
  for (uint32_t i = 0; i <= 20; ++i)
    for (uint32_t j = 0; j <= 20; ++j) sheet.vertices.push_back({i * .1, j * .1, .2 * std::sin(i * .3)});
  for (uint32_t i = 0; i < 20; ++i)
    for (uint32_t j = 0; j < 20; ++j) {
      const uint32_t a = i * 21 + j, b = a + 1, c = a + 21, d = c + 1;
      sheet.triangles.push_back({a, c, b});
      sheet.triangles.push_back({b, c, d});
    }
  const LevelSet set = level_set_of(sheet, 64);
  int64_t inside = 0;
  for_each_nth(set, 1, [&](WorldPoint p, double distance) {
    inside += distance < 0 ? 1 : 0;
    if (distance < 0) REQUIRE(distance_to(sheet, p) < 4 * set.frame.voxel_size);
  });
  CHECK(inside > 4000);
  CHECK(jumps(set) <= set.distance_vox.size() / 10000);
}

TEST_CASE("level set: a part that keeps handles narrower than edges has that of its own surface", "[level_set]") {
  const TriangleSoup part = shapes::sieve(4, 3, 1, 2);
  RemeshOptions options = on_grid(64);
  options.vertices = 300;  // so few that the sheet is grown
  options.features = {};
  TestContext context;
  const Prepared prepared = prepare(part, options, context);
  CHECK(prepared.report().grid.grown_vox > 0);
  const LevelSet set = to_host(level_set(prepared, kBandVox, context));
  for_each_nth(set, 20, [&](WorldPoint p, double distance) {
    REQUIRE(std::abs(distance) == Approx(distance_to(part, p)).margin(1e-6));
  });
  CHECK(jumps(set) == 0);
}

TEST_CASE("level set: it has the same bytes for any number of threads and on a device", "[level_set]") {
  const TriangleSoup soup = joined(shapes::sphere({1, 2, 3}, 5, 24), shapes::box({0, 0, 0}, {1, 9, 9}));
  const uint64_t here = digest(level_set_of(soup, 64));
  for (const int threads : {1, 2, 5}) {
    CpuContext context;
    context.threads = threads;
    CHECK(digest(level_set(prepare(soup, on_grid(64), context), kBandVox, context)) == here);
  }
}

TEST_CASE("level set: a band out of its range and a surface of regions are refused", "[level_set]") {
  TestContext context;
  const Prepared prepared = prepare(shapes::sphere({0, 0, 0}, 5, 24), on_grid(40), context);
  CHECK(says(error_of([&] { level_set(prepared, 0.5, context); }), "1 to 16"));
  CHECK(says(error_of([&] { level_set(prepared, std::nan(""), context); }), "1 to 16"));
  RemeshOptions options = on_grid(40);
  options.regions = "components";
  const TriangleSoup two = joined(shapes::box({0, 0, 0}, {1, 1, 1}), shapes::box({1, 0, 0}, {2, 1, 1}));
  CHECK(says(error_of([&] { level_set(prepare(two, options, context), 3, context); }), "regions"));
}
