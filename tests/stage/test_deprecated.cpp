// Stages in the form that they had in 0.1, which changed their arguments: they give what the stages return now.
#pragma GCC diagnostic ignored "-Wdeprecated-declarations"

#include "isoshell/digest.h"
#include "isoshell/error.h"
#include "support/catch.h"
#include "support/relax_sheets.h"
#include "support/test_context.h"

using namespace isoshell;

TEST_CASE("deprecated: a mesh made by stages that change their arguments is that of stages that return it", "[stage]") {
  TestContext test_context;
  Context& context = test_context.plain();
  const Sheet sheet = torus_sheet();

  SeedSet seeds = place_seeds(sheet, {300, 1}, context);
  const RelaxReport relaxed = relax_on_sheet(sheet, seeds, {10, 0, 0}, context);
  attach_to_sheet(sheet, seeds, context);
  DualReport found;
  DualMesh mesh = triangulate_dual(sheet, seeds, {}, found, context);
  collapse_edges(sheet, 280, seeds, mesh, context);
  const OptimizeReport optimized = optimize_mesh(sheet, {}, seeds, mesh, context);

  RelaxedSeeds now = relax_on_sheet(sheet, place_seeds(sheet, {300, 1}, context), {10, 0, 0}, context);
  CHECK(relaxed.energy == now.report.energy);
  Triangulation dual = triangulate_dual(sheet, attach_to_sheet(sheet, std::move(now.seeds), 0, context), {}, context);
  CHECK(found.failed_cells == dual.report.failed_cells);
  const OptimizedMesh made = optimize_mesh(sheet, collapse_edges(sheet, std::move(dual), {280}, context), {}, context);
  CHECK(optimized.flips == made.report.flips);
  CHECK(digest(seeds) == digest(made.seeds));
  CHECK(digest(to_world(to_host(mesh), sheet.frame)) == digest(to_world(to_host(made.mesh), sheet.frame)));
}

TEST_CASE("deprecated: lengths, the box and the topology of a soup come out as they do now", "[stage]") {
  TestContext test_context;
  Context& context = test_context.plain();
  Sheet sheet = torus_sheet();
  Buffer<uint32_t> raw(sheet.vertex_count());
  for (int64_t v = 0; v < raw.size(); ++v) raw[v] = uint32_t(200 + v % 97);
  const EdgeLengths limited = limit_edge_lengths(sheet, raw.to_host(), 1000, context);
  set_edge_lengths(sheet, raw.to_host(), 1000, context);
  CHECK(sheet.lengths.least == limited.least);
  CHECK(sheet.lengths.largest == limited.largest);
  Sheet proxy = torus_sheet();
  copy_edge_lengths(sheet, 0, proxy, context);
  CHECK(proxy.lengths.largest == limited.largest);
  smooth_edge_lengths(sheet, 2, context);
  CHECK(sheet.lengths.largest <= limited.largest);

  const TriangleSoup soup = shapes::together(shapes::box({0, 0, 0}, {1, 2, 3}), shapes::box({0, 0, 0}, {1, 2, 3}));
  WorldPoint lo, hi;
  bounding_box(soup, lo, hi);
  CHECK(hi.z == bounding_box(soup).max.z);
  DirtCounts dirt;
  dirt.short_faces = 5;
  CHECK(measure_topology(soup, dirt, context).components == measure_topology(soup, context).topology.components);
  CHECK(dirt.short_faces == 5);
  CHECK(dirt.duplicate_faces == measure_topology(soup, context).dirt.duplicate_faces);
}

TEST_CASE("deprecated: mesh and seeds are the caller's again when a stage throws", "[stage]") {
  TestContext test_context;
  Context& context = test_context.plain();
  const Sheet sheet = torus_sheet();
  Triangulation dual = triangulate_dual(sheet, place_seeds(sheet, {300, 1}, context), {}, context);
  const int64_t triangles = dual.mesh.triangles.size();
  context.cancel = true;
  CHECK_THROWS_AS(collapse_edges(sheet, 280, dual.seeds, dual.mesh, context), Error);
  CHECK_THROWS_AS(optimize_mesh(sheet, {}, dual.seeds, dual.mesh, context), Error);
  CHECK(dual.seeds.size() == 300);
  CHECK(dual.mesh.triangles.size() == triangles);
}
