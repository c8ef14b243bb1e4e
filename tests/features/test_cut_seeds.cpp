// Seeds of surfaces cut along curves: those fixed on the curves, and the free ones in the patches.
#include <algorithm>
#include <map>
#include <set>
#include <vector>

#include "features/shape_cuts.h"
#include "support/catch.h"
#include "support/open_surfaces.h"
#include "voxel/snap.h"

using namespace isoshell;
using namespace isoshell::shape_cuts;

namespace {

int64_t distinct_joined(const SeedSet& seeds) {
  return int64_t(std::set<uint32_t>(seeds.fixed.joined.begin(), seeds.fixed.joined.end()).size());
}

}  // namespace

TEST_CASE("fixed seeds: follow every curve about one edge length apart, and each owns a vertex",
          "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes())
    for (const double edge : {kEdge, 2.3, 30.}) {
      INFO(shape.name << ", edge " << edge);
      const CutSurface cut = cut_of(shape, {edge, 0});
      const SeedSet seeds = seeds_on_curves(cut, 0);
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
        const double edge_q8 = edge / cut.frame.voxel_size * kOneVoxelQ8;
        const auto segments = int64_t(at.size()) - 1;
        REQUIRE(segments >= curve.least_segments);
        if (curve.length_q8 > 2 * double(curve.least_segments) * edge_q8) {
          CHECK(std::abs(double(segments) - curve.length_q8 / edge_q8) < 0.1 * double(segments) + 0.6);
          for (size_t i = 1; i < at.size(); ++i) {
            CHECK(at[i] - at[i - 1] < 1.3 * edge_q8);
            CHECK(at[i] - at[i - 1] > 0.5 * edge_q8);  // those of a curve near by may begin in the middle between two
          }
        }
        if (segments == curve.least_segments && segments > 1)
          for (size_t i = 1; i < at.size(); ++i)
            CHECK(std::abs((at[i] - at[i - 1]) * double(segments) / curve.length_q8 - 1) < 0.5);
      }
    }
}

TEST_CASE("fixed seeds: are where a curve bends", "[cut_surface][stage]") {
  // A fold along a zigzag, whose bends are 1 apart: edges of .9 or 1.1 would cut them off at most places.
  std::map<std::pair<uint32_t, uint32_t>, uint32_t> at;
  FeatureShape shape{"zigzag", {}, {}, 2, 2};
  shape.mesh = grid_mesh(
      12, 2, [](uint32_t, uint32_t) { return true; }, [](uint32_t, uint32_t j) { return j == 1 ? 1. : 0.; }, at);
  std::set<EdgeEnds> creases;
  for (uint32_t i = 0; i < 12; ++i) {
    creases.insert(ends(at[{i, 1}], at[{i + 1, 1}]));
    shape.mesh.vertices[at[{i, 1}]].y += i % 2 ? 0.15 : -0.15;
  }
  shape.network = network_of(shape.mesh, creases);
  for (const double edge : {0.9, 1.1}) {
    const CutSurface cut = cut_of(shape, {edge, 0});
    std::set<Place> seeds;
    for (const CutCurve& curve : cut.curves)
      for (const size_t i : curve.seeds)
        seeds.insert(place_of(cut.surface.position[cut.copies[size_t(cut.copies_first[curve.place[i]])]]));
    const LatticeFrame frame = frame_of(shape.mesh);
    int missed = 0;
    for (uint32_t i = 1; i < 12; ++i) {
      const WorldPoint p = shape.mesh.vertices[at[{i, 1}]];
      missed += !seeds.count(place_of(snap_point(frame, p)));
    }
    CHECK(missed == 0);
  }
}

TEST_CASE("fixed seeds: coarser levels have every second one, and corners", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape, {0.3, 0});
    std::vector<std::set<uint32_t>> places;
    for (const int level : {0, 1, 2}) {
      const SeedSet seeds = seeds_on_curves(cut, level);
      places.emplace_back();
      for (const uint32_t home : seeds.home) places.back().insert(cut.place[home]);
      for (uint32_t p = 0; p < cut.corner_count; ++p) CHECK(places.back().count(p) == 1);
      if (level == 0) continue;
      const auto& finer = places[size_t(level) - 1];
      CHECK(std::includes(finer.begin(), finer.end(), places.back().begin(), places.back().end()));
      CHECK(places.back().size() < 0.7 * double(finer.size()) + double(cut.corner_count));
    }
  }
}

TEST_CASE("fixed seeds: border vertices belong to the nearest along their side of the curve", "[cut_surface][stage]") {
  for (const FeatureShape& shape : feature_shapes()) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape);
    const SeedSet seeds = seeds_on_curves(cut, 0);
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
      const CutSurface cut = cut_of(shape, {edge, 0});
      const SeedSet seeds = seeds_of(cut, vertices, 5);
      CHECK(distinct_joined(seeds) + seeds.size() - seeds.fixed.count == vertices);
      std::map<uint32_t, int> in_patch;
      for (int64_t s = seeds.fixed.count; s < seeds.size(); ++s) {
        CHECK(cut.place[seeds.home[s]] == kNone);
        ++in_patch[cut.surface.patch[seeds.home[s]]];
      }
      if (shape.name == "cube")
        for (const auto& [patch, count] : in_patch) CHECK(std::abs(count - in_patch[0]) <= 1);
      const SeedSet other = seeds_of(cut, vertices, 6);
      CHECK(!std::equal(seeds.home.begin(), seeds.home.end(), other.home.begin()));
    }
}

TEST_CASE("free seeds: a finer level keeps those of the coarser one, and has as many as asked for",
          "[cut_surface][stage]") {
  Context context;
  for (const FeatureShape& shape : {feature_cube(), feature_cylinder(40), feature_plate()}) {
    INFO(shape.name);
    const CutSurface cut = cut_of(shape, {edge_length_for(shape.mesh, shape.network, 1000), 0});
    const FreeSeeds free(cut);
    SeedSet fine = seeds_on_curves(cut, 0), fixed = seeds_on_curves(cut, 1);
    const FreeSeeds::Counts counts = free.counts(fine, 1000), fewer = free.coarser(fixed, counts);
    for (size_t p = 0; p < counts.size(); ++p) CHECK(std::abs(4 * fewer[p] - counts[p]) < counts[p] / 2 + 8);
    SeedSet seeds = relax_on_sheet(cut.surface, free.add(std::move(fixed), fewer, 1), {20}, context).seeds;
    const Triangulation coarse = triangulate_dual(cut.surface, std::move(seeds), {}, context);
    REQUIRE(coarse.report.failed_cells == 0);
    const SeedSet finer = free.add_finer(std::move(fine), counts, coarse, 1);
    CHECK(distinct_joined(finer) + finer.size() - finer.fixed.count == 1000);
    std::set<uint32_t> homes(finer.home.begin() + finer.fixed.count, finer.home.end());
    int64_t lost = 0;
    for (int64_t s = coarse.seeds.fixed.count; s < coarse.seeds.size(); ++s) lost += !homes.count(coarse.seeds.home[s]);
    CHECK(lost == 0);
    CHECK(int64_t(homes.size()) > (finer.size() - finer.fixed.count) * 97 / 100);
  }
}
