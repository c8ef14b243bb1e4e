// Where the surface of an array's values ends that reaches the sides of the array.
#include <cmath>

#include "geometry/world_vector.h"
#include "implicit/volumes/iso_surface.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/io/memory_input.h"
#include "support/catch.h"
#include "support/made_field.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

/// Values of a function of a place in an array.
struct Array {
  template <class Value>
  Array(int64_t nx, int64_t ny, int64_t nz, Value value) {
    for (int64_t x = 0; x < nx; ++x)
      for (int64_t y = 0; y < ny; ++y)
        for (int64_t z = 0; z < nz; ++z) values.push_back(float(value(x, y, z)));
    volume = {values.data(), {nx, ny, nz}, {ny * nz, nz, 1}};
  }

  TriangleSoup surface(VolumeSides sides, VolumeCreases creases = VolumeCreases::none) const {
    VolumeInfo info;
    return surface_of_volume(volume, "mine", {"", {}, 0, creases, sides}, info);
  }

  std::vector<float> values;
  DenseVolume volume;
};

double area_of(const TriangleSoup& soup) {
  double area = 0;
  for (const auto& [a, b, c] : soup.triangles)
    area += length(doubled_area(soup.vertices[a], soup.vertices[b], soup.vertices[c])) / 2;
  return area;
}

}  // namespace

TEST_CASE("sides: a body that reaches them is closed by flat faces at the outermost values, or half a voxel out",
          "[volume][unit]") {
  const Array below(11, 21, 10, [](int64_t, int64_t, int64_t z) { return double(z) - 4.25; });
  const TriangleSoup sample = below.surface(VolumeSides::sample);
  CHECK(is_closed_2_manifold_by_edges(sample));
  CHECK(volume(sample) == Approx(10 * 20 * 4.25));
  CHECK(area_of(sample) == Approx(2 * (10 * 20 + 4.25 * (10 + 20))));
  const TriangleSoup cell = below.surface(VolumeSides::cell);
  CHECK(is_closed_2_manifold_by_edges(cell));
  CHECK(volume(cell) == Approx(11 * 21 * 4.75));
  CHECK(area_of(cell) == Approx(2 * (11 * 21 + 4.75 * (11 + 21))));
  const TriangleSoup open = below.surface(VolumeSides::open);
  CHECK(area_of(open) == Approx(10 * 20));
  CHECK(open.vertices.size() == 11 * 21);
}

TEST_CASE("sides: a ball that they cut is the part of it within them", "[volume][unit]") {
  const auto distance = [](int64_t x, int64_t y, int64_t z) { return std::hypot(double(x), y - 9., z - 9.) - 6.3; };
  const auto whole = [](int64_t x, int64_t y, int64_t z) { return std::hypot(x - 9., y - 9., z - 9.) - 6.3; };
  for (const VolumeCreases creases : {VolumeCreases::none, VolumeCreases::of_sharp_bodies, VolumeCreases::all}) {
    const TriangleSoup half = Array(10, 19, 19, distance).surface(VolumeSides::sample, creases);
    CHECK(is_closed_2_manifold_by_edges(half));
    const TriangleSoup ball = Array(19, 19, 19, whole).surface(VolumeSides::sample, creases);
    CHECK(volume(half) == Approx(volume(ball) / 2).epsilon(5e-3));
  }
}

TEST_CASE("sides: creases of a body go on to them", "[volume][unit]") {
  // A wedge of two planes, whose crease runs along z through the whole array.
  const Array wedge(20, 20, 17, [](int64_t x, int64_t y, int64_t) {
    return std::max((x + y - 24.3) / std::sqrt(2.), (x - y - 5.2) / std::sqrt(2.));
  });
  const TriangleSoup soup = wedge.surface(VolumeSides::sample, VolumeCreases::all);
  CHECK(is_closed_2_manifold_by_edges(soup));
  const double edge_x = (24.3 + 5.2) / 2, edge_y = (24.3 - 5.2) / 2;  // of the crease
  const double section = edge_y * (5.2 + edge_x) / 2 + (19 - edge_y) * (edge_x + 5.3) / 2;
  CHECK(volume(soup) == Approx(16 * section).epsilon(.002));
  double farthest = 0;
  for (const WorldPoint& p : soup.vertices) farthest = std::max(farthest, p.x);
  CHECK(farthest == Approx(edge_x).margin(.01));
}

