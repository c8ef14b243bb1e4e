// pull_back_far_vertices (see isoshell/repair.h): how long edges will be is for the plan to say.
#include "repair/holes/far_vertices.h"

#include "core/watched.h"
#include "options/check_options.h"
#include "pipeline/grid/plan.h"

namespace isoshell {

std::optional<TriangleSoup> pull_back_far_vertices(const TriangleSoup& soup, const RemeshOptions& options,
                                                   Context& context) {
  const RemeshOptions asked = checked(options);
  const auto edge_world = [&](double area_world) { return target_of(asked, area_world).edge_length_world; };
  return run_with_threads(context, [&] { return repair::pull_back_far_vertices(soup, edge_world); });
}

}  // namespace isoshell
