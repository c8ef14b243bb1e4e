// What a run meshes of its input.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pipeline/grid/plan.h"
#include "pipeline/grid/run_log.h"

namespace isoshell {

/// An input whose holes, fins and turned faces are repaired, and whose parts are one solid.
struct RepairedInput {
  std::optional<TriangleSoup> changed;  ///< none where the input needs nothing
  InputTopology topology;
  RepairReport repair;
  UnionReport united;
  std::vector<std::array<WorldPoint, 2>> interfaces;  ///< edges where parts met, which are curves beside creases

  bool is_changed() const { return changed.has_value(); }
  const TriangleSoup& soup(const TriangleSoup& given) const { return changed ? *changed : given; }
};

/// Unites components that share walls, touch or pass through each other; what is not closed and oriented then is
/// repaired, and united.
RepairedInput repair_and_unite(const TriangleSoup& soup, const SoupTopology& measured, const Plan& plan, Run& run);

}  // namespace isoshell
