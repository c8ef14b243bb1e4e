// See repaired_input.h.
#include "pipeline/repaired_input.h"

#include <cmath>
#include <functional>
#include <sstream>
#include <utility>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/world_vector.h"
#include "isoshell/boolean_union.h"
#include "isoshell/readable.h"
#include "pipeline/grid/sizing.h"
#include "repair/holes/open_soup.h"

namespace isoshell {
namespace {

/// Borders that are kept are those wider than the gaps that were asked to be closed; where nothing was, those of no
/// holes.
TriangleSoup repaired(const TriangleSoup& soup, const Plan& plan, RepairReport& report) {
  const RemeshOptions& options = plan.options;
  const bool is_chosen = !options.closing_vox && !options.closing_world;
  if (options.boundary == Boundary::close || is_chosen) return repair_soup(soup, {is_chosen}, report);
  const double widest_gap_world =
      options.closing_world ? *options.closing_world : 2. * *options.closing_vox * plan.first_voxel_size_world();
  return repair::repair_open_soup(soup, widest_gap_world, report);
}

/// Of a closed surface, whose volume is then negative; the sign of next to none is rounding.
bool is_inside_out(const TriangleSoup& soup, double area_world) {
  constexpr double kLeastVolume = 1e-9;  // of that of a body with such an area
  const WorldPoint& o = soup.vertices[soup.triangles[0][0]];
  const auto six_volumes = [&](size_t t) {
    const auto& [a, b, c] = soup.triangles[t];
    return dot(soup.vertices[a] - o, cross(soup.vertices[b] - o, soup.vertices[c] - o));
  };
  const double sum = joined_over(soup.triangles.size(), 0., six_volumes, std::plus<double>());
  return sum < -6 * kLeastVolume * area_world * std::sqrt(area_world);
}

/// The steps, on what the ones before left.
class Repair {
 public:
  Repair(const TriangleSoup& soup, const SoupTopology& measured, const Plan& plan, Run& run)
      : given_(soup), measured_(measured), plan_(plan), run_(run), context_(run.context) {
    made_.topology = measured.topology;
  }

  RepairedInput made() {
    const InputTopology& given = measured_.topology;
    if (!unite(measured_, false) && (!given.closed || !given.oriented)) {
      made_.changed = run_.timed("mend", [&] { return repaired(given_, plan_, made_.repair); });
      const SoupTopology left = measured();
      made_.topology = left.topology;
      made_.united = {};
      unite(left, plan_.options.boundary == Boundary::keep);
    }
    const InputTopology& input = made_.topology;
    if (input.closed && input.oriented && input.components == 1 &&
        run_with_threads(context_, [&] { return is_inside_out(soup(), input.area_world); }))
      made_.united.turned_components = 1;  // by what follows, which knows one side from the other
    return std::move(made_);
  }

 private:
  const TriangleSoup& soup() const { return made_.soup(given_); }

  SoupTopology measured() {
    return run_.timed("topology", [&] { return measure_topology(soup(), context_); });
  }

  /// Result: whether the union has changed the surface.
  bool unite(const SoupTopology& measured, bool keeps_open) {
    const InputTopology before = measured.topology;
    const bool is_one = before.components < 2 && before.genus >= 0 && measured.dirt.nonmanifold_edges == 0;
    if (is_one || (before.boundary_loops > 0 && !keeps_open)) return false;
    const Plan plan = plan_of(plan_.options, before, bounding_box(soup()));
    const UnionOptions options{plan.options.outer_only, keeps_open, plan.first_voxel_size_world() * kSheetGapVox,
                               false};
    UnionReport& report = made_.united;
    UnitedSoup united = run_.timed("unite", [&] { return boolean_union(soup(), options, report, context_); });
    if (report.changed_anything()) {
      const InputTopology after = measure_topology(united.soup, context_).topology;
      if (before.boundary_loops > 0 ? after.boundary_loops == before.boundary_loops : after.closed && after.oriented) {
        made_.changed = std::move(united.soup);
        made_.topology = after;
        made_.interfaces = std::move(united.interfaces);
        if (!made_.interfaces.empty()) warn_of_internal_faces();
        return true;
      }
      report = {};
      report.given_up = "their union is not closed";
    }
    if (!report.given_up.empty()) made_.topology.genus = -1;
    return false;
  }

  void warn_of_internal_faces() {
    const auto& edges = made_.interfaces;
    std::ostringstream text;
    text << counted(made_.united.internal_faces, "triangle") << " between parts left out, solid is on both sides; "
         << counted(int64_t(edges.size()), "edge") << " around them, the first at "
         << readable_place(edges.front()[0], bounding_box(soup())) << ", "
         << (edges.size() == 1 ? "is a curve" : "are curves") << " where creases are kept";
    run_.warn(text.str());
  }

  const TriangleSoup& given_;
  const SoupTopology& measured_;
  const Plan& plan_;
  Run& run_;
  Context& context_;
  RepairedInput made_;
};

}  // namespace

RepairedInput repair_and_unite(const TriangleSoup& soup, const SoupTopology& measured, const Plan& plan, Run& run) {
  return Repair(soup, measured, plan, run).made();
}

}  // namespace isoshell
