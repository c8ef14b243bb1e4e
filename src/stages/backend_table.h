// The seam between backends: the few functions each one provides. Everything else in src/ is written once.
#pragma once

#include "isoshell/stages.h"

namespace isoshell {

/// Same inputs, same definition, same bytes, whichever backend fills it. See stages.h for what each function computes.
struct BackendTable {
  const char* name;
  InputTopology (*measure_topology)(const TriangleSoup&, DirtCounts&, Context&);
  LatticeSurface (*snap_surface)(const TriangleSoup&, const LatticeFrame&, Context&);
  SiteSet (*voxelize)(const LatticeSurface&, Context&);
  SiteSamples (*sample_sites)(const LatticeSurface&, const SiteSet&, Context&);
  Shell (*build_shell)(const SiteSet&, const ShellOptions&, Context&);
  Buffer<std::byte> (*nano_index_grid)(const VoxelSet&, const LatticeFrame&, const char*, Context&);
  /// From the sheet of all `walls`, which are the sites or what cut_false_handles makes of them.
  Sheet (*build_sheet)(const LatticeSurface&, const SiteSet& walls, const SiteSet&, const SiteSamples&,
                       const SheetOptions&, Context&);
  /// Result: the sites less those that close handles beyond `genus`, with the solid voxels around these. Empty when
  /// the box around the sites is too large.
  SiteSet (*cut_false_handles)(const SiteSet&, const SiteSamples&, int64_t genus, Context&);
  SiteSet (*coarsen_sites)(const SiteSet&, Context&);
  Sheet (*build_outline)(const SiteSet&, const LatticeFrame&, const SheetOptions&, Context&);
  void (*set_edge_lengths)(Sheet&, Buffer<uint32_t> raw, int64_t slope_q16, Context&);
  void (*smooth_edge_lengths)(Sheet&, int32_t rounds, Context&);
  int64_t (*seed_shares)(const Sheet&, Context&);
  void (*copy_edge_lengths)(const Sheet& from, int halvings, Sheet& to, Context&);
  Buffer<uint32_t> (*measure_curvature)(const Sheet&, int32_t rounds, Context&);
  SeedSet (*place_seeds_on_sheet)(const Sheet&, const SeedOptions&, Context&);
  SeedSet (*place_seeds_on_sites)(const SiteSet&, const SiteSamples&, const SeedOptions&, Context&);
  RelaxReport (*relax_on_sheet)(const Sheet&, SeedSet&, const RelaxOptions&, Context&);
  RelaxReport (*relax_in_shell)(const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&,
                                Context&);
  void (*attach_to_sheet)(const Sheet&, SeedSet&, int, Context&);
  VoronoiLabels (*flood_shell)(const Shell&, const SeedSet&, Context&);
  DualMesh (*triangulate_dual)(const Sheet&, SeedSet&, const DualOptions&, DualReport&, Context&);
  SeedSet (*subdivide_seeds)(const Sheet&, const DualMesh&, const SeedSet&, int64_t, Context&);
  PostReport (*improve_mesh)(const Sheet&, const PostOptions&, SeedSet&, DualMesh&, Context&);
  int64_t (*six_volume_vox)(const Sheet&, Context&);
  void (*collapse_edges)(const Sheet&, int64_t, SeedSet&, DualMesh&, Context&, bool keep_apart);
  int64_t (*untangle_sheet)(Sheet&, SeedSet&, Context&);
  void (*finish_stages)(Context&);
};

/// Always there.
const BackendTable& cpu_backend();
/// Null when CUDA was not built in. See cuda_device.h.
const BackendTable* cuda_backend();
/// The table the context asks for. Throws Error{no_device} when it asks for CUDA and there is none.
const BackendTable& backend_for(const Context& context);

}  // namespace isoshell
