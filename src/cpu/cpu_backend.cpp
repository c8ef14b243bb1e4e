// The CPU's table.
#include "cpu/cpu_backend.h"

namespace isoshell {

const BackendTable& cpu_backend() {
  static const BackendTable table = {
      "cpu",
      cpu_measure_topology,
      cpu_snap_surface,
      cpu_voxelize,
      cpu_sample_sites,
      cpu_build_shell,
      cpu_nano_index_grid,
      cpu_build_sheet,
      cpu_cut_false_handles,
      cpu_coarsen_sites,
      cpu_build_outline,
      cpu_set_edge_lengths,
      cpu_smooth_edge_lengths,
      cpu_seed_shares,
      cpu_copy_edge_lengths,
      cpu_measure_curvature,
      cpu_place_seeds_on_sheet,
      cpu_place_seeds_on_sites,
      cpu_relax_on_sheet,
      cpu_relax_in_shell,
      cpu_attach_to_sheet,
      cpu_flood_shell,
      cpu_triangulate_dual,
      cpu_subdivide_seeds,
      cpu_improve_mesh,
      cpu_six_volume_vox,
      cpu_collapse_edges,
      cpu_untangle_sheet,
      [](Context&) {},
  };
  return table;
}

}  // namespace isoshell
