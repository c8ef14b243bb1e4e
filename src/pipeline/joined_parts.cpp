// join_parts (see joined_parts.h).
#include "pipeline/joined_parts.h"

#include <sstream>

#include "features/mesh/internal_faces.h"
#include "features/mesh/weld_for_features.h"
#include "isoshell/readable.h"
#include "pipeline/grid/timed.h"
#include "repair/solids/join_solids.h"

namespace isoshell {
namespace {

void warn(const WithoutInternalFaces& found, const TriangleSoup& soup, RemeshReport& report) {
  std::ostringstream text;
  text << counted(found.dropped, "triangle") << " between parts left out, solid is on both sides; "
       << counted(int64_t(found.interfaces.size()), "edge") << " around them, the first at "
       << readable_place(found.interfaces.front()[0], bounding_box(soup)) << ", "
       << (found.interfaces.size() == 1 ? "is a curve" : "are curves") << " where creases are kept";
  report.warnings.push_back(text.str());
}

std::optional<JoinedParts> join_crossing_parts(const TriangleSoup& soup, const InputTopology& given, bool may_be_open,
                                               RemeshReport& report, Context& context) {
  if ((given.boundary_loops > 0 && !may_be_open) || (given.components < 2 && given.genus >= 0)) return {};
  return timed(report, "unite", context, [&]() -> std::optional<JoinedParts> {
    std::optional<repair::JoinedSolids> solids = repair::join_solids(soup, report.input.joined, context);
    if (!solids) return {};
    JoinedParts joined;
    joined.soup = std::move(solids->soup);
    joined.cut_faces = solids->cut_faces;
    joined.topology = measure_topology(joined.soup, context).topology;
    const InputTopology& found = joined.topology;
    const bool is_whole =
        given.boundary_loops > 0 ? found.boundary_loops == given.boundary_loops : found.closed && found.oriented;
    if (is_whole) return joined;
    report.input.joined = {"their union is not closed", {}, 0};
    return {};
  });
}

/// Faces of the soup, and after them those that close its holes.
TriangleSoup with_caps_last(const FeatureMesh& mesh, const TriangleSoup& from) {
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.faces_in_file = from.faces_in_file;
  std::vector<std::array<uint32_t, 3>> caps;
  for (size_t t = 0; t < mesh.triangles.size(); ++t)
    (mesh.source_face[t] < from.first_cap ? soup.triangles : caps).push_back(mesh.triangles[t]);
  if (!caps.empty()) soup.first_cap = uint32_t(soup.triangles.size());
  soup.triangles.insert(soup.triangles.end(), caps.begin(), caps.end());
  return soup;
}

/// None where there are no walls.
std::optional<JoinedParts> without_internal_faces(const TriangleSoup& soup, RemeshReport& report, Context& context) {
  return timed(report, "mend", context, [&]() -> std::optional<JoinedParts> {
    std::optional<WithoutInternalFaces> found = drop_internal_faces(weld_for_features(soup));
    if (!found || found->interfaces.empty()) return {};
    JoinedParts joined;
    joined.soup = with_caps_last(found->mesh, soup);
    joined.topology = measure_topology(joined.soup, context).topology;
    if (!joined.topology.closed || !joined.topology.oriented) return {};
    warn(*found, soup, report);
    joined.interfaces = std::move(found->interfaces);
    return joined;
  });
}

}  // namespace

std::optional<JoinedParts> join_parts(const TriangleSoup& soup, const SoupTopology& measured, bool may_be_open,
                                      RemeshReport& report, Context& context) {
  const InputTopology& given = measured.topology;
  std::optional<JoinedParts> joined;
  if (given.boundary_loops == 0 && measured.dirt.nonmanifold_edges > 0)
    joined = without_internal_faces(soup, report, context);
  return joined ? std::move(joined) : join_crossing_parts(soup, given, may_be_open, report, context);
}

}  // namespace isoshell
