// Surfaces cut along curves, and their seeds, against what all triangles say.
#include <algorithm>
#include <numeric>
#include <tuple>

#include "features/curve_seeds.h"
#include "isoshell/error.h"
#include "isoshell/stages.h"
#include "support/catch.h"
#include "support/feature_shapes.h"
#include "support/open_surfaces.h"
#include "voxel/random.h"

using namespace isoshell;

namespace {

constexpr double kEdge = 0.6;

TriangleSoup soup_of(const FeatureMesh& mesh) {
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  return soup;
}
LatticeFrame frame_of(const FeatureMesh& mesh) {
  const auto [lo, hi] = bounding_box(soup_of(mesh));
  return LatticeFrame::around(lo, hi, 50);
}
CutSurface cut_of(const FeatureShape& shape, double edge = kEdge, int threads = 0) {
  Context context;
  context.threads = threads;
  return cut_surface(shape.mesh, shape.network, frame_of(shape.mesh), edge, context);
}
double length_q8(PointQ8 a, PointQ8 b) { return std::sqrt(double(distance_sq_q16(a, b))); }

/// The sum over the triangles, in square world units.
double area_of(const CutSurface& cut) {
  double sum = 0;
  for (const TriangleIndices& t : cut.surface.triangles) {
    const auto& at = cut.surface.position;
    const Vec64 n = cross(difference(at[t.b], at[t.a]), difference(at[t.c], at[t.a]));
    sum += std::sqrt(double(dot(n, n))) / 2;
  }
  return sum * cut.voxel_size * cut.voxel_size / (kOneVoxelQ8 * kOneVoxelQ8);
}
double area_of(const FeatureMesh& mesh) {
  Context context;
  return measure_topology(soup_of(mesh), context).topology.area_world;
}

using Place = std::tuple<int32_t, int32_t, int32_t>;
Place place_of(PointQ8 p) { return {p.x, p.y, p.z}; }
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
int64_t distinct_joined(const SeedSet& seeds) {
  return int64_t(std::set<uint32_t>(seeds.fixed.joined.begin(), seeds.fixed.joined.end()).size());
}

template <class Call>
std::string usage_error(Call call) {
  try {
    call();
  } catch (const Error& e) {
    CHECK(e.code() == ErrorCode::usage);
    return e.what();
  }
  return "no error";
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
    const double most = 1.5 * kEdge / 4 / cut.voxel_size * kOneVoxelQ8;
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
  for (FeatureShape shape : feature_shapes()) {
    INFO(shape.name);
    const auto expected = triangles_of(cut_of(shape));
    CHECK(triangles_of(cut_of(shape, kEdge, 1)) == expected);
    auto& triangles = shape.mesh.triangles;
    for (size_t i = triangles.size() - 1; i > 0; --i) {
      std::swap(triangles[i], triangles[random_bits(3, i) % (i + 1)]);
      std::rotate(triangles[i].begin(), triangles[i].begin() + int64_t(random_bits(4, i) % 3), triangles[i].end());
    }
    CHECK(triangles_of(cut_of(shape)) == expected);
  }
}

TEST_CASE("fixed seeds: follow every curve at equal arclengths, and each owns a vertex", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes())
    for (const double edge : {kEdge, 2.3, 30.}) {
      INFO(shape.name << ", edge " << edge);
      const CutSurface cut = cut_of(shape, edge);
      const SeedSet seeds = seeds_on_curves(cut, edge);
      const auto& of_vertex = seeds.fixed.of_vertex;
      std::map<uint32_t, std::vector<uint32_t>> at_place;
      for (uint32_t s = 0; s < seeds.size(); ++s) {
        CHECK(of_vertex[seeds.home[s]] == s);
        CHECK(seeds.position[s] == cut.surface.position[seeds.home[s]]);
        at_place[cut.place[seeds.home[s]]].push_back(s);
      }
      for (const auto& [p, copies] : at_place) {
        CHECK(int64_t(copies.size()) == cut.copies_first[p + 1] - cut.copies_first[p]);
        for (const uint32_t s : copies) CHECK(seeds.fixed.joined[s] == copies.front());
      }
      for (uint32_t p = 0; p < cut.corner_count; ++p) CHECK(at_place.count(p) == 1);
      for (const CutCurve& curve : cut.curves) {
        std::vector<double> at;
        for (size_t i = 0; i < curve.place.size(); ++i)
          if (at_place.count(curve.place[i])) at.push_back(curve.at_q8[i]);
        if (curve.is_loop) at.push_back(curve.length_q8);
        const double edge_q8 = edge / cut.voxel_size * kOneVoxelQ8;
        const auto segments = std::max(curve.least_segments, int64_t(std::lround(curve.length_q8 / edge_q8)));
        REQUIRE(int64_t(at.size()) == segments + 1);
        for (size_t i = 1; i < at.size(); ++i)
          CHECK(std::abs((at[i] - at[i - 1]) * double(segments) / curve.length_q8 - 1) < 0.07);
      }
    }
}

