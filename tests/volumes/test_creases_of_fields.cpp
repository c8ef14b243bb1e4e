// Level sets of sharp bodies keep their edges and corners; others are as they were.
#include <tbb/task_arena.h>

#include <cmath>

#include "features/curves/face_normals.h"
#include "features/curves/find_curves.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/world_vector.h"
#include "implicit/volumes/crease_intersections.h"
#include "implicit/volumes/iso_surface.h"
#include "isoshell/advanced/stages.h"
#include "support/catch.h"
#include "support/made_field.h"
#include "support/shapes.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

constexpr double kBand = 3;

/// Rows of a turn by odd angles.
struct Turn {
  WorldPoint row[3];
  WorldPoint operator()(const WorldPoint& p) const { return {dot(row[0], p), dot(row[1], p), dot(row[2], p)}; }
};
Turn turned_by(double a, double b) {
  const WorldPoint x{std::cos(a) * std::cos(b), std::sin(a) * std::cos(b), std::sin(b)};
  const WorldPoint y{-std::sin(a), std::cos(a), 0};
  return {{x, y, cross(x, y)}};
}

/// Signed distance from the surface of a box around the origin.
double box_distance(const WorldPoint& p, const WorldPoint& half) {
  const WorldPoint q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
  const WorldPoint out{std::max(q.x, 0.), std::max(q.y, 0.), std::max(q.z, 0.)};
  return length(out) + std::min(0., std::max({q.x, q.y, q.z}));
}

MadeField level_set(int32_t half, const std::function<double(const WorldPoint&)>& distance) {
  return MadeField(
      -half, half,
      [distance](Voxel v) {
        return float(std::clamp(distance({double(v.x), double(v.y), double(v.z)}), -kBand, kBand));
      },
      kBand);
}
MadeField turned_cube(const Turn& turn, double half) {
  return level_set(32, [=](const WorldPoint& p) {
    return box_distance(turn(p) - WorldPoint{.2, .3, .4}, {half, half, half});
  });
}

CurveNetwork curves_of(const FeatureMesh& mesh) { return find_curves(mesh, {CreaseMode::automatic, 0, 4}); }

}  // namespace

TEST_CASE("creases of fields: a cube at any angle has its eight corners, its edges and flat faces", "[volume][unit]") {
  constexpr double kHalf = 11.3;
  for (const double angle : {0., .31, .5, .77, 1.1}) {
    const Turn turn = turned_by(angle, angle * .7);
    const TriangleSoup soup = extract_iso_surface(turned_cube(turn, kHalf), 0, 0, VolumeCreases::all);
    CHECK(is_closed_2_manifold_by_edges(soup));
    const auto in_cube = [&](const WorldPoint& p) { return turn(p) - WorldPoint{.2, .3, .4}; };
    for (const WorldPoint& p : soup.vertices) REQUIRE(std::abs(box_distance(in_cube(p), {kHalf, kHalf, kHalf})) < .1);
    CHECK(volume(soup) == Approx(8 * kHalf * kHalf * kHalf).epsilon(2e-3));
    const FeatureMesh mesh = weld_for_features(soup);
    const CurveNetwork network = curves_of(mesh);
    double along = 0;
    for (const FeatureCurve& curve : network.curves)
      for (size_t i = 1; i < curve.vertex.size(); ++i)
        along += length(mesh.vertices[curve.vertex[i]] - mesh.vertices[curve.vertex[i - 1]]);
    CHECK(along == Approx(24 * kHalf).epsilon(.03));
    for (int c = 0; c < 8; ++c) {
      const WorldPoint corner{c & 4 ? kHalf : -kHalf, c & 2 ? kHalf : -kHalf, c & 1 ? kHalf : -kHalf};
      CHECK(std::any_of(network.corners.begin(), network.corners.end(),
                        [&](uint32_t v) { return length(in_cube(mesh.vertices[v]) - corner) < .1; }));
    }
    int64_t near = 0, all = 0;
    for (const FeatureCurve& curve : network.curves)
      for (const uint32_t v : curve.vertex) {
        const WorldPoint p = in_cube(mesh.vertices[v]);
        const double off[3] = {std::abs(std::abs(p.x) - kHalf), std::abs(std::abs(p.y) - kHalf),
                               std::abs(std::abs(p.z) - kHalf)};
        near += (off[0] < .1) + (off[1] < .1) + (off[2] < .1) >= 2;
        ++all;
      }
    CHECK(double(near) > .97 * double(all));
  }
}

