// A 64-bit digest of every product: the currency of parity and golden tests.
#pragma once

#include <cstdint>
#include <string>

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/level_set.h"
#include "isoshell/advanced/seed_set.h"
#include "isoshell/advanced/sheet.h"
#include "isoshell/advanced/shell.h"
#include "isoshell/advanced/site_set.h"
#include "isoshell/advanced/voronoi_labels.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

/// Digest of the canonical arrays; never of padding, pointers or NanoVDB bytes.
uint64_t digest(const LatticeSurface& surface);
uint64_t digest(const VoxelSet& voxels);
uint64_t digest(const SiteSet& sites);
uint64_t digest(const SiteSamples& samples);
uint64_t digest(const Shell& shell);
uint64_t digest(const LevelSet& level_set);
uint64_t digest(const Sheet& sheet);
uint64_t digest(const SeedSet& seeds);
uint64_t digest(const VoronoiLabels& labels);
uint64_t digest(const TriangleMesh& mesh);

/// Sixteen hexadecimal digits.
std::string digest_text(uint64_t digest);

}  // namespace isoshell
