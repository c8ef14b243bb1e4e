// One face as triangles with further points in it.
#pragma once

#include "repair/arrangement/lattice_faces.h"

namespace isoshell::repair {

struct FaceCut {
  Corners corner;
  std::array<std::vector<uint32_t>, 3> border;  ///< points on edge i, from corner i to the next one
  std::vector<uint32_t> inside;                 ///< ascending
  int jitter_steps = 0;     ///< by which points are moved at most, each in its own way, before they are joined
  std::vector<Ends> lines;  ///< between these points, that are to be edges
};

/// Triangles that turn like the face and have its border with the points there. Points inside are all corners, and
/// lines edges, but where points that are off the face by what is made one leave no room for them. Triangles in the
/// same place of two faces are the same where these lie on each other and have the same lines around it: corners are
/// joined as Delaunay's are, and a choice between several ways depends on the numbers of the points alone.
std::vector<Corners> cut_face(const std::vector<StepPoint>& point, const FaceCut& cut);

}  // namespace isoshell::repair
