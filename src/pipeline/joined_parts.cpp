// join_parts (see joined_parts.h).
#include "pipeline/joined_parts.h"

#include <sstream>

#include "features/inner_walls.h"
#include "features/weld_for_features.h"
#include "isoshell/readable.h"
#include "pipeline/timed.h"

namespace isoshell {
namespace {

void warn(const WithoutWalls& found, RemeshReport& report) {
  const WorldPoint& at = found.interfaces.front()[0];
  std::ostringstream text;
  text << counted(found.walls, "triangle") << " between parts left out, solid is on both sides; "
       << counted(int64_t(found.interfaces.size()), "edge") << " around them, the first at " << at.x << ' ' << at.y
       << ' ' << at.z << ", " << (found.interfaces.size() == 1 ? "is a curve" : "are curves")
       << " where creases are kept";
  report.warnings.push_back(text.str());
}

}  // namespace

std::optional<JoinedParts> join_parts(const TriangleSoup& soup, const SoupTopology& measured, RemeshReport& report,
                                      Context& context) {
  const InputTopology& given = measured.topology;
  if (measured.dirt.nonmanifold_edges == 0 || given.boundary_loops > 0) return {};
  return timed(report, "mend", context, [&]() -> std::optional<JoinedParts> {
    std::optional<WithoutWalls> found = drop_inner_walls(weld_for_features(soup));
    if (!found || found->interfaces.empty()) return {};
    JoinedParts joined;
    joined.soup.vertices = std::move(found->mesh.vertices);
    joined.soup.triangles = std::move(found->mesh.triangles);
    joined.soup.faces_in_file = soup.faces_in_file;
    joined.topology = measure_topology(joined.soup, context).topology;
    if (!joined.topology.closed || !joined.topology.oriented) return {};
    warn(*found, report);
    joined.interfaces = std::move(found->interfaces);
    return joined;
  });
}

}  // namespace isoshell
