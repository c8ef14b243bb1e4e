// The seam between backends: the few functions each one provides. Everything else in src/ is written once.
#pragma once

#include "geometry/distance_sums.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Same inputs, same definition, same bytes, whichever backend it is. See stages.h for what each function computes. A
/// backend that lacks one does not compile, and none can take the place of another.
class BackendTable {
 public:
  virtual const char* name() const = 0;
  virtual InputTopology measure_topology(const TriangleSoup&, DirtCounts&, Context&) const = 0;
  virtual LatticeSurface snap_surface(const TriangleSoup&, const LatticeFrame&, Context&) const = 0;
  virtual MadeSurface make_surface_mesh(const SurfaceTriangles&, Context&) const = 0;
  virtual SiteSet voxelize(const LatticeSurface&, Context&) const = 0;
  virtual SiteSamples sample_sites(const LatticeSurface&, const SiteSet&, Context&) const = 0;
  virtual Shell build_shell(const SiteSet&, const ShellOptions&, Context&) const = 0;
  virtual LevelSetSurface level_set_surface(const LatticeSurface&, const TriangleSoup* exact, const Sheet&, SheetPart,
                                            Context&) const = 0;
  virtual LevelSet build_level_set(const LevelSetSurface&, const SiteSet&, const Sheet&, const LevelSetOptions&,
                                   Context&) const = 0;
  virtual Buffer<std::byte> nano_index_grid(const VoxelSet&, const LatticeFrame&, const char*, Context&) const = 0;
  /// From the sheet of all `solid_voxels`, which are the sites or what cut_false_handles makes of them. One that is a
  /// single component and has more handles than a genus that is given, so will not be used, has its topology only.
  /// `spent` is null, or names the same samples: then they are freed once a sheet that will be used has read them.
  virtual Sheet build_sheet(const LatticeSurface&, const SiteSet& solid_voxels, const SiteSet&, const SiteSamples&,
                            SiteSamples* spent, const SheetOptions&, Context&) const = 0;
  /// Result: the sites less those that close handles beyond `genus`, with the solid voxels around these. Empty when
  /// the box around the sites is too large.
  virtual SiteSet cut_false_handles(const SiteSet&, const SiteSamples&, int64_t genus, Context&) const = 0;
  virtual SiteSet coarsen_sites(const SiteSet&, Context&) const = 0;
  virtual Sheet build_proxy(const SiteSet&, const LatticeFrame&, const SheetOptions&, Context&) const = 0;
  virtual EdgeLengths limit_edge_lengths(const SurfaceMesh&, Buffer<uint32_t> raw, int64_t slope_q16,
                                         Context&) const = 0;
  virtual EdgeLengths smooth_edge_lengths(const SurfaceMesh&, const EdgeLengths&, int32_t rounds, Context&) const = 0;
  virtual int64_t seed_shares(const SurfaceMesh&, Context&) const = 0;
  virtual EdgeLengths transfer_edge_lengths(const SurfaceMesh& from, int halvings, const SurfaceMesh& to,
                                            Context&) const = 0;
  virtual Buffer<uint32_t> measure_curvature(const SurfaceMesh&, int32_t rounds, Context&) const = 0;
  virtual SeedSet place_seeds_on_surface(const SurfaceMesh&, const SeedOptions&, Context&) const = 0;
  virtual SeedSet place_seeds_on_sites(const SiteSet&, const SiteSamples&, const SeedOptions&, Context&) const = 0;
  virtual RelaxReport relax_on_sheet(const SurfaceMesh&, SeedSet&, const RelaxOptions&, Context&) const = 0;
  virtual RelaxReport relax_in_shell(const Shell&, const SiteSet&, const SiteSamples&, SeedSet&, const RelaxOptions&,
                                     Context&) const = 0;
  virtual void attach_to_sheet(const SurfaceMesh&, SeedSet&, int, Context&) const = 0;
  virtual VoronoiLabels flood_shell(const Shell&, const SeedSet&, Context&) const = 0;
  virtual Triangulation triangulate_dual(const SurfaceMesh&, SeedSet&&, const DualOptions&, Context&) const = 0;
  virtual SeedSet subdivide_seeds(const SurfaceMesh&, const DualMesh&, const SeedSet&, int64_t, Context&) const = 0;
  virtual OptimizeReport optimize_mesh(const SurfaceMesh&, const OptimizeOptions&, SeedSet&, DualMesh&,
                                       Context&) const = 0;
  virtual int64_t six_volume_vox(const SurfaceMesh&, Context&) const = 0;
  virtual void collapse_edges(const SurfaceMesh&, const CollapseOptions&, SeedSet&, DualMesh&, Context&) const = 0;
  virtual int64_t untangle_sheet(Sheet&, SeedSet&, Context&) const = 0;
  /// `area_until`: the sum of the areas of the triangles up to each. What the view names lies on the host.
  virtual DistanceSums sum_distances(const TriangleMesh& from, const std::vector<double>& area_until,
                                     const TriangleGridView& to, const DistancePlaces&, Context&) const = 0;
  virtual void finish_stages(Context&) const = 0;

 protected:
  ~BackendTable() = default;
};

/// Always there.
const BackendTable& cpu_backend();
/// Null when CUDA was not built in. See cuda_device.h.
const BackendTable* cuda_backend();
/// The table the context asks for. Throws Error{no_device} when it asks for CUDA and there is none.
const BackendTable& backend_for(const Context& context);

}  // namespace isoshell
