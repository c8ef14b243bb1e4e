// Surfaces cut along curves, and lengths of their edges, against what all triangles say.
#include <algorithm>
#include <array>
#include <atomic>
#include <map>
#include <set>
#include <vector>

#include "features/shape_cuts.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "measure/crossings.h"
#include "support/catch.h"
#include "support/feature_shapes.h"
#include "support/open_surfaces.h"
#include "support/refusals.h"
#include "voxel/random.h"

using namespace isoshell;
using namespace isoshell::shape_cuts;

namespace {

/// The sum over the triangles, in square world units.
double area_of(const CutSurface& cut) {
  double sum = 0;
  for (const TriangleIndices& t : cut.surface.triangles) {
    const auto& at = cut.surface.position;
    const Vec64 n = cross(difference(at[t.b], at[t.a]), difference(at[t.c], at[t.a]));
    sum += std::sqrt(double(dot(n, n))) / 2;
  }
  return sum * cut.frame.voxel_size * cut.frame.voxel_size / (kOneVoxelQ8 * kOneVoxelQ8);
}
double area_of(const FeatureMesh& mesh) {
  Context context;
  return measure_topology(soup_of(mesh), context).topology.area_world;
}

/// A sheet that is bent by 10 degrees along each of some long lines. Each strip between two of them is a fan from a far
/// corner to many vertices near to one another.
FeatureShape bent_strips_of_needles() {
  constexpr uint32_t kStrips = 6, kNeedles = 40;
  constexpr double kLong = 30, kWide = .3, kTurn = M_PI / 18;
  FeatureMesh mesh;
  double y = 0, z = 0;
  for (uint32_t strip = 0; strip < kStrips; ++strip) {
    const double along_y = std::cos(strip * kTurn), along_z = std::sin(strip * kTurn);
    const auto far = uint32_t(mesh.vertices.size()), next = far + kNeedles + 1;
    mesh.vertices.push_back({kLong, y, z});
    for (uint32_t i = 0; i < kNeedles; ++i) {
      const double way = kWide * i / kNeedles;
      mesh.vertices.push_back({0, y + way * along_y, z + way * along_z});
      mesh.triangles.push_back({far, far + 1 + i, i + 1 < kNeedles ? far + 2 + i : next + 1});
    }
    mesh.triangles.push_back({far, next + 1, next});
    y += kWide * along_y, z += kWide * along_z;
  }
  mesh.vertices.insert(mesh.vertices.end(), {{kLong, y, z}, {0, y, z}});
  return {"needles", mesh, network_of(mesh, {}), 1, 1};
}

/// The corners of every triangle, sorted.
std::vector<std::array<Place, 3>> triangles_of(const CutSurface& cut) {
  std::vector<std::array<Place, 3>> out;
  for (const TriangleIndices& t : cut.surface.triangles) {
    std::array<Place, 3> corners;
    for (int i = 0; i < 3; ++i) corners[size_t(i)] = place_of(cut.surface.position[optimize::corner(t, i)]);
    std::rotate(corners.begin(), std::min_element(corners.begin(), corners.end()), corners.end());
    out.push_back(corners);
  }
  std::sort(out.begin(), out.end());
  return out;
}

}  // namespace

TEST_CASE("cut surface: has the patches, borders and area of its mesh, and short edges", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape);
    const SurfaceMesh& surface = cut.surface;
    const std::set<uint32_t> patches(surface.patch.begin(), surface.patch.end());
    CHECK(int(patches.size()) == shape.patches);
    CHECK(int(surface.chains.count()) == shape.borders);
    CHECK(std::abs(area_of(cut) / area_of(shape.mesh) - 1) < 1e-3);
    const double most = 1.5 * kEdge / 3 / cut.frame.voxel_size * kOneVoxelQ8;
    int64_t too_long = 0;
    for (const TriangleIndices& t : surface.triangles)
      for (int i = 0; i < 3; ++i)
        too_long += length_q8(surface.position[optimize::corner(t, i)],
                              surface.position[optimize::corner(t, (i + 1) % 3)]) > most;
    CHECK(too_long == 0);
  }
}

