// Sites: the voxels that the surface occupies, and the surface as each of them sees it.
#pragma once

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {

/// Result: every voxel whose closed cube meets a closed triangle of the snapped surface, decided in integers.
/// The index of a voxel in canonical order is its site id.
struct SiteSet {
  VoxelSet voxels;
  Buffer<Voxel> hollows = {};  ///< a voxel in each hollow that an inner surface bounds: the outside is there, too
};

/// The surface point a site stands for.
struct SiteSample {
  int16_t dx, dy, dz;  ///< q8, from the voxel's centre, at most half its diagonal (222) long; may leave the voxel
  Normal8 normal;      ///< of the triangle, as oriented in the input
  uint8_t zero[3];     ///< fill the word
  uint32_t triangle;   ///< index in LatticeSurface::triangles
};

/// Result: for every site the ascending list of triangles that overlap it, and its sample: the point of the smallest
/// (squared distance from the voxel's centre, triangle index), with the point as closest_point_on_triangle gives it.
struct SiteSamples {
  Buffer<SiteSample> sample;  ///< per site
  Buffer<int64_t> first;      ///< site_count + 1 offsets into `triangles`
  Buffer<uint32_t> triangles;
};

}  // namespace isoshell
