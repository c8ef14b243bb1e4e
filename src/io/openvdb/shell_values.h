// What grids of a shell have in each of its voxels.
#pragma once

#include <cmath>

#include "io/openvdb/vdb_grids.h"
#include "isoshell/advanced/lattice.h"
#include "isoshell/advanced/shell.h"

namespace isoshell {

constexpr char kShellDistance[] = "shell_distance";

/// Each is a function of leaf, offset and index of a voxel, as make_voxel_grid() takes them, and borrows the shell.
inline auto shell_distances(const Shell& shell, const LatticeFrame& frame) {
  return [distance_sq = shell.distance_sq_vox.view(), size = frame.voxel_size](int64_t, int, int64_t i) {
    return float(std::sqrt(double(distance_sq[i])) * size);
  };
}
inline auto closest_sites(const Shell& shell) {
  return [site = shell.closest_site.view()](int64_t, int, int64_t i) { return int32_t(site[i]); };
}
inline auto squared_distances(const Shell& shell) {
  return [distance_sq = shell.distance_sq_vox.view()](int64_t, int, int64_t i) { return int32_t(distance_sq[i]); };
}

inline float shell_background(const Shell& shell, const LatticeFrame& frame) {
  return float(shell.band_vox * frame.voxel_size);
}

}  // namespace isoshell
