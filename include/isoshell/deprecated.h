// Names of 0.1 that changed, for one release.
#pragma once

#include <utility>

#include "isoshell/boolean_union.h"
#include "isoshell/repair.h"
#include "isoshell/stages.h"

namespace isoshell {

using PostOptions [[deprecated("OptimizeOptions")]] = OptimizeOptions;
using PostReport [[deprecated("OptimizeReport")]] = OptimizeReport;
using MendOptions [[deprecated("RepairOptions")]] = RepairOptions;
using MendReport [[deprecated("RepairReport")]] = RepairReport;
using UniteOptions [[deprecated("UnionOptions")]] = UnionOptions;
using UniteReport [[deprecated("UnionReport")]] = UnionReport;

[[deprecated("build_proxy")]] inline Sheet build_outline(const SiteSet& sites, const LatticeFrame& frame,
                                                         const SheetOptions& options, Context& context) {
  return build_proxy(sites, frame, options, context);
}
[[deprecated("repair_soup")]] inline TriangleSoup mend(const TriangleSoup& soup, const RepairOptions& options,
                                                       RepairReport& report) {
  return repair_soup(soup, options, report);
}
[[deprecated("boolean_union")]] inline TriangleSoup unite(const TriangleSoup& soup, const UnionOptions& options,
                                                          UnionReport& report, const Context& context) {
  return boolean_union(soup, options, report, context);
}

// Stages that changed their arguments: they take what they change by moving now, and return it.
[[deprecated("use the box that bounding_box returns")]] inline void bounding_box(const TriangleSoup& soup,
                                                                                 WorldPoint& box_min,
                                                                                 WorldPoint& box_max) {
  const WorldBox box = bounding_box(soup);
  box_min = box.min;
  box_max = box.max;
}
[[deprecated("use the dirt that measure_topology returns")]] inline InputTopology measure_topology(
    const TriangleSoup& soup, DirtCounts& dirt, Context& context) {
  TriangleSoup counted = soup;
  counted.dirt = dirt;
  const SoupTopology measured = measure_topology(counted, context);
  dirt = measured.dirt;
  return measured.topology;
}

[[deprecated("use the lengths that limit_edge_lengths returns")]] inline void set_edge_lengths(SurfaceMesh& surface,
                                                                                               Buffer<uint32_t> raw,
                                                                                               int64_t slope_q16,
                                                                                               Context& context) {
  surface.lengths = limit_edge_lengths(surface, std::move(raw), slope_q16, context);
}
[[deprecated("use the lengths that smooth_edge_lengths returns")]] inline void smooth_edge_lengths(SurfaceMesh& surface,
                                                                                                   int32_t rounds,
                                                                                                   Context& context) {
  surface.lengths = smooth_edge_lengths(surface, std::move(surface.lengths), rounds, context);
}
[[deprecated("use the lengths that transfer_edge_lengths returns")]] inline void copy_edge_lengths(
    const SurfaceMesh& from, int halvings, SurfaceMesh& to, Context& context) {
  to.lengths = transfer_edge_lengths(from, halvings, to, context);
}
[[deprecated("use the seeds that relax_on_sheet returns")]] inline RelaxReport relax_on_sheet(
    const SurfaceMesh& surface, SeedSet& seeds, const RelaxOptions& options, Context& context) {
  RelaxedSeeds relaxed = relax_on_sheet(surface, std::move(seeds), options, context);
  seeds = std::move(relaxed.seeds);
  return std::move(relaxed.report);
}
[[deprecated("use the seeds that relax_in_shell returns")]] inline RelaxReport relax_in_shell(
    const Shell& shell, const SiteSet& sites, const SiteSamples& samples, SeedSet& seeds, const RelaxOptions& options,
    Context& context) {
  RelaxedSeeds relaxed = relax_in_shell(shell, sites, samples, std::move(seeds), options, context);
  seeds = std::move(relaxed.seeds);
  return std::move(relaxed.report);
}
[[deprecated("use the seeds that attach_to_sheet returns")]] inline void attach_to_sheet(const SurfaceMesh& surface,
                                                                                         SeedSet& seeds,
                                                                                         Context& context,
                                                                                         int halvings = 0) {
  seeds = attach_to_sheet(surface, std::move(seeds), halvings, context);
}
[[deprecated("use the mesh and the seeds that triangulate_dual returns")]] inline DualMesh triangulate_dual(
    const SurfaceMesh& surface, SeedSet& seeds, const DualOptions& options, DualReport& report, Context& context) {
  Triangulation made = triangulate_dual(surface, std::move(seeds), options, context);
  seeds = std::move(made.seeds);
  report.inserted_seeds += made.report.inserted_seeds;
  report.relabelled_vertices += made.report.relabelled_vertices;
  report.repair_rounds += made.report.repair_rounds;
  report.failed_cells = made.report.failed_cells;
  return std::move(made.mesh);
}
namespace deprecated_forms {

/// A caller's mesh and seeds while a stage has them. They come back whether it returned or threw.
struct Lent {
  DualMesh& mesh;
  SeedSet& seeds;
  SeededMesh both{std::move(mesh), std::move(seeds)};
  ~Lent() {
    mesh = std::move(both.mesh);
    seeds = std::move(both.seeds);
  }
};

inline OptimizeReport optimize(const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds,
                               DualMesh& mesh, Context& context) {
  Lent lent{mesh, seeds};
  OptimizedMesh optimized = optimize_mesh(surface, std::move(lent.both), options, context);
  const OptimizeReport report = optimized.report;
  lent.both = std::move(optimized);
  return report;
}

}  // namespace deprecated_forms

[[deprecated("use the mesh and the seeds that collapse_edges returns")]] inline void collapse_edges(
    const SurfaceMesh& surface, int64_t target, SeedSet& seeds, DualMesh& mesh, Context& context,
    bool keep_apart = false) {
  deprecated_forms::Lent lent{mesh, seeds};
  lent.both = collapse_edges(surface, std::move(lent.both), {target, keep_apart}, context);
}
[[deprecated("use the sheet and the seeds that untangle_sheet returns")]] inline int64_t untangle_sheet(
    Sheet& sheet, SeedSet& seeds, Context& context) {
  UntangledSheet untangled = untangle_sheet(std::move(sheet), std::move(seeds), context);
  sheet = std::move(untangled.sheet);
  seeds = std::move(untangled.seeds);
  return untangled.self_intersections;
}
[[deprecated("use the mesh and the seeds that optimize_mesh returns")]] inline OptimizeReport optimize_mesh(
    const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds, DualMesh& mesh, Context& context) {
  return deprecated_forms::optimize(surface, options, seeds, mesh, context);
}
[[deprecated("optimize_mesh")]] inline OptimizeReport improve_mesh(const SurfaceMesh& surface,
                                                                   const OptimizeOptions& options, SeedSet& seeds,
                                                                   DualMesh& mesh, Context& context) {
  return deprecated_forms::optimize(surface, options, seeds, mesh, context);
}

}  // namespace isoshell