TEST_CASE("creases of fields: a hollow corner is as sharp as one that sticks out", "[volume][unit]") {
  const Turn turn = turned_by(.4, .6);
  const TriangleSoup soup = extract_iso_surface(
      level_set(
          32,
          [&](const WorldPoint& p) {
            const WorldPoint q = turn(p);
            return std::max(box_distance(q, {14, 14, 14}), -box_distance(q - WorldPoint{14, 14, 14}, {14, 14, 14}));
          }),
      0, 0, VolumeCreases::all);
  CHECK(is_closed_2_manifold_by_edges(soup));
  CHECK(volume(soup) == Approx(7. / 8 * 28 * 28 * 28).epsilon(3e-3));
}

TEST_CASE("creases of fields: smooth surfaces are as without creases, to 1/32 of a voxel", "[volume][unit]") {
  const MadeField ball = level_set(32, [](const WorldPoint& p) { return length(p - WorldPoint{.1, .2, .3}) - 20.3; });
  const TriangleSoup kept = extract_iso_surface(ball, 0, 0, VolumeCreases::all), plain = extract_iso_surface(ball, 0);
  CHECK(kept.triangles == plain.triangles);
  for (size_t v = 0; v < plain.vertices.size(); ++v) REQUIRE(distance_sq(kept.vertices[v], plain.vertices[v]) < 1e-3);
  CHECK(curves_of(weld_for_features(kept)).curves.empty());
}

TEST_CASE("creases of fields: asking for those of sharp bodies changes no byte of smooth ones", "[volume][unit]") {
  const auto blob = [](const WorldPoint& p) {  // of three balls, with bends of a few voxels between them
    double sum = 0;
    for (const WorldPoint& c : {WorldPoint{-9, 1, 0}, WorldPoint{8, 3, 2}, WorldPoint{1, -8, 5}})
      sum += 1 / (1e-3 + distance_sq(p, c));
    return 7 - 1 / std::sqrt(sum);
  };
  const MadeField smooth[] = {
      level_set(32,
                [](const WorldPoint& p) {
                  return length(p - WorldPoint{.1, .2, .3}) - 20.3;
                }),
      level_set(32, [](const WorldPoint& p) { return length(p) - 4.2; }),
      level_set(32, [&](const WorldPoint& p) { return -blob(p); }),
  };
  for (const MadeField& field : smooth) {
    const TriangleSoup requested = extract_iso_surface(field, 0, 0, VolumeCreases::of_sharp_bodies);
    const TriangleSoup plain = extract_iso_surface(field, 0);
    CHECK(requested.triangles == plain.triangles);
    REQUIRE(requested.vertices.size() == plain.vertices.size());
    for (size_t v = 0; v < plain.vertices.size(); ++v)
      REQUIRE(distance_sq(requested.vertices[v], plain.vertices[v]) == 0);
  }
}

TEST_CASE("creases of fields: sharp bodies are known without being told", "[volume][unit]") {
  for (const double angle : {0., .31, .77}) {
    const MadeField cube = turned_cube(turned_by(angle, .7 * angle), 20.3);
    const TriangleSoup known = extract_iso_surface(cube, 0, 0, VolumeCreases::of_sharp_bodies);
    const TriangleSoup told = extract_iso_surface(cube, 0, 0, VolumeCreases::all);
    CHECK(known.triangles == told.triangles);
    CHECK(known.triangles != extract_iso_surface(cube, 0).triangles);
  }
}

