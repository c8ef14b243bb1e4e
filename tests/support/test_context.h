// The context of tests that run on every backend: on the CPU, or with --cuda on the device. A stage that is called with
// it gives its products back in host memory, where tests look at them. Inputs go to the device the same way in the
// library itself: every stage takes what lies in host memory. Products that a stage changes keep their names here.
#pragma once

#include <utility>

#include "isoshell/advanced/stages.h"
#include "isoshell/advanced/to_host.h"
#include "isoshell/backend.h"

namespace isoshell {

/// Where the tests of this process run. Set once, by main.
inline Backend& test_backend() {
  static Backend backend = Backend::cpu;
  return backend;
}

struct TestContext : Context {
  TestContext() { backend = test_backend(); }
  Context& plain() { return *this; }
};

/// The context of tests that need no device, wherever the others run.
struct CpuContext : Context {
  CpuContext() { backend = Backend::cpu; }
};

inline LatticeSurface snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, TestContext& context) {
  return to_host(snap_surface(soup, frame, context.plain()));
}
inline SiteSet voxelize(const LatticeSurface& surface, TestContext& context) {
  return to_host(voxelize(surface, context.plain()));
}
inline SiteSamples sample_sites(const LatticeSurface& surface, const SiteSet& sites, TestContext& context) {
  return to_host(sample_sites(surface, sites, context.plain()));
}
inline Shell build_shell(const SiteSet& sites, const ShellOptions& options, TestContext& context) {
  return to_host(build_shell(sites, options, context.plain()));
}
inline Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, const SiteSamples& samples,
                         const SheetOptions& options, TestContext& context) {
  return to_host(build_sheet(surface, sites, samples, options, context.plain()));
}
inline Sheet build_sheet(const LatticeSurface& surface, const SiteSet& sites, SiteSamples&& samples,
                         const SheetOptions& options, TestContext& context) {
  return to_host(build_sheet(surface, sites, std::move(samples), options, context.plain()));
}
inline SiteSet coarsen_sites(const SiteSet& sites, TestContext& context) {
  return to_host(coarsen_sites(sites, context.plain()));
}
inline Sheet build_proxy(const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options,
                         TestContext& context) {
  return to_host(build_proxy(sites, frame, options, context.plain()));
}
inline SeedSet place_seeds(const SurfaceMesh& surface, const SeedOptions& options, TestContext& context) {
  return to_host(place_seeds(surface, options, context.plain()));
}
inline SeedSet place_seeds(const Sheet& sheet, const SeedOptions& options, TestContext& context) {
  return to_host(place_seeds(sheet, options, context.plain()));
}
inline SeedSet place_seeds(const SiteSet& sites, const SiteSamples& samples, const SeedOptions& options,
                           TestContext& context) {
  return to_host(place_seeds(sites, samples, options, context.plain()));
}
inline RelaxReport relax_on_sheet(const SurfaceMesh& surface, SeedSet& seeds, const RelaxOptions& options,
                                  TestContext& context) {
  const RelaxedSeeds relaxed = relax_on_sheet(surface, std::move(seeds), options, context.plain());
  seeds = to_host(relaxed.seeds);
  return relaxed.report;
}
inline RelaxReport relax_in_shell(const Shell& shell, const SiteSet& sites, const SiteSamples& samples, SeedSet& seeds,
                                  const RelaxOptions& options, TestContext& context) {
  const RelaxedSeeds relaxed = relax_in_shell(shell, sites, samples, std::move(seeds), options, context.plain());
  seeds = to_host(relaxed.seeds);
  return relaxed.report;
}
inline void attach_to_sheet(const SurfaceMesh& surface, SeedSet& seeds, TestContext& context, int halvings = 0) {
  seeds = to_host(attach_to_sheet(surface, std::move(seeds), halvings, context.plain()));
}
inline VoronoiLabels flood_shell(const Shell& shell, const SeedSet& seeds, TestContext& context) {
  return to_host(flood_shell(shell, seeds, context.plain()));
}
inline DualMesh triangulate_dual(const SurfaceMesh& surface, SeedSet& seeds, const DualOptions& options,
                                 DualReport& report, TestContext& context) {
  const Triangulation made = triangulate_dual(surface, std::move(seeds), options, context.plain());
  seeds = to_host(made.seeds);
  report = made.report;
  return to_host(made.mesh);
}
inline SeedSet subdivide_seeds(const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds, int64_t target,
                               TestContext& context) {
  return to_host(subdivide_seeds(surface, mesh, seeds, target, context.plain()));
}
inline void collapse_edges(const SurfaceMesh& surface, int64_t target, SeedSet& seeds, DualMesh& mesh,
                           TestContext& context) {
  const SeededMesh left = collapse_edges(surface, {std::move(mesh), std::move(seeds)}, {target}, context.plain());
  seeds = to_host(left.seeds);
  mesh = to_host(left.mesh);
}
inline OptimizeReport optimize_mesh(const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds,
                                    DualMesh& mesh, TestContext& context) {
  const OptimizedMesh optimized = optimize_mesh(surface, {std::move(mesh), std::move(seeds)}, options, context.plain());
  seeds = to_host(optimized.seeds);
  mesh = to_host(optimized.mesh);
  return optimized.report;
}

}  // namespace isoshell