TEST_CASE("fixed seeds: border vertices belong to the nearest along their side of the curve", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape);
    const SeedSet seeds = seeds_on_curves(cut, kEdge);
    const auto& of_vertex = seeds.fixed.of_vertex;
    for (int64_t v = 0; v < cut.surface.vertex_count(); ++v)
      CHECK((of_vertex[v] == kNone) == (cut.surface.border_before[v] == kNone));
    for (const auto& loop : border_loops_of(cut.surface.triangles)) {
      // Arclength along the loop, twice around.
      std::vector<double> at{0};
      for (size_t i = 0; i < 2 * loop.size(); ++i)
        at.push_back(at.back() + length_q8(cut.surface.position[loop[i % loop.size()]],
                                           cut.surface.position[loop[(i + 1) % loop.size()]]));
      const double around = at[loop.size()];
      for (size_t i = 0; i < loop.size(); ++i) {
        double nearest = 1e300, own = 1e300;
        for (size_t j = 0; j < loop.size(); ++j) {
          const uint32_t s = of_vertex[loop[j]];
          if (seeds.home[s] != loop[j]) continue;
          const double straight = std::abs(at[i] - at[j]), way = std::min(straight, around - straight);
          nearest = std::min(nearest, way);
          if (s == of_vertex[loop[i]]) own = way;
        }
        CHECK(own < nearest + 20);  // lengths of rounded edges
      }
    }
  }
}

TEST_CASE("free seeds: the joined result has as many vertices as asked for, in patches by their area",
          "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes())
    for (const int64_t vertices : {300, 701}) {
      INFO(shape.name << ", " << vertices);
      const double edge = edge_length_for(shape.mesh, shape.network, vertices);
      const CutSurface cut = cut_of(shape, edge);
      const SeedSet seeds = add_free_seeds(cut, seeds_on_curves(cut, edge), vertices, 5);
      CHECK(distinct_joined(seeds) + seeds.size() - seeds.fixed.count == vertices);
      std::map<uint32_t, int> in_patch;
      for (int64_t s = seeds.fixed.count; s < seeds.size(); ++s) {
        CHECK(cut.place[seeds.home[s]] == kNone);
        ++in_patch[cut.surface.patch[seeds.home[s]]];
      }
      if (shape.name == "cube")
        for (const auto& [patch, count] : in_patch) CHECK(std::abs(count - in_patch[0]) <= 1);
      const SeedSet other = add_free_seeds(cut, seeds_on_curves(cut, edge), vertices, 6);
      CHECK(!std::equal(seeds.home.begin(), seeds.home.end(), other.home.begin()));
    }
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

TEST_CASE("cut surface: what it can not cut, or seed, is an error that says why", "[cut_surface][stage]") {
  const FeatureShape book = feature_book(), cube = feature_cube();
  Context context;
  const auto cut = [&](const FeatureMesh& mesh, const CurveNetwork& network, double edge) {
    return usage_error([&] { cut_surface(mesh, network, frame_of(mesh), edge, context); });
  };
  CHECK(cut(book.mesh, {}, kEdge).find("is on no curve") != std::string::npos);
  CHECK(cut(cube.mesh, feature_plate().network, kEdge).find("find the curves on this very mesh") != std::string::npos);
  CHECK(cut(cube.mesh, cube.network, 0).find("edge length") != std::string::npos);
  const CutSurface fine = cut_of(cube);
  CHECK(usage_error([&] {
          add_free_seeds(fine, seeds_on_curves(fine, kEdge), 20, 0);
        }).find("curves and corners take") != std::string::npos);

  FeatureMesh needles;
  constexpr uint32_t kCount = 20000;
  for (uint32_t i = 0; i <= kCount; ++i)
    needles.vertices.insert(needles.vertices.end(), {{i * 1e-6, 0, 0}, {i * 1e-6, 9, 0}});
  for (uint32_t i = 0; i < 2 * kCount; i += 2)
    needles.triangles.insert(needles.triangles.end(), {{i, i + 2, i + 3}, {i, i + 3, i + 1}});
  CHECK(cut(needles, network_of(needles, {}), 0.01).find("long thin triangles") != std::string::npos);
}
