// The stages one by one, for those who want the products between them: sites, shell, sheet, seeds, Voronoi volume.
#include <iostream>

#include "isoshell/isoshell.h"

using namespace isoshell;

int main(int argc, char* argv[]) {
  if (argc < 3) return 2;
  try {
    Context context;
    TriangleSoup soup = read_mesh(argv[1]);

    // The only step in world units: choose a lattice and snap the surface to it.
    const auto [lo, hi] = bounding_box(soup);
    const LatticeFrame frame = LatticeFrame::around(lo, hi, 96);
    LatticeSurface surface = snap_surface(soup, frame, context);
    surface.topology = measure_topology(soup, context).topology;

    const SiteSet sites = voxelize(surface, context);
    const SiteSamples samples = sample_sites(surface, sites, context);
    const Shell shell = build_shell(sites, ShellOptions{2}, context);
    const Sheet sheet = build_sheet(surface, sites, samples, SheetOptions{}, context);

    // A stage takes what it changes by moving, and returns it.
    RelaxedSeeds relaxed =
        relax_on_sheet(sheet, place_seeds(sheet, SeedOptions{1000, 0}, context), RelaxOptions{}, context);
    const VoronoiLabels labels = flood_shell(shell, relaxed.seeds, context);

    const Triangulation dual = triangulate_dual(sheet, std::move(relaxed.seeds), DualOptions{}, context);
    const TriangleMesh mesh = to_world(dual.mesh, frame);

    std::cout << sites.voxels.voxel_count() << " sites, " << shell.voxels.voxel_count() << " shell voxels, genus "
              << sheet.topology.genus << ", " << relaxed.report.passes << " passes, " << mesh.triangles.size()
              << " triangles, labels " << digest_text(digest(labels)) << "\n";
    write_mesh(argv[2] + std::string(".ply"), mesh, {"ply", true});
    return dual.report.failed_cells == 0 ? 0 : 1;
  } catch (const Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
