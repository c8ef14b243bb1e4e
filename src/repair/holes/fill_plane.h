// Triangles between loops of one plane.
#pragma once

#include "repair/holes/flat_rims.h"

namespace isoshell::repair {

/// Whether a point of the rim's plane is inside of its loop.
bool is_inside(const RepairMesh& mesh, const FlatRim& rim, const Loop& loop, const WorldPoint& p);

/// Faces between the edges of a loop, or of several, one after the other, that lie in the plane of a rim and pass it
/// the other way; Delaunay triangles otherwise. None where edges cross or touch each other, or where a new edge is
/// there already. Cost: as triangulate_plane.
std::vector<Corners> fill_plane(const RepairMesh& mesh, const FlatRim& rim, const Loop& loop);

}  // namespace isoshell::repair