TEST_CASE("creases of fields: the rims of a cylinder at odd angles are circles", "[volume][unit]") {
  constexpr double kRadius = 14.2, kHalf = 11.3;
  for (const double angle : {.31, .5, 1.1}) {
    const Turn turn = turned_by(angle, angle * .7);
    const MadeField cylinder = level_set(32, [&](const WorldPoint& p) {
      const WorldPoint q = turn(p);
      const double side = std::sqrt(q.x * q.x + q.y * q.y) - kRadius, end = std::abs(q.z) - kHalf;
      const double out = std::sqrt(std::max(side, 0.) * std::max(side, 0.) + std::max(end, 0.) * std::max(end, 0.));
      return out + std::min(0., std::max(side, end));
    });
    const TriangleSoup soup = extract_iso_surface(cylinder, 0, 0, VolumeCreases::of_sharp_bodies);
    CHECK(is_closed_2_manifold_by_edges(soup));
    CHECK(find_intersecting(soup, std::vector<uint8_t>(soup.vertices.size(), 1)).empty());
    const FeatureMesh mesh = weld_for_features(soup);
    const CurveNetwork network = curves_of(mesh);
    CHECK(network.curves.size() >= 2);
    double along = 0;
    for (const FeatureCurve& curve : network.curves)
      for (size_t i = 0; i < curve.vertex.size(); ++i) {
        const WorldPoint q = turn(mesh.vertices[curve.vertex[i]]);
        CHECK(std::abs(std::sqrt(q.x * q.x + q.y * q.y) - kRadius) < .2);
        CHECK(std::abs(std::abs(q.z) - kHalf) < .2);
        if (i > 0) along += length(mesh.vertices[curve.vertex[i]] - mesh.vertices[curve.vertex[i - 1]]);
      }
    CHECK(along == Approx(4 * 3.14159265 * kRadius).epsilon(.05));
  }
}

TEST_CASE("creases of fields: hollow creases that a level set's maker filled are as sharp as before",
          "[volume][unit]") {
  constexpr double kFilled = .7;  // voxels, at the crease, and less around it
  for (const double angle : {0., .4, .9}) {
    const Turn turn = turned_by(angle, angle * 1.3);
    const MadeField filled = level_set(32, [&](const WorldPoint& p) {
      const WorldPoint q = turn(p);
      const double solid =
          std::max(box_distance(q, {14, 14, 14}), -box_distance(q - WorldPoint{14, 14, 0}, {14, 14, 30}));
      return solid - std::max(0., kFilled - .5 * std::sqrt(q.x * q.x + q.y * q.y));
    });
    const TriangleSoup soup = extract_iso_surface(filled, 0, 0, VolumeCreases::of_sharp_bodies);
    CHECK(is_closed_2_manifold_by_edges(soup));
    for (double z = -10; z <= 10; z += .5) {
      double nearest = 1e9;
      for (const WorldPoint& p : soup.vertices) {
        const WorldPoint q = turn(p);
        if (q.x * q.x + q.y * q.y < .15 * .15) nearest = std::min(nearest, std::abs(q.z - z));
      }
      CHECK(nearest < 1);
    }
  }
}

TEST_CASE("creases of fields: around steps of one or two voxels no triangle higher than 1/32 is folded onto another",
          "[volume][unit]") {
  for (const double step : {1.2, 1.6, 1.9}) {
    const Turn turn = turned_by(.21, .13);
    const auto bored = [&](const WorldPoint& p) {  // a plate with a hole that is wider in its upper half
      const WorldPoint q = turn(p);
      const double off = std::hypot(q.x, q.y), wide = std::hypot(std::max(0., 6 + step - off), std::max(0., -q.z)),
                   narrow = std::max(0., 6 - off);
      const double in_wide = std::max(6 + step - off >= 0 && -q.z <= 0 ? -std::min(6 + step - off, q.z) : wide, -1e9),
                   in_narrow = narrow > 0 ? -narrow : off - 6;
      return std::max(box_distance(q, {14, 14, 7}), -std::min(in_wide, in_narrow));
    };
    const TriangleSoup soup = extract_iso_surface(level_set(32, bored), 0, 0, VolumeCreases::all);
    CHECK(is_closed_2_manifold_by_edges(soup));
    const FeatureMesh mesh = weld_for_features(soup);
    const MeshEdges edges = find_mesh_edges(mesh);
    const Buffer<WorldPoint> normals = face_normals(mesh, edges);
    const auto is_high = [&](uint32_t face) {
      const auto& [a, b, c] = mesh.triangles[face];
      return triangle_height(mesh.vertices[a], mesh.vertices[b], mesh.vertices[c]) > 1. / 32;
    };
    int folds = 0;
    for (const FeatureEdge& e : edges.edges)
      folds += is_high(e.face[0]) && is_high(e.face[1]) &&
               turn_between(normals[e.face[0]], normals[e.face[1]]) > turn_of_degrees(165);
    CHECK(folds == 0);
  }
}