TEST_CASE("sides: any values give a surface that is closed and oriented, or open at unknown values alone",
          "[volume][unit]") {
  Context context;
  for (uint64_t seed = 0; seed < 6; ++seed) {
    const auto noise = [&](int64_t x, int64_t y, int64_t z) {
      return double(random_bits(seed, uint64_t(x * 400 + y * 20 + z)) % 1000) - 300;
    };
    const Array array(9, 13, 17, noise);
    for (const VolumeSides sides : {VolumeSides::sample, VolumeSides::cell}) {
      const TriangleSoup soup = array.surface(sides);
      const auto [topology, dirt] = measure_topology(soup, context);
      CHECK(topology.closed);
      CHECK(topology.oriented);
      CHECK(dirt.degenerate_faces == 0);
    }
    const Array unknown(
        9, 13, 17, [&](int64_t x, int64_t y, int64_t z) { return x == 4 && y == 5 ? std::nan("") : noise(x, y, z); });
    const TriangleSoup open = unknown.surface(VolumeSides::sample);
    for (const WorldPoint& p : open.vertices) REQUIRE((std::abs(p.x - 4) >= 1 || std::abs(p.y - 5) >= 1));
    CHECK(!is_closed_2_manifold_by_edges(open));
  }
}

TEST_CASE("sides: of an array of one value along an axis they are half a voxel out", "[volume][unit]") {
  const Array plate(9, 9, 1, [](int64_t x, int64_t, int64_t) { return double(x) - 4; });
  CHECK(volume(plate.surface(VolumeSides::cell)) == Approx(4.5 * 9).epsilon(1e-3));
  CHECK(volume(plate.surface(VolumeSides::sample)) == Approx(4.5 * 9).epsilon(1e-3));
}

TEST_CASE("sides: unsigned distances end there as signed ones do", "[volume][unit]") {
  const auto distance = [](int64_t x, int64_t y, int64_t z) { return std::hypot(x - 4., y - 9., z - 9.) - 6.3; };
  const Array of_signs(14, 19, 19, distance);
  const Array without(14, 19, 19, [&](int64_t x, int64_t y, int64_t z) { return std::abs(distance(x, y, z)); });
  for (const VolumeSides sides : {VolumeSides::sample, VolumeSides::cell})
    CHECK(volume(without.surface(sides)) == Approx(volume(of_signs.surface(sides))).epsilon(.04));
}

TEST_CASE("sides: they are closed where they were asked to be, also where borders are kept", "[volume][unit]") {
  const Array below(12, 12, 12, [](int64_t, int64_t, int64_t z) { return double(z) - 9.25; });
  for (const VolumeSides sides : {VolumeSides::sample, VolumeSides::cell}) {
    VolumeInfo info;
    const TriangleSoup soup =
        surface_of_volume(below.volume, "mine", {"", {}, 0, VolumeCreases::none, sides, false, true}, info);
    CHECK(is_closed_2_manifold_by_edges(soup));
    CHECK(volume(soup) == Approx(sides == VolumeSides::cell ? 12 * 12 * 9.75 : 11 * 11 * 9.25));
  }
}

TEST_CASE("sides: unknown values say neither which side of the isovalue is outside nor that a body is open",
          "[volume][unit]") {
  const auto ball = [](int64_t x, int64_t y, int64_t z) { return std::hypot(x - 9., y - 9., z - 9.) - 6.3; };
  const Array cylinder(19, 19, 19, [&](int64_t x, int64_t y, int64_t z) {
    return std::hypot(x - 9., y - 9.) > 8.5 || std::abs(z - 9) > 8 ? std::nan("") : ball(x, y, z);
  });
  const Array hollow(
      19, 19, 19, [&](int64_t x, int64_t y, int64_t z) { return ball(x, y, z) < -3 ? std::nan("") : ball(x, y, z); });
  for (const Array* array : {&cylinder, &hollow}) {
    VolumeInfo info;
    const TriangleSoup soup = surface_of_volume(array->volume, "mine", {"", 0., 0, VolumeCreases::none}, info);
    CHECK(is_closed_2_manifold_by_edges(soup));
    CHECK(volume(soup) == Approx(4 * std::acos(-1) * 6.3 * 6.3 * 6.3 / 3).epsilon(.04));
    CHECK(info.open_cells == 0);
  }
}
