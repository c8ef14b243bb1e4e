// See feature_report.h.
#include "pipeline/patches/feature_report.h"

#include <algorithm>
#include <map>

#include "features/mesh/curve_paths.h"
#include "geometry/box.h"
#include "isoshell/readable.h"

namespace isoshell {

const char* name_of(CurveKind kind) {
  switch (kind) {
    case CurveKind::border:
      return "border";
    case CurveKind::non_manifold:
      return "edge of three faces";
    case CurveKind::crease:
      return "crease";
    case CurveKind::seam:
      return "seam";
    default:
      return "line";
  }
}

int64_t count_kind(const CurveNetwork& network, CurveKind kind) {
  return std::count_if(network.curves.begin(), network.curves.end(),
                       [=](const FeatureCurve& curve) { return curve.kind == kind; });
}

void report_found(const FeatureMesh& mesh, const CurveNetwork& network, bool keeps_borders, FeatureReport& report) {
  report.seams = count_kind(network, CurveKind::seam);
  report.lines = count_kind(network, CurveKind::line);
  report.curves = count_kind(network, CurveKind::crease) + report.seams + report.lines;
  report.corners = int64_t(network.corners.size());
  report.length_world = 0;
  for (const FeatureCurve& curve : network.curves)
    if (curve.kind != CurveKind::border && curve.kind != CurveKind::non_manifold)
      report.length_world += length_of(mesh.vertices, curve);
  if (keeps_borders) report.border_loops = count_kind(network, CurveKind::border);  // until they are put together
}

void warn_of_branches(const FeatureMesh& mesh, const CurveNetwork& network, std::vector<std::string>& warnings) {
  int64_t edges = 0;
  const WorldPoint* at = nullptr;
  for (const FeatureCurve& curve : network.curves) {
    if (curve.kind != CurveKind::non_manifold) continue;
    edges += int64_t(curve.vertex.size()) - (curve.is_loop ? 0 : 1);
    if (!at) at = &mesh.vertices[curve.vertex.front()];
  }
  if (!at) return;
  const std::string text = counted(edges, "edge") +
                           " of more than two faces, or of two that disagree about the outside, the first at " +
                           readable_place(*at, box_of(mesh.vertices)) +
                           ": a result that is a manifold cannot have them, and follows the surface around";
  if (std::find(warnings.begin(), warnings.end(), text) == warnings.end()) warnings.push_back(text);
}

std::vector<LostCurve> describe(const FeatureMesh& mesh, const CurveNetwork& network) {
  std::vector<LostCurve> curves;
  for (size_t c = 0; c < network.curves.size(); ++c) {
    const FeatureCurve& curve = network.curves[c];
    curves.push_back(
        {int64_t(c), name_of(curve.kind), length_of(mesh.vertices, curve), mesh.vertices[curve.vertex.front()], ""});
  }
  return curves;
}

void report_left_out(const std::vector<LostCurve>& curves, const LatticeFrame& frame, FeatureReport& report, Run& run) {
  std::map<std::string, std::vector<const LostCurve*>> by_reason;
  for (const LostCurve& curve : curves) by_reason[curve.reason].push_back(&curve);
  for (const auto& [reason, of_it] : by_reason) {
    run.warn(counted(int64_t(of_it.size()), "crease is", "creases are") + " not kept, the first near " +
             readable_place(of_it.front()->at, frame) + ": " +
             (reason == kEdgesTooLong
                  ? "the edges are too long for them; ask for more --vertices, or, where they are noise, "
                    "for fewer creases by --features DEG or --features off"
                  : reason));
  }
  report.lost.insert(report.lost.end(), curves.begin(), curves.end());
}

void warn_of_left_alone(int64_t triangles, Run& run) {
  if (triangles == 0) return;
  run.warn(counted(triangles, "triangle") +
           " with angles below 30 degrees beside curves were left as they were: more looks at them "
           "than the result has vertices would take too long; more vertices make better triangles");
}

void give_up(const std::vector<LostCurve>& curves, const std::string& why, FeatureReport& report, Run& run) {
  const int64_t creases = report.curves - report.seams - report.lines;
  std::string what;
  const auto add = [&](const std::string& kind) { what += (what.empty() ? "" : " and ") + kind; };
  if (report.border_loops > 0) add("borders");
  if (creases > 0) add(counted(creases, "crease"));
  if (report.seams > 0) add(counted(report.seams, "seam"));
  if (report.lines > 0) add(counted(report.lines, "line"));
  if (what.empty()) what = "creases";  // none was found yet
  const bool is_one = report.border_loops == 0 && report.curves == 1;
  run.warn(what + (is_one ? " is not kept: " : " are not kept: ") + why +
           (report.border_loops > 0 ? "; the result is closed" : "") +
           (report.seams > 0 ? "; triangles lie across seams" : ""));
  for (const LostCurve& curve : curves) {
    const bool is_wanted = curve.kind != name_of(CurveKind::non_manifold) &&
                           (curve.kind != name_of(CurveKind::border) || report.border_loops > 0);
    if (!is_wanted) continue;
    report.lost.push_back(curve);
    report.lost.back().reason = why;
  }
  report.given_up = why;
  report.on_sheet.clear();
  report.kept_length_world = 0;
  report.patches = report.vertices = report.segments = report.border_loops = 0;
}

std::vector<LostForReason> lost_by_reason(const std::vector<LostCurve>& lost, size_t most) {
  std::map<std::string, LostForReason> by_reason;
  for (const LostCurve& curve : lost) {
    LostForReason& of = by_reason[curve.reason];
    of.reason = curve.reason;
    ++of.curves;
    of.length_world += curve.length_world;
  }
  std::vector<LostForReason> out;
  for (auto& [reason, of] : by_reason) out.push_back(std::move(of));
  std::stable_sort(out.begin(), out.end(),
                   [](const LostForReason& a, const LostForReason& b) { return a.length_world > b.length_world; });
  out.resize(std::min(out.size(), most));
  return out;
}

std::vector<LostCurve> longest_of(std::vector<LostCurve> lost, size_t most) {
  std::stable_sort(lost.begin(), lost.end(),
                   [](const LostCurve& a, const LostCurve& b) { return a.length_world > b.length_world; });
  lost.resize(std::min(lost.size(), most));
  return lost;
}

double lost_length_world(const std::vector<LostCurve>& lost) {
  double sum = 0;
  for (const LostCurve& curve : lost) sum += curve.length_world;
  return sum;
}

}  // namespace isoshell
