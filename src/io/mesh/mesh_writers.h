// One writer a format. They only write; the caller commits.
#pragma once

#include "io/bytes/output_file.h"
#include "isoshell/triangle_mesh.h"

namespace isoshell {

void write_ply(OutputFile& file, const TriangleMesh& mesh, bool with_curve_edges);
void write_obj(OutputFile& file, const TriangleMesh& mesh);
void write_glb(OutputFile& file, const TriangleMesh& mesh);
void write_gltf(OutputFile& file, const TriangleMesh& mesh);
void write_stl(OutputFile& file, const TriangleMesh& mesh);
void write_off(OutputFile& file, const TriangleMesh& mesh);

/// True when single precision would move a vertex by more than a thousandth of the shortest edge.
bool needs_double(const TriangleMesh& mesh);

}  // namespace isoshell
