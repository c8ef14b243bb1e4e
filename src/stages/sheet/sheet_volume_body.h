// The volume inside a sheet, over an executor: it decides the closing.
#pragma once

#include "isoshell/advanced/surface_mesh.h"
#include "voxel/exact_int.h"

namespace isoshell {
namespace sheet_volume {

/// Six times the signed volume between a triangle and the origin, in q24, takes 66 bits: handed over in two parts,
/// whole voxels (rounded down) and the rest.
struct SixVolume {
  View<const PointQ8> position;
  View<const TriangleIndices> triangles;
  bool want_rest;
  ISOSHELL_HD int64_t operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    const PointQ8 a = position[t.a];
    const Vec64 n = cross(difference(position[t.b], a), difference(position[t.c], a));
    const Int128 six = Int128(a.x) * n.x + Int128(a.y) * n.y + Int128(a.z) * n.z;
    const int64_t whole = int64_t(six >> (3 * kFractionBits));
    return want_rest ? int64_t(six - Int128(whole) * (Int128(1) << (3 * kFractionBits))) : whole;
  }
};

}  // namespace sheet_volume

/// Six times the volume inside the sheet, in whole voxels. Exact up to that last rounding.
template <class Exec>
int64_t six_volume_vox_body(Exec& exec, const SurfaceMesh& surface) {
  using sheet_volume::SixVolume;
  const int64_t triangles = surface.triangles.size();
  const int64_t whole = exec.sum(triangles, SixVolume{surface.position.view(), surface.triangles.view(), false});
  const int64_t rest = exec.sum(triangles, SixVolume{surface.position.view(), surface.triangles.view(), true});
  return whole + (rest >> (3 * kFractionBits));
}

}  // namespace isoshell
