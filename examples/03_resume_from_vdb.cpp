// A run that stops at a .vdb file and goes on from it gives the same mesh, byte by byte, as a run in one go.
#include <iostream>

#include "isoshell/isoshell.h"

using namespace isoshell;

int main(int argc, char* argv[]) {
  if (argc < 3) return 2;
  try {
    Context context;
    RemeshOptions options;
    options.vertices = 1500;
    options.want_shell = true;
    const std::string stage_path = argv[2] + std::string(".voronoi.vdb");
    uint64_t digest_in_one_go = 0;

    {
      const Prepared prepared = prepare(read_mesh(argv[1]), options, context);
      Relaxed relaxed = relax(prepared, context);
      const VoronoiLabels labels = flood_shell(prepared.shell(), relaxed.seeds, context);
      StageWriteOptions keep;
      keep.closing_vox = prepared.closing_vox();
      keep.overwrite = true;
      save_voronoi(stage_path, prepared.surface(), prepared.samples(), prepared.shell(), relaxed.seeds, labels, keep);
      digest_in_one_go = digest(triangulate(prepared, std::move(relaxed), context).mesh);
    }

    StageFile stage = read_stage(stage_path);
    const Prepared prepared = prepare(std::move(stage.surface), stage.info.closing_vox, options, context);
    const RemeshResult resumed = triangulate(prepared, {std::move(*stage.seeds), prepared.report()}, context);
    const bool same = digest(resumed.mesh) == digest_in_one_go;
    std::cout << "resumed from " << stage_path << ": " << (same ? "same bytes" : "DIFFERENT BYTES") << "\n";
    return same ? 0 : 1;
  } catch (const Error& e) {
    std::cerr << e.stage() << ": " << e.what() << "\n";
    return int(e.code());
  }
}
