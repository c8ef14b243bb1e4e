// Relaxed meshes in which some cells are the fine triangles that they were made from.
#include <algorithm>
#include <array>
#include <optional>

#include "core/copy_product.h"
#include "features/walls/fine_cells.h"
#include "features/walls/mesh_faults.h"
#include "features/walls/open_mesh.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/mesh_census.h"
#include "pipeline/defects/patch_defects.h"
#include "pipeline/patches/mend_patches.h"
#include "pipeline/patches/mesh_patches.h"
#include "pipeline/regions/region_walls.h"
#include "regions/label_volumes.h"
#include "regions/region_oracle.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// Walls whose patches are relaxed and put together.
struct RelaxedWalls {
  RelaxedWalls(const LabelVolume& volume, int64_t vertices, Context& context) {
    RemeshOptions options;
    options.vertices = vertices;
    Run run{context};
    p = prepare_regions(surface_of_labels(volume, "labels", 0), options, run);
    in_patches.seeds.count = p.cut->seeds;
    const SeedSet seeds = relax_in_patches(*p.cut, in_patches, context).seeds;
    SeededMesh first{{}, host_copy(seeds)};
    faults = mesh_patches(p, *p.cut, first, in_patches, run);
    if (faults.what.empty()) faults.optimized = {host_copy(seeds), {}, std::vector<char>(patch_count(*p.cut), 0)};
    with_cells = mesh_with_cells(p, *p.cut, faults.optimized, in_patches, optimized, run);
    mesh.emplace(*p.cut, with_cells.made, JoinOptions{p.cut->seeds});
  }
  FineCells cells() const {
    return {*p.cut, with_cells.made, *mesh, with_cells.dual, with_cells.cell, with_cells.is_optimized};
  }

  OptimizeReport optimized;
  PreparedSurface p;
  PatchOptions in_patches;
  PatchFaults faults;
  MeshWithCells with_cells;
  std::optional<PatchMesh> mesh;
};

using Corners = std::vector<std::array<uint32_t, 3>>;

Corners corners_of(const EditableMesh& mesh) {
  Corners out;
  for (const RegionTriangle& t : mesh.triangles()) {
    if (t.is_gone()) continue;
    out.push_back(t.corner);
    std::rotate(out.back().begin(), std::min_element(out.back().begin(), out.back().end()), out.back().end());
  }
  std::sort(out.begin(), out.end());
  return out;
}

std::string fault_of(const EditableMesh& mesh, const CutSurface& cut) {
  FaceRegions regions;
  const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(cut);
  Corners triangles;
  for (const RegionTriangle& t : mesh.triangles()) {
    triangles.push_back(t.corner);
    regions.labels.push_back(labels[t.patch]);
  }
  return fault_of_regions(triangles, regions);
}

std::vector<uint32_t> every(size_t step, size_t count) {
  std::vector<uint32_t> out;
  for (size_t i = 0; i < count; i += step) out.push_back(uint32_t(i));
  return out;
}

}  // namespace

TEST_CASE("a mesh without fine cells is the relaxed one, and one with all of them has all fine triangles") {
  TestContext context;
  const RelaxedWalls relaxed(voronoi_grains(32, 12), 1500, context);
  REQUIRE(relaxed.with_cells.faults.what.empty());
  FineCells cells = relaxed.cells();
  CHECK(corners_of(cells.mesh().mesh) == corners_of(*relaxed.mesh));
  cells.add(every(1, relaxed.mesh->vertices().size()));
  CHECK(cells.count() == int64_t(relaxed.mesh->vertices().size()));
  CHECK(cells.mesh().mesh.triangles().size() == relaxed.p.cut->fine->triangles.size());
}

TEST_CASE("regions are closed where some cells are fine and others relaxed, which stay where they are") {
  TestContext context;
  const RelaxedWalls relaxed(voronoi_grains(32, 12), 1500, context);
  const size_t count = relaxed.mesh->vertices().size();
  for (const size_t step : {count, size_t(700), size_t(60)}) {
    INFO("one cell of " << step << " and those beside it");
    FineCells cells = relaxed.cells();
    cells.add(every(step, count));
    CHECK(cells.count() < int64_t(count));
    const FineCells::Mesh made = cells.mesh();
    CHECK(find_mesh_faults(made.mesh).empty());
    const std::string fault = fault_of(made.mesh, *relaxed.p.cut);
    INFO(fault);
    CHECK(fault.empty());
    for (uint32_t v = 0; v < made.seed.size(); ++v)
      if (made.seed[v] != kNone) CHECK(made.mesh.at(v) == relaxed.mesh->at(made.seed[v]));
  }
}

