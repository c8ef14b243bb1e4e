// Vertices that are far away from all others, as a coordinate that is not right puts them.
#pragma once

#include <functional>
#include <optional>

#include "isoshell/repair.h"

namespace isoshell::repair {

/// As isoshell::pull_back_far_vertices(), with the length that edges will have on a surface of an area, which is asked
/// once, if at all.
std::optional<TriangleSoup> pull_back_far_vertices(const TriangleSoup& soup,
                                                   const std::function<double(double)>& edge_world);

}  // namespace isoshell::repair
