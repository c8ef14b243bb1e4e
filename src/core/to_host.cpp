// Products to the host.
#include "isoshell/advanced/to_host.h"

#include "core/copy_product.h"

namespace isoshell {

LatticeSurface to_host(const LatticeSurface& surface) { return host_copy(surface); }
SiteSet to_host(const SiteSet& sites) { return host_copy(sites); }
SiteSamples to_host(const SiteSamples& samples) { return host_copy(samples); }
Shell to_host(const Shell& shell) { return host_copy(shell); }
LevelSet to_host(const LevelSet& level_set) { return host_copy(level_set); }
SurfaceMesh to_host(const SurfaceMesh& surface) { return host_copy(surface); }
Sheet to_host(const Sheet& sheet) { return host_copy(sheet); }
SeedSet to_host(const SeedSet& seeds) { return host_copy(seeds); }
VoronoiLabels to_host(const VoronoiLabels& labels) { return host_copy(labels); }
DualMesh to_host(const DualMesh& mesh) { return host_copy(mesh); }

}  // namespace isoshell
