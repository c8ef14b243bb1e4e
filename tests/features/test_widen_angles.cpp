// Triangles beside curves, widened once patches are joined, against the mesh before.
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <set>

#include "features/angles/mesh_region.h"
#include "features/walls/coarsen_walls.h"
#include "isoshell/mesh_topology.h"
#include "measure/crossings.h"
#include "support/catch.h"
#include "support/feature_shapes.h"
#include "support/made_patches.h"
#include "support/open_surfaces.h"

using namespace isoshell;

namespace {

using Made = MadePatches;

/// Seeds that have hardly moved: cells of all shapes, and triangles as bad.
Made hardly_relaxed(const FeatureShape& shape, Context& context) { return made_patches(shape, 3, context); }

int64_t count_of(const SeededMesh& made) { return join_patches(made.mesh, made.seeds.fixed).mesh.position.size(); }

WorldPoint point(PointQ8 p) { return {double(p.x), double(p.y), double(p.z)}; }

std::vector<double> sines_of(const DualMesh& mesh) {
  std::vector<double> sines;
  for (const TriangleIndices& t : mesh.triangles)
    sines.push_back(smallest_sine(point(mesh.position[t.a]), point(mesh.position[t.b]), point(mesh.position[t.c])));
  return sines;
}
int64_t poor_of(const DualMesh& mesh) {
  const std::vector<double> sines = sines_of(mesh);
  return std::count_if(sines.begin(), sines.end(), [](double sine) { return sine < kPoorSine; });
}

/// Per curve of the network how often each vertex is an end of its edges.
std::map<uint32_t, std::map<uint32_t, int>> ends_of(const MeshFeatures& features) {
  std::map<uint32_t, std::map<uint32_t, int>> ends;
  for (const MeshCurveEdge& e : features.curve_edges)
    for (const uint32_t v : e.vertex) ++ends[e.curve][v];
  return ends;
}

using Place = std::array<int32_t, 3>;
Place place_of(PointQ8 p) { return {p.x, p.y, p.z}; }

}  // namespace

TEST_CASE("wide angles: fewer triangles are poor, none is worse than the worst, and the count stays",
          "[widen_angles][stage]") {
  Context context;
  int64_t before = 0, after = 0;
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const Made made = hardly_relaxed(shape, context);
    if (made.mesh.report.failed_cells > 0) continue;
    const JoinedMesh joined = join_patches(made.mesh.mesh, made.mesh.seeds.fixed);
    const JoinedPatches wide = widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, context);
    CHECK(wide.mesh.position.size() == joined.mesh.position.size());
    CHECK(wide.home.size() == wide.mesh.position.size());
    CHECK(int64_t(wide.features.patch.size()) == wide.mesh.triangles.size());
    const std::vector<double> was = sines_of(joined.mesh), is = sines_of(wide.mesh);
    CHECK(*std::min_element(is.begin(), is.end()) >=
          std::min(kPoorSine, *std::min_element(was.begin(), was.end())) - 1e-12);
    before += poor_of(joined.mesh);
    after += poor_of(wide.mesh);
    const LatticeFrame frame;
    const MeshTopology then = check_mesh(to_world(joined.mesh, frame)), now = check_mesh(to_world(wide.mesh, frame));
    CHECK(now.components == then.components);
    CHECK(now.genus == then.genus);
    CHECK(now.is_closed_manifold() == then.is_closed_manifold());
  }
  CHECK(before > 100);
  CHECK(after < before / 3);
}

TEST_CASE("wide angles: poor triangles that there are too many of are counted and stay", "[widen_angles][stage]") {
  Context context;
  const Made made = hardly_relaxed(feature_shapes()[0], context);
  const JoinedMesh joined = join_patches(made.mesh.mesh, made.mesh.seeds.fixed);
  REQUIRE(poor_of(joined.mesh) > 0);
  const JoinOptions no_tries{count_of(made.mesh), false, 0};
  const JoinedPatches same = widened_to_count(made.cut, made.mesh, no_tries, context);
  CHECK(same.left_alone == poor_of(joined.mesh));
  CHECK(poor_of(same.mesh) == poor_of(joined.mesh));
  CHECK(widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, context).left_alone == 0);
}

