// What the CPU backend provides; one file cpu_<stage>.cpp instantiates each body.
#pragma once

#include "cpu/executor_tbb.h"
#include "stages/backend_table.h"

namespace isoshell {

InputTopology cpu_measure_topology(const TriangleSoup&, DirtCounts&, Context&);
LatticeSurface cpu_snap_surface(const TriangleSoup&, const LatticeFrame&, Context&);
SiteSet cpu_voxelize(const LatticeSurface&, Context&);
SiteSamples cpu_sample_sites(const LatticeSurface&, const SiteSet&, Context&);
Shell cpu_build_shell(const SiteSet&, const ShellOptions&, Context&);
Buffer<std::byte> cpu_nano_index_grid(const VoxelSet&, const LatticeFrame&, const char*, Context&);
Sheet cpu_build_sheet(const LatticeSurface&, const SiteSet& walls, const SiteSet&, const SiteSamples&,
                      const SheetOptions&, Context&);
SiteSet cpu_cut_false_handles(const SiteSet&, const SiteSamples&, int64_t genus, Context&);
SiteSet cpu_coarsen_sites(const SiteSet&, Context&);
Sheet cpu_build_outline(const SiteSet&, const LatticeFrame&, const SheetOptions&, Context&);
void cpu_set_edge_lengths(Sheet&, Buffer<uint32_t> raw, int64_t slope_q16, Context&);
void cpu_smooth_edge_lengths(Sheet&, int32_t rounds, Context&);
int64_t cpu_seed_shares(const Sheet&, Context&);
void cpu_copy_edge_lengths(const Sheet& from, int halvings, Sheet& to, Context&);
Buffer<uint32_t> cpu_measure_curvature(const Sheet&, int32_t rounds, Context&);
RelaxReport cpu_relax_on_sheet(const Sheet&, SeedSet&, const RelaxOptions&, Context&);
RelaxReport cpu_relax_in_shell(const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&,
                               Context&);
void cpu_attach_to_sheet(const Sheet&, SeedSet&, int, Context&);
VoronoiLabels cpu_flood_shell(const Shell&, const SeedSet&, Context&);
DualMesh cpu_triangulate_dual(const Sheet&, SeedSet&, const DualOptions&, DualReport&, Context&);
SeedSet cpu_subdivide_seeds(const Sheet&, const DualMesh&, const SeedSet&, int64_t, Context&);
PostReport cpu_improve_mesh(const Sheet&, const PostOptions&, SeedSet&, DualMesh&, Context&);
int64_t cpu_six_volume_vox(const Sheet&, Context&);
void cpu_collapse_edges(const Sheet&, int64_t, SeedSet&, DualMesh&, Context&, bool keep_apart);
int64_t cpu_untangle_sheet(Sheet&, SeedSet&, Context&);
SeedSet cpu_place_seeds_on_sheet(const Sheet&, const SeedOptions&, Context&);
SeedSet cpu_place_seeds_on_sites(const SiteSet&, const SiteSamples&, const SeedOptions&, Context&);

/// The stage, for a body that needs a shell on its way.
struct CpuBuildShell {
  static Shell run(CpuExecutor& exec, const SiteSet& sites, const ShellOptions& options) {
    return cpu_build_shell(sites, options, exec.context());
  }
};

}  // namespace isoshell
