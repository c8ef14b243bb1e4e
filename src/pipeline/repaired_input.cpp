// See repaired_input.h.
#include "pipeline/repaired_input.h"

#include <tbb/blocked_range.h>
#include <tbb/parallel_reduce.h>

#include <cmath>
#include <functional>
#include <utility>

#include "geometry/world_vector.h"
#include "pipeline/grid/timed.h"
#include "pipeline/joined_parts.h"
#include "repair/holes/open_soup.h"

namespace isoshell {
namespace {

/// Of faces that were cut: closed, whatever their edges say, and of a genus that nobody knows.
InputTopology topology_of_union(InputTopology input, const UnionReport& unite) {
  input.closed = input.oriented = true;
  input.components = unite.joined_components;
  input.genus = -1;
  return input;
}

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
  const double sum = tbb::parallel_deterministic_reduce(
      tbb::blocked_range<size_t>(0, soup.triangles.size(), 4096), 0.0,
      [&](const tbb::blocked_range<size_t>& r, double value) {
        for (size_t t = r.begin(); t < r.end(); ++t) value += six_volumes(t);
        return value;
      },
      std::plus<double>());
  return sum < -6 * kLeastVolume * area_world * std::sqrt(area_world);
}

/// The steps, on what the ones before left.
class Repair {
 public:
  Repair(const TriangleSoup& soup, const SoupTopology& measured, const Plan& plan, RemeshReport& report,
         Context& context)
      : given_(soup), measured_(measured), plan_(plan), report_(report), context_(context) {
    made_.topology = measured.topology;
  }

  RepairedInput made() {
    const InputTopology& given = measured_.topology;
    if (!join(measured_, false) && (!given.closed || !given.oriented)) {
      made_.changed = timed(report_, "mend", context_, [&] { return repaired(given_, plan_, report_.input.repair); });
      const SoupTopology left = measured();
      made_.topology = left.topology;
      join(left, plan_.options.boundary == Boundary::keep);
    }
    const InputTopology& input = made_.topology;
    if (input.closed && input.oriented && input.components > 1) unite();
    if (input.closed && input.oriented && input.components == 1 && is_inside_out(soup(), input.area_world))
      report_.input.united.turned_components = 1;  // by what follows, which knows one side from the other
    report_.input.united.cut_faces += cut_faces_;
    if (cut_faces_ > 0 && report_.input.united.joined_components == 0)
      report_.input.united.joined_components = input.components;
    return std::move(made_);
  }

 private:
  const TriangleSoup& soup() const { return made_.soup(given_); }

  SoupTopology measured() {
    return timed(report_, "topology", context_, [&] { return measure_topology(soup(), context_); });
  }

  bool join(const SoupTopology& measured, bool may_be_open) {
    std::optional<JoinedParts> joined = join_parts(soup(), measured, may_be_open, report_, context_);
    if (!joined) return false;
    made_ = {std::move(joined->soup), joined->topology, std::move(joined->interfaces)};
    cut_faces_ = joined->cut_faces;
    return true;
  }

  void unite() {
    const Plan plan = plan_of(plan_.options, made_.topology, bounding_box(soup()));
    const UnionOptions options{plan.options.outer_only, plan.first_voxel_size_world() / 2};
    UnionReport& united = report_.input.united;
    TriangleSoup outside =
        timed(report_, "unite", context_, [&] { return boolean_union(soup(), options, united, context_); });
    if (!united.changed_anything()) return;
    made_.changed = std::move(outside);
    made_.topology = measured().topology;
    if (united.cut_faces == 0) return;
    made_.topology = topology_of_union(made_.topology, united);
    std::string& given_up = report_.input.joined.given_up;
    if (cut_faces_ == 0 && given_up.empty())
      given_up = made_.interfaces.empty() ? "fewer than two of them look outward" : "others share walls";
  }

  const TriangleSoup& given_;
  const SoupTopology& measured_;
  const Plan& plan_;
  RemeshReport& report_;
  Context& context_;
  RepairedInput made_;
  int64_t cut_faces_ = 0;  ///< by the joining of parts
};

}  // namespace

RepairedInput repair_and_unite(const TriangleSoup& soup, const SoupTopology& measured, const Plan& plan,
                               RemeshReport& report, Context& context) {
  return Repair(soup, measured, plan, report, context).made();
}

}  // namespace isoshell
