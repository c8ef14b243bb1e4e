// Writes the stage files and the preview of a torus into a folder, for test_vdb_tools.sh.
#include "isoshell/advanced/stages.h"
#include "isoshell/io/vdb_file.h"
#include "support/shapes.h"

using namespace isoshell;

int main(int argc, char* argv[]) {
  if (argc != 2) return 2;
  const std::string folder = argv[1];
  Context context;
  const LatticeFrame frame = LatticeFrame::around({-1.3, -1.3, -0.3}, {1.3, 1.3, 0.3}, 40);
  const LatticeSurface surface = snap_surface(shapes::torus(1, 0.3, 40, 20), frame, context);
  const SiteSet sites = voxelize(surface, context);
  const SiteSamples samples = sample_sites(surface, sites, context);
  const Shell shell = build_shell(sites, {2}, context);
  const SeedSet seeds = place_seeds(sites, samples, {100, 0}, context);
  const VoronoiLabels labels = flood_shell(shell, seeds, context);
  save_shell(folder + "/a.shell.vdb", surface, samples, shell);
  StageWriteOptions bridged;
  bridged.bridges = {{1000, 1000, 1000}, {1001, 1000, 1000}};
  save_shell(folder + "/b.shell.vdb", surface, samples, shell, bridged);
  save_voronoi(folder + "/a.voronoi.vdb", surface, samples, shell, seeds, labels);
  save_preview(folder + "/a.preview.vdb", frame, shell, labels);
}
