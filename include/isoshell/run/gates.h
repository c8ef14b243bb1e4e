// Conditions on the result of a run.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "isoshell/run/record.h"

namespace isoshell {

/// What the result must be; a run that misses any is not an error, but the command then exits with 6.
struct Gates {
  std::vector<std::string> asked;  ///< as they were written
  bool closed = false, manifold = false, no_self_intersections = false;
  bool allow_intersections = false;  ///< of a run that asks for nothing else: it misses that without this
  std::optional<int64_t> genus, components, boundary_loops;
  bool features = false;  ///< no curve was lost
  std::optional<double> min_angle_deg, max_deviation_world, normal_deviation_deg;
  std::optional<double> kept_edges_pct;  ///< of a frame that follows another; others meet them
  std::optional<int64_t> born;

  bool any() const {
    return closed || manifold || no_self_intersections || features || genus || components || boundary_loops ||
           min_angle_deg || kept_edges_pct || born || needs_distance();
  }
  bool needs_distance() const { return max_deviation_world || normal_deviation_deg; }
};

/// From a list as --require takes it: "closed,manifold,no-self-intersections,genus=3,components=2,boundary-loops=1,
/// min-angle=20.5,max-deviation=0.1,normal-deviation=1.5,features,kept-edges=99,born=10", any of them. Throws: usage.
Gates parse_gates(const std::string& list);

/// A sentence for each gate that the record does not meet, in the order of Gates. That the result is known to intersect
/// itself is one of them unless allowed. The record must hold what the gates ask for: topology and quality, the
/// distance for both deviations. Throws: usage when it does not.
std::vector<std::string> missed_gates(const Gates& gates, const RunRecord& record);

}  // namespace isoshell
