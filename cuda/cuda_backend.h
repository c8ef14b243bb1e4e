// What the CUDA backend provides; one file cuda_<stage>.cu instantiates or replaces each body.
#pragma once

#include "stages/backend_table.h"

namespace isoshell {

InputTopology cuda_measure_topology(const TriangleSoup& soup, DirtCounts& dirt, Context& context);
LatticeSurface cuda_snap_surface(const TriangleSoup& soup, const LatticeFrame& frame, Context& context);
SiteSet cuda_voxelize(const LatticeSurface&, Context&);
SiteSamples cuda_sample_sites(const LatticeSurface&, const SiteSet&, Context&);
Shell cuda_build_shell(const SiteSet&, const ShellOptions&, Context&);
Buffer<std::byte> cuda_nano_index_grid(const VoxelSet&, const LatticeFrame&, const char*, Context&);
Sheet cuda_build_sheet(const LatticeSurface&, const SiteSet& walls, const SiteSet&, const SiteSamples&,
                       const SheetOptions&, Context&);
SeedSet cuda_place_seeds_on_sheet(const Sheet&, const SeedOptions&, Context&);
SeedSet cuda_place_seeds_on_sites(const SiteSet&, const SiteSamples&, const SeedOptions&, Context&);
SiteSet cuda_coarsen_sites(const SiteSet&, Context&);
Sheet cuda_build_outline(const SiteSet&, const LatticeFrame&, const SheetOptions&, Context&);
void cuda_set_edge_lengths(Sheet&, Buffer<uint32_t> raw, int64_t slope_q16, Context&);
void cuda_smooth_edge_lengths(Sheet&, int32_t rounds, Context&);
int64_t cuda_seed_shares(const Sheet&, Context&);
void cuda_copy_edge_lengths(const Sheet& from, int halvings, Sheet& to, Context&);
Buffer<uint32_t> cuda_measure_curvature(const Sheet&, int32_t rounds, Context&);
RelaxReport cuda_relax_on_sheet(const Sheet&, SeedSet&, const RelaxOptions&, Context&);
RelaxReport cuda_relax_in_shell(const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&,
                                Context&);
void cuda_attach_to_sheet(const Sheet&, SeedSet&, int, Context&);
VoronoiLabels cuda_flood_shell(const Shell&, const SeedSet&, Context&);
DualMesh cuda_triangulate_dual(const Sheet&, SeedSet&, const DualOptions&, DualReport&, Context&);
SeedSet cuda_subdivide_seeds(const Sheet&, const DualMesh&, const SeedSet&, int64_t, Context&);
int64_t cuda_six_volume_vox(const Sheet&, Context&);
void cuda_collapse_edges(const Sheet&, int64_t, SeedSet&, DualMesh&, Context&, bool keep_apart);
int64_t cuda_untangle_sheet(Sheet&, SeedSet&, Context&);
PostReport cuda_improve_mesh(const Sheet&, const PostOptions&, SeedSet&, DualMesh&, Context&);

/// The stage, for a body that needs a shell on its way.
class CudaExecutor;
struct CudaBuildShell {
  static Shell run(CudaExecutor&, const SiteSet&, const ShellOptions&);
};

}  // namespace isoshell
