// The CUDA backend's table.
#include "cuda/cuda_backend.h"
#include "cuda/device_stream.h"

namespace isoshell {

const BackendTable* cuda_backend() {
  static const BackendTable table = {
      "cuda",
      cuda_measure_topology,
      cuda_snap_surface,
      cuda_voxelize,
      cuda_sample_sites,
      cuda_build_shell,
      cuda_nano_index_grid,
      cuda_build_sheet,
      cpu_backend().cut_false_handles,  // sequential by nature
      cuda_coarsen_sites,
      cuda_build_outline,
      cuda_set_edge_lengths,
      cuda_smooth_edge_lengths,
      cuda_seed_shares,
      cuda_copy_edge_lengths,
      cuda_measure_curvature,
      cuda_place_seeds_on_sheet,
      cuda_place_seeds_on_sites,
      cuda_relax_on_sheet,
      cuda_relax_in_shell,
      cuda_attach_to_sheet,
      cuda_flood_shell,
      cuda_triangulate_dual,
      cuda_subdivide_seeds,
      cuda_improve_mesh,
      cuda_six_volume_vox,
      cuda_collapse_edges,
      cuda_untangle_sheet,
      [](Context& context) { DeviceStream::of(context).synchronize(); },
  };
  return &table;
}

}  // namespace isoshell
