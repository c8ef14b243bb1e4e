// Parts that share walls, or pass through each other.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "isoshell/remesh.h"

namespace isoshell {

/// The surface of parts that share walls, without the walls; or of closed parts that pass through or touch each other.
struct JoinedParts {
  TriangleSoup soup;
  InputTopology topology;
  std::vector<std::array<WorldPoint, 2>> interfaces;  ///< edges where walls met the surface
  int64_t cut_faces = 0;
};

/// None where there are no such parts, or where the surface is not closed; with `may_be_open` parts that pass through
/// or touch each other (see join_solids.h) are joined also beside others that are open. Warns of walls that are left
/// out, and says what is left, or why none are joined.
std::optional<JoinedParts> join_parts(const TriangleSoup& soup, const SoupTopology& measured, bool may_be_open,
                                      RemeshReport& report, Context& context);

}  // namespace isoshell
