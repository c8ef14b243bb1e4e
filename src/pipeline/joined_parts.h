// Parts that share walls.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "isoshell/remesh.h"

namespace isoshell {

/// The surface of parts that share walls, without the walls.
struct JoinedParts {
  TriangleSoup soup;
  InputTopology topology;
  std::vector<std::array<WorldPoint, 2>> interfaces;  ///< edges where walls met the surface
};

/// None where there are no such walls, or where the surface is not closed without them. Warns of what is left out.
std::optional<JoinedParts> join_parts(const TriangleSoup& soup, const SoupTopology& measured, RemeshReport& report,
                                      Context& context);

}  // namespace isoshell