TEST_CASE("patches that are joined, cut open along their curves and joined again are the same mesh") {
  TestContext context;
  for (const LabelVolume& volume : {voronoi_grains(32, 12), random_labels(38), random_labels(44)}) {
    const RelaxedWalls relaxed(volume, 1500, context);
    FineCells cells = relaxed.cells();
    cells.add(every(60, relaxed.mesh->vertices().size()));
    const FineCells::Mesh made = cells.mesh();
    if (!find_mesh_faults(made.mesh).empty()) continue;
    OpenMesh open(made.mesh, made.mesh.lookup());
    const SeededMesh opened = open.take();
    CHECK(opened.seeds.fixed.count > 0);
    CHECK(find_patch_defects(opened).empty());
    const EditableMesh again = open.joined_again(opened);
    CHECK(corners_of(again) == corners_of(made.mesh));
    CHECK(again.vertex_count() == made.mesh.vertex_count());
    const auto edges_on_curves = [](const EditableMesh& mesh) {
      int64_t count = 0;
      for (const RegionTriangle& t : mesh.triangles())
        for (const uint32_t curve : t.curve) count += !t.is_gone() && curve != kNone;
      return count;
    };
    CHECK(edges_on_curves(again) == edges_on_curves(made.mesh));
  }
}

TEST_CASE("ugly labels whose cells fail have regions that are closed and do not intersect once they are mended") {
  TestContext context;
  int mended = 0;
  for (uint32_t number = 0; number < 200; number += 4) {
    const LabelVolume volume = random_labels(number);
    if (pairs_of(volume).empty()) continue;
    INFO("random volume " << number);
    RelaxedWalls relaxed(volume, 300, context);
    Run run{context};
    const auto made = mend_patches(relaxed.p, *relaxed.p.cut, relaxed.faults, relaxed.in_patches, run);
    if (!made || run.warnings.empty()) continue;  // no cell had faults
    ++mended;
    const JoinedPatches& joined = made->joined;
    Corners triangles;
    for (const TriangleIndices& t : joined.mesh.triangles) triangles.push_back({t.a, t.b, t.c});
    FaceRegions regions;
    const std::vector<std::array<int32_t, 2>> labels = labels_of_patches(*relaxed.p.cut);
    for (const uint32_t patch : joined.features.patch) regions.labels.push_back(labels[patch]);
    const std::string fault = fault_of_regions(triangles, regions);
    INFO(fault);
    CHECK(fault.empty());
    CHECK(made->optimize.self_intersections == 0);
  }
  CHECK(mended > 20);
}

TEST_CASE("patches in which the dual leaves seeds as they are are taken as they were optimised") {
  TestContext context;
  const RelaxedWalls relaxed(random_labels(38), 500, context);
  REQUIRE(!relaxed.faults.what.empty());
  const OptimizedPatches& before = relaxed.faults.optimized;
  const SeededMesh& made = relaxed.with_cells.made;
  const std::vector<char>& is_optimized = relaxed.with_cells.is_optimized;
  const auto patch_of = [&](const SeededMesh& of, uint32_t v) {
    return relaxed.p.cut->surface.patch[of.seeds.home[v]];
  };
  const auto positions_of = [&](const SeededMesh& of) {  // per patch
    std::vector<std::vector<std::array<int32_t, 3>>> all(is_optimized.size());
    for (int64_t v = 0; v < of.seeds.size(); ++v) {
      const PointQ8& p = of.mesh.position[v];
      all[patch_of(of, uint32_t(v))].push_back({p.x, p.y, p.z});
    }
    return all;
  };
  const auto now = positions_of(made), then = positions_of(before.made);
  size_t taken = 0;
  for (size_t patch = 0; patch < now.size(); ++patch) taken += now[patch] == then[patch];
  CHECK(taken > now.size() / 2);
  CHECK(taken < now.size());
}

TEST_CASE("mended patches are the same with any number of threads") {
  CpuContext one, four;
  one.threads = 1;
  four.threads = 4;
  std::vector<Corners> made;
  std::vector<std::vector<std::array<int32_t, 3>>> positions;
  for (CpuContext* context : {&one, &four}) {
    RelaxedWalls relaxed(random_labels(38), 500, *context);
    REQUIRE(!relaxed.with_cells.faults.what.empty());
    Run run{*context};
    const auto mended = mend_patches(relaxed.p, *relaxed.p.cut, relaxed.faults, relaxed.in_patches, run);
    REQUIRE(mended);
    made.emplace_back();
    positions.emplace_back();
    for (const PointQ8& p : mended->joined.mesh.position) positions.back().push_back({p.x, p.y, p.z});
    for (const TriangleIndices& t : mended->joined.mesh.triangles) made.back().push_back({t.a, t.b, t.c});
  }
  CHECK(made[0] == made[1]);
  CHECK(positions[0] == positions[1]);
}

TEST_CASE("cells that cannot be relaxed are simplified alone, and a warning says how many") {
  TestContext context;
  const LabelVolume volume = random_labels(38);
  RemeshOptions options;
  options.vertices = 500;
  const RemeshResult result = remesh(surface_of_labels(volume, "labels", 0), options, context);
  const auto count_warnings = [&](const std::string& part) {
    return std::count_if(result.report.warnings.begin(), result.report.warnings.end(),
                         [&](const std::string& text) { return text.find(part) != std::string::npos; });
  };
  CHECK(count_warnings(" vertices edges were collapsed") == 1);
  CHECK(count_warnings("collapsed") == 1);
  CHECK(result.report.optimize.self_intersections == 0);
  CHECK(result.mesh.vertices.size() == 500);
  CHECK(fault_of_regions(result.mesh.triangles, result.mesh.regions).empty());
  CHECK(take_census(result.mesh, context).intersecting_pairs == 0);
}
