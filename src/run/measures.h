// What is measured of the result of a run.
#pragma once

#include <string>
#include <vector>

#include "isoshell/run/run.h"

namespace isoshell {

/// Whether everything is measured, and whether distances are: what is written and gates want some of it, too.
bool measures_all(const RunRequest& request);
bool measures_distance(const RunRequest& request);

/// Puts the vertices where the file of the output has them, less its offset, and notes that file in the record, and how
/// many vertices and triangles there are. Result: where they were; none where no file is
/// asked for. Throws: as positions_in_file().
std::vector<WorldPoint> put_as_in_file(TriangleMesh& mesh, RunRecord& record);

/// Whether that file's numbers are.
bool is_coarse(const RunRecord& record);

void move_by(const WorldPoint& offset, std::vector<WorldPoint>& positions);

/// Topology, intersections and regions of a mesh that is as in its file, on the triangles alone: no stage's word is
/// taken for them; and its quality at the exact positions. The mesh has these then and `exact` those of the file,
/// unless the file's numbers are coarse: that is measured though it is not asked for, and of the quality, too. Result:
/// what there is to warn of. Throws: interrupted.
std::vector<std::string> measure_mesh(TriangleMesh& mesh, std::vector<WorldPoint>& exact, bool is_asked,
                                      RunRecord& record, Context& context);

/// Distances from the surface as it was meshed, of regions from their walls as they are in `soup`, and of borders that
/// were kept. Throws: interrupted.
void measure_distances(const Prepared& prepared, const TriangleSoup& soup, const TriangleMesh& mesh, RunRecord& record,
                       Context& context);

/// Sites with two walls in one voxel. Throws: interrupted.
int64_t count_risky_sites(const Prepared& prepared, Context& context);

}  // namespace isoshell