TEST_CASE("creases of fields: bodies of random planes stay closed 2-manifolds", "[volume][unit]") {
  for (uint64_t seed = 0; seed < 12; ++seed) {
    const auto number = [&](uint64_t i) { return double(random_bits(seed, i) % 2001) / 1000 - 1; };
    std::vector<std::pair<WorldPoint, double>> planes;
    for (uint64_t i = 0; i < 12; ++i) {
      const WorldPoint n{number(4 * i), number(4 * i + 1), number(4 * i + 2) + 1e-3};
      planes.push_back({(1 / length(n)) * n, 4 * number(4 * i + 3) + 3});
    }
    // Parts of four planes each, united: with thin wedges, ambiguous cells, and parts that only just touch.
    const TriangleSoup soup = extract_iso_surface(
        level_set(16,
                  [&](const WorldPoint& p) {
                    double united = length(p) - 5;
                    for (size_t part = 0; part < 3; ++part) {
                      double inside = length(p) - 12;
                      for (size_t i = 0; i < 4; ++i)
                        inside = std::max(inside, dot(planes[4 * part + i].first, p) - planes[4 * part + i].second);
                      united = std::min(united, inside);
                    }
                    return united;
                  }),
        0, 0, VolumeCreases::all);
    CHECK(is_closed_2_manifold_by_edges(soup));
    CHECK(volume(soup) > 0);
  }
}

TEST_CASE("creases of fields: noise gives closed 2-manifolds, and values without end are no matter", "[volume][unit]") {
  for (uint64_t seed = 0; seed < 3; ++seed) {
    const MadeField noise(
        -8, 16,
        [&](Voxel v) {
          return float(
              double(random_bits(seed, uint64_t((v.x + 64) << 16 | (v.y + 64) << 8 | (v.z + 64))) % 401) / 100 - 1.7);
        },
        1);
    CHECK(is_closed_2_manifold_by_edges(extract_iso_surface(noise, 0, 0, VolumeCreases::all)));
  }
  const MadeField infinite(
      0, 8, [](Voxel v) { return v.x < 4 ? -INFINITY : INFINITY; }, INFINITY);
  const TriangleSoup soup = extract_iso_surface(infinite, 0, 0, VolumeCreases::all);
  CHECK(is_closed_2_manifold_by_edges(soup));
  for (const WorldPoint& p : soup.vertices) REQUIRE(std::isfinite(p.x + p.y + p.z));
}

TEST_CASE("creases of fields: densities, other values and mirrors have the same creases", "[volume][unit]") {
  const Turn turn = turned_by(.31, .2);
  const TriangleSoup soup = extract_iso_surface(turned_cube(turn, 11.3), 0, 0, VolumeCreases::all);
  MadeField density(
      -32, 32,
      [&](Voxel v) {
        const double d =
            box_distance(turn({double(v.x), double(v.y), double(v.z)}) - WorldPoint{.2, .3, .4}, {11.3, 11.3, 11.3});
        return float(.5 - std::clamp(d, -kBand, kBand) / 8);
      },
      .125);
  const TriangleSoup same = extract_iso_surface(density, .5, 0, VolumeCreases::all);
  CHECK(same.triangles == soup.triangles);
  density.to_world.at[0][0] = -1;
  CHECK(volume(extract_iso_surface(density, .5, 0, VolumeCreases::all)) == Approx(volume(same)));
  density.to_world.at[1][1] = 2;
  const TriangleSoup stretched = extract_iso_surface(density, .5, 0, VolumeCreases::all);
  CHECK(stretched.triangles == extract_iso_surface(density, .5).triangles);  // its distances are no distances
}

TEST_CASE("creases of fields: any number of threads makes the same soup", "[volume][unit]") {
  const MadeField cube = turned_cube(turned_by(.5, .3), 20.1);
  TriangleSoup soup[2];
  for (const int i : {0, 1})
    tbb::task_arena(i == 0 ? 1 : 7).execute([&] { soup[i] = extract_iso_surface(cube, 0, 0, VolumeCreases::all); });
  CHECK(soup[0].triangles == soup[1].triangles);
  REQUIRE(soup[0].vertices.size() == soup[1].vertices.size());
  for (size_t v = 0; v < soup[0].vertices.size(); ++v)
    REQUIRE(distance_sq(soup[0].vertices[v], soup[1].vertices[v]) == 0);
}
