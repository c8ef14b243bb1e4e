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
    WorldPoint lo, hi;
    bounding_box(soup, lo, hi);
    const LatticeFrame frame = LatticeFrame::around(lo, hi, 96);
    LatticeSurface surface = snap_surface(soup, frame, context);
    surface.topology = measure_topology(soup, soup.dirt, context);

    const SiteSet sites = voxelize(surface, context);
    const SiteSamples samples = sample_sites(surface, sites, context);
    const Shell shell = build_shell(sites, ShellOptions{2}, context);
    const Sheet sheet = build_sheet(surface, sites, samples, SheetOptions{}, context);

    SeedSet seeds = place_seeds(sheet, SeedOptions{1000, 0}, context);
    const RelaxReport relaxed = relax_on_sheet(sheet, seeds, RelaxOptions{}, context);
    const VoronoiLabels labels = flood_shell(shell, seeds, context);

    DualReport report;
    const DualMesh dual = triangulate_dual(sheet, seeds, DualOptions{}, report, context);
    const TriangleMesh mesh = to_world(dual, frame);

    std::cout << sites.voxels.voxel_count() << " sites, " << shell.voxels.voxel_count() << " shell voxels, genus "
              << sheet.topology.genus << ", " << relaxed.passes << " passes, " << mesh.triangles.size()
              << " triangles, labels " << digest_text(digest(labels)) << "\n";
    write_mesh(argv[2] + std::string(".ply"), mesh, {MeshFormat::ply, true});
    return report.failed_cells == 0 ? 0 : 1;
  } catch (const Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
