// What the device's kernels keep in lists of fixed size, made to overflow: the exact slow paths give the same.
#include <cstring>

#include "golden/golden_cases.h"
#include "parity/product_hash.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/site_shapes.h"

using namespace isoshell;
using namespace isoshell::parity;

namespace {

struct BothContexts {
  Context cpu, cuda;
  BothContexts() {
    cpu.backend = Backend::cpu;
    cuda.backend = Backend::cuda;
  }
};

Sheet sheet_of(const LatticeSurface& surface, int32_t closing_vox, Context& context) {
  const SiteSet sites = voxelize(surface, context);
  return build_sheet(surface, sites, sample_sites(surface, sites, context), {closing_vox, 0}, context);
}

/// A closed box full of shelves, each open at one end in turn, with a hole in the lid: the outside winds through.
TriangleSoup winding(int shelves) {
  TriangleSoup out;
  const auto wall = [&](WorldPoint lo, WorldPoint hi) { out = shapes::together(out, shapes::box(lo, hi)); };
  const double length = 20, height = 2.0 * (shelves + 1), thick = 0.2;
  wall({0, 0, 0}, {length, length, thick});
  wall({0, 0, 0}, {thick, length, height});
  wall({length - thick, 0, 0}, {length, length, height});
  wall({0, 0, 0}, {length, thick, height});
  wall({0, length - thick, 0}, {length, length, height});
  for (int s = 1; s <= shelves; ++s)
    wall({s % 2 ? 2.0 : 0.0, 0, 2.0 * s}, {s % 2 ? length : length - 2.0, length, 2.0 * s + thick});
  wall({2, 0, height}, {length, length, height + thick});
  out.faces_in_file = int64_t(out.triangles.size());
  return out;
}

}  // namespace

TEST_CASE("limits: an outside that winds through many rounds", "[parity][cuda]") {
  BothContexts on;
  const LatticeSurface surface = shapes::snapped(winding(7), 190, on.cpu);
  for (const int32_t closing : {0, 2})
    CHECK(hash_arrays(sheet_of(surface, closing, on.cuda)) == hash_arrays(sheet_of(surface, closing, on.cpu)));
}

TEST_CASE("limits: a leaf that more triangles meet than its list holds", "[parity][cuda]") {
  BothContexts on;
  const TriangleSoup crowd =
      shapes::together(shapes::box({0, 0, 0}, {40, 40, 40}), shapes::random_soup(3000, 2, .5, 7));
  const LatticeSurface surface = shapes::snapped(crowd, 60, on.cpu);
  const auto samples = [&](Context& context) { return sample_sites(surface, voxelize(surface, context), context); };
  CHECK(hash_arrays(samples(on.cuda)) == hash_arrays(samples(on.cpu)));
}

TEST_CASE("limits: more seeds at one place than a leaf's list holds", "[parity][cuda]") {
  BothContexts on;
  const Sheet sheet = sheet_of(shapes::snapped(shapes::sphere({0, 0, 0}, 1, 64), 70, on.cpu), 0, on.cpu);
  const auto crowded = [&] {
    SeedSet seeds = place_seeds(sheet, {700, 3}, on.cpu);
    for (int64_t i = 0; i < 600; ++i) {  // around one vertex, some at the same position
      const uint32_t home = uint32_t(i % 37);
      seeds.position[i] = sheet.position[home];
      seeds.normal[i] = sheet.normal[home];
      seeds.home[i] = home;
    }
    return seeds;
  };
  const auto dual = [&](Context& context) {
    const Triangulation made = triangulate_dual(sheet, crowded(), {}, context);
    return std::vector<uint64_t>{hash_arrays(made.mesh), hash_arrays(made.seeds), uint64_t(made.report.inserted_seeds),
                                 uint64_t(made.report.repair_rounds), uint64_t(made.report.failed_cells)};
  };
  CHECK(dual(on.cuda) == dual(on.cpu));
}

TEST_CASE("limits: cells of many vertices split in the same halves", "[parity][cuda]") {
  BothContexts on;
  const Sheet sheet = sheet_of(shapes::snapped(shapes::torus(2, .7, 60, 30), 120, on.cpu), 0, on.cpu);
  for (const int64_t count : {4, 9, 23}) {  // too few for disks: the repair splits cells of thousands of vertices
    const auto dual = [&](Context& context) {
      const Triangulation made = triangulate_dual(sheet, place_seeds(sheet, {count, 1}, context), {}, context);
      return std::vector<uint64_t>{hash_arrays(made.mesh), hash_arrays(made.seeds),
                                   uint64_t(made.report.inserted_seeds), uint64_t(made.report.repair_rounds)};
    };
    CHECK(dual(on.cuda) == dual(on.cpu));
  }
}

TEST_CASE("limits: what the recipe asks of whole products", "[parity][cuda]") {
  BothContexts on;
  const Sheet sheet = sheet_of(shapes::snapped(shapes::torus(2, .7, 60, 30), 90, on.cpu), 0, on.cpu);
  CHECK(six_volume_vox(sheet, on.cuda) == six_volume_vox(sheet, on.cpu));
  const auto fewer = [&](Context& context) {
    Triangulation made = triangulate_dual(sheet, place_seeds(sheet, {400, 1}, context), {}, context);
    const SeedSet seeds = collapse_edges(sheet, std::move(made), {375}, context).seeds;
    return std::vector<uint64_t>{uint64_t(seeds.size()), hash_arrays(seeds)};
  };
  CHECK(fewer(on.cuda) == fewer(on.cpu));
}

TEST_CASE("limits: topology and snapping of soups of every kind", "[parity][cuda]") {
  BothContexts on;
  std::vector<shapes::NamedSoup> soups = shapes::ugly_soups();
  soups.push_back({"winding", winding(5)});
  soups.push_back({"confetti", shapes::random_soup(5000, 4, .05, 2)});
  soups.push_back({"torus", shapes::torus(2, .7, 120, 60)});
  for (const shapes::NamedSoup& shape : soups) {
    CAPTURE(shape.name);
    const auto measured = [&](Context& context) {
      const auto [t, dirt] = measure_topology(shape.soup, context);
      uint64_t area;
      std::memcpy(&area, &t.area_world, sizeof area);
      return std::vector<uint64_t>{t.closed,
                                   t.oriented,
                                   uint64_t(t.components),
                                   uint64_t(t.boundary_loops),
                                   uint64_t(t.euler),
                                   uint64_t(t.genus),
                                   area,
                                   uint64_t(dirt.degenerate_faces),
                                   uint64_t(dirt.duplicate_faces),
                                   uint64_t(dirt.nonmanifold_edges),
                                   uint64_t(dirt.inconsistent_edges)};
    };
    CHECK(measured(on.cuda) == measured(on.cpu));
    CHECK(hash_arrays(shapes::snapped(shape.soup, 77, on.cuda)) ==
          hash_arrays(shapes::snapped(shape.soup, 77, on.cpu)));
  }
}
