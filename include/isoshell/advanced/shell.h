// The shell: every voxel within d of a site, with its exact closest site (paper section 3.1).
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Result: active are the voxels whose squared distance to the nearest site (voxel centre to voxel centre) is at most
/// band_vox^2; each holds the minimum of the pair (squared distance, site id).
struct Shell {
  VoxelSet voxels;
  int32_t band_vox = 0;              ///< d
  Buffer<uint32_t> closest_site;     ///< per active voxel
  Buffer<uint16_t> distance_sq_vox;  ///< per active voxel
};

struct Context;

/// NanoVDB index grid (GridType::Index) over a VoxelSet, as bytes to upload or save: value i of its active voxels is
/// i + 1 in canonical order, 0 is the background. All padding is zero. Cost: 96 bytes a leaf plus the upper nodes.
Buffer<std::byte> nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name);
/// The same bytes, made where the context's stages run: on the device, in its memory, from its leaves. Cost there: one
/// pass over masks and nodes, one wait for the device.
Buffer<std::byte> nano_index_grid(const VoxelSet& voxels, const LatticeFrame& frame, const char* name,
                                  Context& context);

}  // namespace isoshell
