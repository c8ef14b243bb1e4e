// What the CPU backend provides; one file cpu_<stage>.cpp instantiates each body.
#pragma once

#include "stages/backend_table.h"

namespace isoshell {

class CpuBackend final : public BackendTable {
 public:
  const char* name() const override;  // the first one that is not inline, so the table lies beside it
  InputTopology measure_topology(const TriangleSoup&, DirtCounts&, Context&) const override;
  LatticeSurface snap_surface(const TriangleSoup&, const LatticeFrame&, Context&) const override;
  MadeSurface make_surface_mesh(const SurfaceTriangles&, Context&) const override;
  SiteSet voxelize(const LatticeSurface&, Context&) const override;
  SiteSamples sample_sites(const LatticeSurface&, const SiteSet&, Context&) const override;
  Shell build_shell(const SiteSet&, const ShellOptions&, Context&) const override;
  LevelSetSurface level_set_surface(const LatticeSurface&, const TriangleSoup* exact, const Sheet&, SheetPart,
                                    Context&) const override;
  LevelSet build_level_set(const LevelSetSurface&, const SiteSet&, const Sheet&, const LevelSetOptions&,
                           Context&) const override;
  Buffer<std::byte> nano_index_grid(const VoxelSet&, const LatticeFrame&, const char*, Context&) const override;
  Sheet build_sheet(const LatticeSurface&, const SiteSet& solid_voxels, const SiteSet&, const SiteSamples&,
                    SiteSamples* spent, const SheetOptions&, Context&) const override;
  SiteSet cut_false_handles(const SiteSet&, const SiteSamples&, int64_t genus, Context&) const override;
  SiteSet coarsen_sites(const SiteSet&, Context&) const override;
  Sheet build_proxy(const SiteSet&, const LatticeFrame&, const SheetOptions&, Context&) const override;
  EdgeLengths limit_edge_lengths(const SurfaceMesh&, Buffer<uint32_t> raw, int64_t slope_q16, Context&) const override;
  EdgeLengths smooth_edge_lengths(const SurfaceMesh&, const EdgeLengths&, int32_t rounds, Context&) const override;
  int64_t seed_shares(const SurfaceMesh&, Context&) const override;
  EdgeLengths transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to,
                                    Context&) const override;
  Buffer<uint32_t> measure_curvature(const SurfaceMesh&, int32_t rounds, Context&) const override;
  SeedSet place_seeds_on_surface(const SurfaceMesh&, const SeedOptions&, Context&) const override;
  SeedSet place_seeds_on_sites(const SiteSet&, const SiteSamples&, const SeedOptions&, Context&) const override;
  RelaxReport relax_on_sheet(const SurfaceMesh&, SeedSet&, const RelaxOptions&, Context&) const override;
  RelaxReport relax_in_shell(const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&,
                             Context&) const override;
  void attach_to_sheet(const SurfaceMesh&, SeedSet&, int, Context&) const override;
  VoronoiLabels flood_shell(const Shell&, const SeedSet&, Context&) const override;
  Triangulation triangulate_dual(const SurfaceMesh&, SeedSet&&, const DualOptions&, Context&) const override;
  SeedSet subdivide_seeds(const SurfaceMesh&, const DualMesh&, const SeedSet&, int64_t, Context&) const override;
  OptimizeReport optimize_mesh(const SurfaceMesh&, const OptimizeOptions&, SeedSet&, DualMesh&,
                               Context&) const override;
  int64_t six_volume_vox(const SurfaceMesh&, Context&) const override;
  void collapse_edges(const SurfaceMesh&, const CollapseOptions&, SeedSet&, DualMesh&, Context&) const override;
  int64_t untangle_sheet(Sheet&, SeedSet&, Context&) const override;
  DistanceSums sum_distances(const TriangleMesh& from, const std::vector<double>& area_until,
                             const TriangleGridView& to, const DistancePlaces&, Context&) const override;
  void finish_stages(Context&) const override {}
};

/// The stage, for a body that needs a shell on its way.
struct CpuBuildShell {
  template <class Exec>
  static Shell run(Exec& exec, const SiteSet& sites, const ShellOptions& options) {
    return CpuBackend().build_shell(sites, options, exec.context());
  }
};

}  // namespace isoshell