TEST_CASE("wide angles: curves are the same, in edges between places on them", "[widen_angles][stage]") {
  Context context;
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const Made made = hardly_relaxed(shape, context);
    if (made.mesh.report.failed_cells > 0) continue;
    const JoinedPatches wide = widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, context);
    std::map<uint32_t, std::set<Place>> places;  // per curve of the network
    for (const CutCurve& curve : made.cut.curves)
      for (const uint32_t p : curve.place)
        places[curve.curve].insert(
            place_of(made.cut.surface.position[made.cut.copies[size_t(made.cut.copies_first[p])]]));
    const auto ends = ends_of(wide.features);
    CHECK(ends.size() == places.size());
    const std::set<uint32_t> corners(wide.features.corners.begin(), wide.features.corners.end());
    CHECK(int64_t(corners.size()) == made.cut.corner_count);
    std::set<uint32_t> on_curves = corners;
    for (const auto& [curve, vertices] : ends)
      for (const auto& [v, edges] : vertices) {
        CHECK(places[curve].count(place_of(wide.mesh.position[v])) == 1);
        if (!corners.count(v)) CHECK(edges == 2);
        on_curves.insert(v);
      }
    CHECK(wide.on_curves == int64_t(on_curves.size()));
  }
}

TEST_CASE("wide angles: are the same for every number of threads", "[widen_angles][stage]") {
  Context one, many;
  one.threads = 1;
  const FeatureShape shape = feature_plate();
  const Made made = hardly_relaxed(shape, many);
  const JoinedPatches a = widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, one),
                      b = widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, many);
  REQUIRE(a.mesh.position.size() == b.mesh.position.size());
  for (int64_t v = 0; v < a.mesh.position.size(); ++v)
    CHECK(place_of(a.mesh.position[v]) == place_of(b.mesh.position[v]));
}

TEST_CASE("wide angles: no triangles come to intersect, and none to be there twice", "[widen_angles][stage]") {
  Context context;
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const Made made = hardly_relaxed(shape, context);
    if (made.mesh.report.failed_cells > 0) continue;
    const JoinedMesh joined = join_patches(made.mesh.mesh, made.mesh.seeds.fixed);
    const JoinedPatches wide = widened_to_count(made.cut, made.mesh, {count_of(made.mesh)}, context);
    const auto crossing = [&](const DualMesh& mesh) {
      return crossing_pairs(mesh.position.view(), mesh.triangles.view(), {}, context.cancel).size();
    };
    CHECK(crossing(wide.mesh) <= crossing(joined.mesh));
    std::set<std::array<uint32_t, 3>> faces;
    for (const TriangleIndices& t : wide.mesh.triangles) {
      std::array<uint32_t, 3> corners{t.a, t.b, t.c};
      std::sort(corners.begin(), corners.end());
      CHECK(faces.insert(corners).second);
    }
  }
}

TEST_CASE("wide angles: no edge of a tetrahedron collapses, which would leave the same triangle twice",
          "[widen_angles][stage]") {
  Context context;
  const Made made = hardly_relaxed(feature_plate(), context);
  const CutLookup lookup(made.cut);
  std::vector<RegionVertex> vertices(4);
  const WorldPoint at[4] = {{0, 0, 0}, {512, 0, 0}, {0, 512, 0}, {0, 0, 512}};
  for (size_t v = 0; v < 4; ++v) vertices[v].position = at[v];
  std::vector<RegionTriangle> triangles;
  for (const auto& corner : {std::array<uint32_t, 3>{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}})
    triangles.push_back({corner, {kNone, kNone, kNone}});
  MeshRegion region(lookup, std::move(vertices), std::move(triangles));
  for (uint32_t u = 0; u < 4; ++u)
    for (uint32_t v = 0; v < 4; ++v) CHECK((u == v || !region.collapse(u, v)));
}