TEST_CASE("cut surface: places on borders are where the curves are, each with all of its copies",
          "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape);
    int64_t without = 0, apart = 0;
    for (int64_t v = 0; v < cut.surface.vertex_count(); ++v)
      without += (cut.surface.border_before[v] == kNone) != (cut.place[size_t(v)] == kNone);
    CHECK(without == 0);
    const auto copy = [&](uint32_t p) { return cut.surface.position[cut.copies[size_t(cut.copies_first[p])]]; };
    for (size_t p = 0; p + 1 < cut.copies_first.size(); ++p) {
      CHECK(cut.copies_first[p] < cut.copies_first[p + 1]);
      for (int64_t c = cut.copies_first[p]; c < cut.copies_first[p + 1]; ++c)
        apart += cut.surface.position[cut.copies[size_t(c)]] != copy(uint32_t(p));
    }
    CHECK(apart == 0);
    for (const CutCurve& curve : cut.curves)
      for (size_t i = 1; i < curve.place.size(); ++i)
        CHECK(std::abs(curve.at_q8[i] - curve.at_q8[i - 1] -
                       length_q8(copy(curve.place[i]), copy(curve.place[i - 1]))) < 2);
  }
}

TEST_CASE("cut surface: does not depend on the order of triangles, or on threads", "[cut_surface][stage]") {
  for (const FeatureShape& given : feature_shapes()) {
    INFO(given.name);
    for (const int64_t vertices : {0, 500}) {
      const CutOptions options{kEdge, vertices};
      FeatureShape shape = given;
      const auto expected = triangles_of(cut_of(shape, options));
      CHECK((triangles_of(cut_of(shape, options, 1)) == expected));
      auto& triangles = shape.mesh.triangles;
      for (size_t i = triangles.size() - 1; i > 0; --i) {
        std::swap(triangles[i], triangles[random_bits(3, i) % (i + 1)]);
        std::rotate(triangles[i].begin(), triangles[i].begin() + int64_t(random_bits(4, i) % 3), triangles[i].end());
      }
      CHECK((triangles_of(cut_of(shape, options)) == expected));
    }
  }
}

TEST_CASE("edge lengths: are shorter around holes and between close curves, and fill the mesh",
          "[cut_surface][stage]") {
  // A sheet of 20 x 20 with a hole of 2, which 12 edges of 1.2 would not go around well; and a strip of .5 along a
  // side.
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> at;
  FeatureShape shape{"sheet", {}, {}, 2, 3};
  shape.mesh = grid_mesh(
      40, 40, [](uint32_t i, uint32_t j) { return !(i >= 19 && i < 21 && j >= 19 && j < 21); },
      [](uint32_t, uint32_t) { return 0.; }, at);
  for (WorldPoint& p : shape.mesh.vertices) p.x /= 2, p.y /= 2;
  std::set<EdgeEnds> creases;
  for (uint32_t j = 0; j < 40; ++j) creases.insert(ends(at[{1, j}], at[{1, j + 1}]));
  shape.network = network_of(shape.mesh, creases);
  const int64_t vertices = 400;
  const double even = edge_length_for(shape.mesh, shape.network, vertices);
  const CutSurface cut = cut_of(shape, {even, vertices});
  const SurfaceMesh& surface = cut.surface;
  REQUIRE(surface.lengths.at.size() == surface.vertex_count());
  const auto longest_near = [&](double x, double y, double reach) {
    const LatticeFrame frame = frame_of(shape.mesh);
    uint32_t longest = 0;
    for (int64_t v = 0; v < surface.vertex_count(); ++v) {
      const WorldPoint p = frame.to_world(surface.position[v]);
      if (std::hypot(p.x - x, p.y - y) < reach) longest = std::max(longest, surface.lengths.at[v]);
    }
    return longest * frame.voxel_size / kOneVoxelQ8;
  };
  CHECK(longest_near(10, 10, 0.8) < 0.6 * even);
  CHECK(longest_near(0.25, 5, 0.4) < 1.6 * 0.5 + 0.2);
  CHECK(surface.lengths.largest * cut.frame.voxel_size / kOneVoxelQ8 > even);
  CHECK(4 * (surface.lengths.least + 1) >= surface.lengths.largest);
  double filled = 0;
  int64_t too_steep = 0;
  for (const TriangleIndices& t : surface.triangles) {
    const uint32_t corner[3] = {t.a, t.b, t.c};
    double sum = 0;
    for (int i = 0; i < 3; ++i) {
      const uint32_t u = corner[i], v = corner[(i + 1) % 3];
      sum += surface.lengths.at[u];
      too_steep += std::abs(double(surface.lengths.at[u]) - double(surface.lengths.at[v])) >
                   0.3 * length_q8(surface.position[u], surface.position[v]) + 3;  // a fifth along the first cuts
    }
    const Vec64 n = cross(difference(surface.position[t.b], surface.position[t.a]),
                          difference(surface.position[t.c], surface.position[t.a]));
    filled += std::sqrt(double(dot(n, n)) / 3) / (sum * sum / 9);
  }
  CHECK(too_steep == 0);
  CHECK(filled > 0.8 * double(vertices));  // borders have the rest
  CHECK(filled < 1.01 * double(vertices));
  const FeatureShape cube = feature_cube();
  CHECK(cut_of(cube, {edge_length_for(cube.mesh, cube.network, 600), 600}).surface.lengths.at.empty());
}

