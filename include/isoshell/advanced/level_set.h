// The level set: signed distances around the solid that a sheet bounds, of any surface that has a sheet.
#pragma once

#include "isoshell/advanced/lattice_surface.h"
#include "isoshell/advanced/sheet.h"
#include "isoshell/advanced/site_set.h"
#include "isoshell/backend.h"
#include "isoshell/surface_source.h"

namespace isoshell {

constexpr double kMaxLevelSetBandVox = 16;

/// What distances are measured to, in voxels of the lattice: voxel i covers [i, i + 1].
struct LevelSetSurface {
  Buffer<WorldPoint> corner;   ///< three a triangle
  int64_t first_of_sheet = 0;  ///< triangles from this one on are the sheet's, the others are the input's
};

/// Result: active are the voxels whose centres are less than `band_vox` from the surface, and each holds its distance,
/// negative inside. Of the input's triangles only what lies near the sheet counts, within one voxel more than the
/// closing, at least two, of a voxel with a boundary face of its solid: inner walls have no distances. Voxels that are
/// clear of the surface have the side that the solid says. Each of the others has that of the one from which the fewest
/// steps along the lattice lead there without meeting a triangle; where more than a few are needed, what the solid
/// says. So soups and scans with holes have a sign, and where faces are flipped or doubled it is the same.
struct LevelSet {
  LatticeFrame frame;
  VoxelSet voxels;
  Buffer<float> distance_vox;  ///< per active voxel
  double band_vox = 0;
};

struct LevelSetOptions {
  double band_vox = 3;      ///< 1 to kMaxLevelSetBandVox
  int32_t closing_vox = 0;  ///< that the sheet was made with
};

/// Whether the sheet is part of the surface.
enum class SheetPart {
  none,    ///< the input's triangles close it
  beside,  ///< it spans gaps, and follows the input elsewhere to within what its triangles cut off
  alone,   ///< it bounds more than the sites do, as around surfaces without thickness
};

/// The surface of a level set. `exact` are the vertices and triangles that were snapped; without it the snapped
/// positions count. Cost: O(triangles). Throws: interrupted.
LevelSetSurface level_set_surface(const LatticeSurface& surface, const TriangleSoup* exact, const Sheet& sheet,
                                  SheetPart part, Context& context);

/// Measures and signs the band. Each distance is the least over all triangles, by the same operations on doubles, so
/// that the order in which they are looked at does not matter. The result lies where the context's backend works;
/// there nano_index_grid() of its voxels makes a grid of NanoVDB whose value i + 1 belongs to distance_vox[i]. Cost:
/// O(triangles * leaves that they reach + voxels * triangles that may be nearest); some 40 bytes a voxel within half a
/// voxel more than the band, 200 a triangle.
/// Throws: usage for a band outside of its range; interrupted.
LevelSet build_level_set(const LevelSetSurface& surface, const SiteSet& sites, const Sheet& sheet,
                         const LevelSetOptions& options, Context& context);

}  // namespace isoshell
