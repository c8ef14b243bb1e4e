// join_parts (see joined_parts.h).
#include "pipeline/joined_parts.h"

#include <sstream>

#include "features/inner_walls.h"
#include "features/weld_for_features.h"
#include "isoshell/readable.h"
#include "pipeline/timed.h"
#include "repair/join_solids.h"

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
  if (given.boundary_loops > 0) return {};
  if (measured.dirt.nonmanifold_edges == 0) return join_crossing_parts(soup, given, false, report, context);
  std::optional<JoinedParts> without_walls = timed(report, "mend", context, [&]() -> std::optional<JoinedParts> {
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
  return without_walls ? std::move(without_walls) : join_crossing_parts(soup, given, false, report, context);
}

std::optional<JoinedParts> join_crossing_parts(const TriangleSoup& soup, const InputTopology& given, bool may_be_open,
                                               RemeshReport& report, Context& context) {
  if ((given.boundary_loops > 0 && !may_be_open) || (given.components < 2 && given.genus >= 0)) return {};
  return timed(report, "unite", context, [&]() -> std::optional<JoinedParts> {
    std::optional<repair::JoinedSolids> solids = repair::join_solids(soup, report.join, context);
    if (!solids) return {};
    JoinedParts joined;
    joined.soup = std::move(solids->soup);
    joined.cut_faces = solids->cut_faces;
    joined.topology = measure_topology(joined.soup, context).topology;
    const InputTopology& found = joined.topology;
    const bool is_whole =
        given.boundary_loops > 0 ? found.boundary_loops == given.boundary_loops : found.closed && found.oriented;
    if (is_whole) return joined;
    report.join = {"their union is not closed", {}, 0};
    return {};
  });
}

}  // namespace isoshell
