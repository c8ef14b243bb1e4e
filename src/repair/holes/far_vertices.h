// Vertices that are far away from all others, as a coordinate that is not right puts them.
#pragma once

#include <functional>
#include <optional>

#include "isoshell/repair.h"

namespace isoshell::repair {

/// Pulls vertices back that alone stretch a surface: by needles that are narrower than edges will be, no triangle of
/// the result could follow them, and a grid around them has no voxels for the rest.
/// Result: none where there are none. Otherwise the soup in which each such vertex stands in the middle of its foot.
/// The body is the box of three quarters of the faces, those with the shortest longest edges. A vertex is far where it
/// is farther from the body than 32 times its longest side. The foot of far vertices that faces connect are the others
/// of these faces. They are pulled back where neither their box nor that of the foot has a side as long as
/// `edge_world(area_world)`, which is asked once, if at all. Cost: linear in the faces; one look at each where no edge
/// is longer than a quarter of the box.
std::optional<TriangleSoup> pull_back_far_vertices(const TriangleSoup& soup,
                                                   const std::function<double(double)>& edge_world,
                                                   FarVertexReport& report);

}  // namespace isoshell::repair
