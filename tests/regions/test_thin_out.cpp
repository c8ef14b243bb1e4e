// Walls of voxels with fewer triangles, against the walls before.
#include <algorithm>
#include <cmath>

#include "features/mesh/thin_out.h"
#include "features/mesh/weld_for_features.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/io/memory_input.h"
#include "measure/crossings.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/catch.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

LatticeFrame frame_of(const FeatureMesh& mesh) {
  WorldBox box = box_of_none();
  for (const WorldPoint& p : mesh.vertices) stretch(box, p);
  return LatticeFrame::around(box.min, box.max, 64);
}

size_t crossings_of(const FeatureMesh& mesh, const Context& context) {
  const LatticeFrame frame = frame_of(mesh);
  std::vector<PointQ8> at;
  std::vector<TriangleIndices> triangles;
  for (const WorldPoint& p : mesh.vertices) at.push_back(frame.snap(p));
  for (const auto& t : mesh.triangles) triangles.push_back({t[0], t[1], t[2]});
  return crossing_pairs({at.data(), int64_t(at.size())}, {triangles.data(), int64_t(triangles.size())}, {},
                        context.cancel)
      .size();
}

FaceRegions regions_of(const FeatureMesh& mesh, const FaceRegions& all) {
  FaceRegions out = all;
  out.labels.clear();
  for (const uint32_t face : mesh.source_face) out.labels.push_back(all.labels[face]);
  return out;
}

}  // namespace

TEST_CASE("thinned walls of any labels bound closed regions, and part what the walls before parted") {
  CpuContext context;
  for (uint32_t number = 0; number < 200; ++number) {
    INFO("random volume " << number);
    const TriangleSoup soup = surface_of_labels(random_labels(number), "labels", 0);
    const FeatureMesh before = weld_for_features(soup);
    const FeatureMesh after = thin_out(before, {}, frame_of(before), 4, 8, context);
    const FaceRegions regions = regions_of(after, soup.regions);
    const std::string fault = fault_of_regions(after.triangles, regions);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(pairs_of(regions) == pairs_of(soup.regions));
    CHECK(after.vertices.size() <= before.vertices.size());
    CHECK(crossings_of(after, context) <= crossings_of(before, context));
  }
}

TEST_CASE("thinned walls of grains have far fewer vertices, and hold the same volumes") {
  CpuContext context;
  const TriangleSoup soup = surface_of_labels(voronoi_grains(64, 12), "labels", 0);
  const FeatureMesh before = weld_for_features(soup);
  const FeatureMesh after = thin_out(before, {}, frame_of(before), 8, 8, context);
  CHECK(4 * after.vertices.size() < before.vertices.size());
  const auto all = volumes_of_regions(before.vertices, before.triangles, regions_of(before, soup.regions));
  const auto left = volumes_of_regions(after.vertices, after.triangles, regions_of(after, soup.regions));
  REQUIRE(left.size() == all.size());
  for (const auto& [label, world] : all) {
    INFO("region " << label);
    CHECK(std::abs(left.at(label) - world) < 0.01 * world);
  }
}

TEST_CASE("thinned walls are the same for any number of threads, and keep the order of vertices and triangles") {
  const FeatureMesh before = weld_for_features(surface_of_labels(voronoi_grains(48, 9), "labels", 0));
  Context alone, several;
  alone.threads = 1;
  several.threads = 4;
  const FeatureMesh one = thin_out(before, {}, frame_of(before), 6, 8, alone),
                    other = thin_out(before, {}, frame_of(before), 6, 8, several);
  CHECK(one.vertices == other.vertices);
  CHECK(one.triangles == other.triangles);
  CHECK(one.source_face == other.source_face);
  CHECK(std::is_sorted(one.vertices.begin(), one.vertices.end(), is_before));
  CHECK(std::is_sorted(one.triangles.begin(), one.triangles.end()));
}
