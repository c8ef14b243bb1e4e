// What is measured of the result of a run.
#pragma once

#include <string>
#include <vector>

#include "isoshell/run/record.h"

namespace isoshell {

/// Topology, quality and regions, on the triangles alone: no stage's word is taken for them. Result: what there is to
/// warn of. Throws: interrupted.
std::vector<std::string> measure_mesh(const TriangleMesh& mesh, RunRecord& record, Context& context);

/// Distances from the surface as it was meshed, of regions from their walls as they are in `soup`, and of borders that
/// were kept. Throws: interrupted.
void measure_distances(const Prepared& prepared, const TriangleSoup& soup, const TriangleMesh& mesh, RunRecord& record,
                       Context& context);

/// Sites with two walls in one voxel. Throws: interrupted.
int64_t count_risky_sites(const Prepared& prepared, Context& context);

}  // namespace isoshell
