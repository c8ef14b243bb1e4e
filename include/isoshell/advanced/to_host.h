// Products made by a CUDA stage stay in device memory; these bring them to the host. A stage takes its inputs from
// either memory and copies what lies in the other one.
#pragma once

#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/stages.h"

namespace isoshell {

/// Copies in host memory, whatever memory the product is in. Cost: one pass over its bytes.
LatticeSurface to_host(const LatticeSurface& surface);
SiteSet to_host(const SiteSet& sites);
SiteSamples to_host(const SiteSamples& samples);
Shell to_host(const Shell& shell);
LevelSet to_host(const LevelSet& level_set);
SurfaceMesh to_host(const SurfaceMesh& surface);
Sheet to_host(const Sheet& sheet);
SeedSet to_host(const SeedSet& seeds);
VoronoiLabels to_host(const VoronoiLabels& labels);
DualMesh to_host(const DualMesh& mesh);

}  // namespace isoshell