TEST_CASE("edge lengths: turns of curves of voxels make none shorter", "[cut_surface][stage]") {
  const FeatureShape cylinder = feature_cylinder(48);
  CutOptions options{edge_length_for(cylinder.mesh, cylinder.network, 60), 60};
  CHECK_FALSE(cut_of(cylinder, options).surface.lengths.at.empty());
  options.is_rough = true;
  CHECK(cut_of(cylinder, options).surface.lengths.at.empty());
}

TEST_CASE("edge length: a mesh of that length has about as many vertices as asked for", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const double edge = edge_length_for(shape.mesh, shape.network, 2000);
    double border = 0;
    for (const FeatureCurve& curve : shape.network.curves)
      for (size_t i = 0; i + (curve.is_loop ? 0 : 1) < curve.vertex.size(); ++i) {
        const WorldPoint p = shape.mesh.vertices[curve.vertex[i]];
        const WorldPoint q = shape.mesh.vertices[curve.vertex[(i + 1) % curve.vertex.size()]];
        const double way = std::sqrt((p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z));
        border += curve.kind == CurveKind::border ? way / 2 : (curve.kind == CurveKind::non_manifold ? -way / 2 : 0);
      }
    CHECK(std::abs(area_of(shape.mesh) / (edge * edge * std::sqrt(3.) / 2) + border / edge - 2000) < 1e-6 * 2000);
  }
}

TEST_CASE("cut surface: needles that fall together on the lattice keep a manifold", "[cut_surface][stage]") {
  FeatureShape shape = feature_sheet("needles", 0, 4, 2, 2);
  for (WorldPoint& p : shape.mesh.vertices)
    if (p.x == 1) p.x = 1e-7;
  const CutSurface cut = cut_of(shape);
  CHECK(cut.surface.chains.count() == 2);
  CHECK(std::abs(area_of(cut) / area_of(shape.mesh) - 1) < 1e-3);
}

TEST_CASE("cut surface: needles of facets that turn little do not meet once their edges are cut",
          "[cut_surface][stage]") {
  const CutSurface cut = cut_of(bent_strips_of_needles());
  const std::atomic<bool> stop{false};
  CHECK(crossing_pairs(cut.surface.position.view(), cut.surface.triangles.view(), {}, stop).empty());
}

TEST_CASE("cut surface: what it can not cut, or seed, is an error that says why", "[cut_surface][stage]") {
  const FeatureShape book = feature_book(), cube = feature_cube();
  Context context;
  const auto cut = [&](const FeatureMesh& mesh, const CurveNetwork& network, double edge) {
    return message_of(ErrorCode::usage, [&] { cut_surface(mesh, network, frame_of(mesh), {edge, 0}, context); });
  };
  CHECK(contains(cut(book.mesh, {}, kEdge), "is on no curve"));
  CHECK(contains(cut(cube.mesh, feature_plate().network, kEdge), "find the curves on this very mesh"));
  CHECK(contains(cut(cube.mesh, cube.network, 0), "edge length"));
  const CutSurface fine = cut_of(cube);
  CHECK(contains(message_of(ErrorCode::usage, [&] { seeds_of(fine, 20, 0); }), "curves and corners take"));

  FeatureMesh needles;
  constexpr uint32_t kCount = 20000;
  for (uint32_t i = 0; i <= kCount; ++i)
    needles.vertices.insert(needles.vertices.end(), {{i * 1e-6, 0, i % 2 * 6e-4}, {i * 1e-6, 9, i % 2 * 6e-4}});
  for (uint32_t i = 0; i < 2 * kCount; i += 2)
    needles.triangles.insert(needles.triangles.end(), {{i, i + 2, i + 3}, {i, i + 3, i + 1}});
  CHECK(contains(cut(needles, network_of(needles, {}), 0.1), "long thin triangles"));
  context.memory_limit_bytes = 100 << 10;
  CHECK(contains(cut(cube.mesh, cube.network, 0.01), "memory limit"));
}
