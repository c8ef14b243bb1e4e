// The surface of a scalar field: closed whatever the values, exact where the field is linear.
#include <algorithm>
#include <cmath>

#include "implicit/volumes/iso_surface.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/made_field.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

float ball(Voxel v, double radius) { return float(std::sqrt(double(v.x * v.x + v.y * v.y + v.z * v.z)) - radius); }

int noise(Voxel v, uint64_t seed, int values) {
  const uint64_t at = uint64_t(v.x + 64) << 20 | uint64_t(v.y + 64) << 10 | uint64_t(v.z + 64);
  return int(random_bits(seed, at) % uint64_t(values));
}

std::string refusal(const ScalarField& field, ErrorCode code) {
  return message_of(code, [&] { extract_iso_surface(field, 0); });
}

}  // namespace

TEST_CASE("iso surface: any field of two values gives a closed 2-manifold, outside where the background is",
          "[volume][unit]") {
  for (uint64_t seed = 0; seed < 4; ++seed) {
    MadeField field(
        -8, 16, [&](Voxel v) { return noise(v, seed, 3) == 0 ? -1.f : 1.f; }, 1);
    const TriangleSoup soup = extract_iso_surface(field, 0);
    CHECK(is_closed_2_manifold_by_edges(soup));
    CHECK(volume(soup) > 0);
    for (const auto& t : soup.triangles) REQUIRE((t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
  }
}

TEST_CASE("iso surface: values that equal the asked one leave no two vertices in one place", "[volume][unit]") {
  MadeField field(
      -8, 16, [](Voxel v) { return float(noise(v, 7, 5) - 2); }, 2);
  const TriangleSoup soup = extract_iso_surface(field, 0);
  CHECK(is_closed_2_manifold_by_edges(soup));
  Context context;
  const auto [topology, dirt] = measure_topology(soup, context);
  CHECK(topology.closed);
  CHECK(topology.oriented);
  CHECK(dirt.degenerate_faces == 0);
}

TEST_CASE("iso surface: a ball lies where its field says, to the square of a voxel over its radius", "[volume][unit]") {
  constexpr double kRadius = 20.3;
  MadeField field(
      -24, 24, [&](Voxel v) { return ball(v, kRadius); }, 5);
  const TriangleSoup soup = extract_iso_surface(field, 0);
  CHECK(is_closed_2_manifold_by_edges(soup));
  for (const WorldPoint& p : soup.vertices)
    REQUIRE(std::abs(std::sqrt(p.x * p.x + p.y * p.y + p.z * p.z) - kRadius) < 1 / (2 * kRadius));
  CHECK(std::abs(volume(soup) / (4.0 / 3 * 3.14159265358979 * kRadius * kRadius * kRadius) - 1) < 0.005);
}

TEST_CASE("iso surface: a density and its negative give one surface, and a mirror turns no triangle inside out",
          "[volume][unit]") {
  MadeField density(
      -24, 24, [](Voxel v) { return -ball(v, 10); }, -5);
  MadeField distance(
      -24, 24, [](Voxel v) { return ball(v, 10); }, 5);
  const TriangleSoup a = extract_iso_surface(density, 0), b = extract_iso_surface(distance, 0);
  CHECK(a.triangles == b.triangles);
  CHECK(volume(a) > 0);
  distance.to_world.at[0][0] = -2;
  distance.to_world.at[1][2] = 0.5;
  const TriangleSoup mirrored = extract_iso_surface(distance, 0);
  CHECK(is_closed_2_manifold_by_edges(mirrored));
  CHECK(volume(mirrored) == Approx(2 * volume(b)));
}

TEST_CASE("iso surface: tiles without blocks around them are closed too", "[volume][unit]") {
  MadeField field(
      0, 8, [](Voxel) { return 1.f; }, 0);
  field.made_tiles = {{{8, 0, 0}, 8, 1.f}, {{128, 0, 0}, 128, 1.f}, {{-128, 0, 0}, 128, 0.25f}};
  const TriangleSoup soup = extract_iso_surface(field, 0.5);
  CHECK(is_closed_2_manifold_by_edges(soup));
  Context context;
  CHECK(measure_topology(soup, context).topology.components == 2);
}

TEST_CASE("iso surface: tiles of different sizes that touch make one solid", "[volume][unit]") {
  MadeField field(
      128, 136, [](Voxel) { return 1.f; }, 0);
  field.made_tiles = {{{0, 0, 0}, 128, 1.f}, {{128, 8, 0}, 8, 1.f}, {{128, 16, 0}, 8, 0.25f}, {{0, 128, 0}, 128, 1.f}};
  const TriangleSoup soup = extract_iso_surface(field, 0.5);
  CHECK(is_closed_2_manifold_by_edges(soup));
  Context context;
  CHECK(measure_topology(soup, context).topology.components == 2);  // the block is apart
  CHECK(volume(soup) == Approx(128 * 128 * 256 + 2 * 8 * 8 * 8).epsilon(1e-3));
}

TEST_CASE("iso surface: a solid too large for the memory limit is refused before it is made", "[volume][unit]") {
  MadeField field(
      0, 8, [](Voxel) { return 1.f; }, 0);
  field.made_tiles = {{{4096, 0, 0}, 4096, 1.f}, {{8192, 0, 0}, 4096, 1.f}};
  CHECK(error_of([&] { extract_iso_surface(field, 0.5, 16 << 20); }).code() == ErrorCode::out_of_memory);
}

TEST_CASE("iso surface: it is open beside values that are no numbers", "[volume][unit]") {
  const auto value = [](Voxel v) { return v == Voxel{0, 3, 4} ? NAN : -1.f; };
  MadeField broken(0, 8, value, 1);
  UnknownValues unknown;
  const TriangleSoup soup = extract_iso_surface(broken, 0, 0, VolumeCreases::none, &unknown);
  CHECK(unknown.values == 1);
  CHECK(unknown.cells == 4);  // and four within the body, which nothing crosses
  const WorldPoint& at = unknown.first_world;
  CHECK((at.x == -.5 && at.y == 2.5 && at.z == 3.5));
  CHECK(!is_closed_2_manifold_by_edges(soup));
  broken.background = -1;  // then all that is known is inside
  CHECK(contains(refusal(broken, ErrorCode::nothing_to_mesh), "all its values are -1"));
}

TEST_CASE("iso surface: what has no surface is refused by its values", "[volume][unit]") {
  MadeField flat(
      0, 8, [](Voxel) { return 2.f; }, 1);
  CHECK(contains(refusal(flat, ErrorCode::nothing_to_mesh), "its values are 1 to 2"));
  MadeField infinite(
      0, 8, [](Voxel) { return -INFINITY; }, INFINITY);
  const TriangleSoup soup = extract_iso_surface(infinite, 0);
  CHECK(is_closed_2_manifold_by_edges(soup));
  for (const WorldPoint& p : soup.vertices) REQUIRE(std::isfinite(p.x + p.y + p.z));
}
