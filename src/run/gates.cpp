#include "isoshell/run/gates.h"

#include <sstream>

#include "isoshell/error.h"
#include "isoshell/options/option_text.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "gates", message); }

void set_gate(const std::string& gate, Gates& gates) {
  const size_t equals = gate.find('=');
  const bool has_value = equals != std::string::npos;
  const std::string name = gate.substr(0, equals), value = has_value ? gate.substr(equals + 1) : "";
  if (name == "closed" && !has_value)
    gates.closed = true;
  else if (name == "manifold" && !has_value)
    gates.manifold = true;
  else if (name == "no-self-intersections" && !has_value)
    gates.no_self_intersections = true;
  else if (name == "features" && !has_value)
    gates.features = true;
  else if (name == "genus" && has_value)
    gates.genus = parse_count("--require genus", value);
  else if (name == "components" && has_value)
    gates.components = parse_count("--require components", value);
  else if (name == "boundary-loops" && has_value)
    gates.boundary_loops = parse_count("--require boundary-loops", value);
  else if (name == "min-angle" && has_value) {
    gates.min_angle_deg = parse_number("--require min-angle", value);
    check_range("--require min-angle", *gates.min_angle_deg, {0, 60});
  } else if (name == "max-deviation" && has_value) {
    gates.max_deviation_world = parse_number("--require max-deviation", value);
    check_range("--require max-deviation", *gates.max_deviation_world, {});
  } else if (name == "normal-deviation" && has_value) {
    gates.normal_deviation_deg = parse_number("--require normal-deviation", value);
    check_range("--require normal-deviation", *gates.normal_deviation_deg, {0, 90});
  } else if (name == "kept-edges" && has_value) {
    gates.kept_edges_pct = parse_number("--require kept-edges", value);
    check_range("--require kept-edges", *gates.kept_edges_pct, {0, 100});
  } else if (name == "born" && has_value) {
    gates.born = parse_count("--require born", value);
  } else {
    refuse(
        "--require has '" + gate +
        "'; gates are closed, manifold, no-self-intersections, genus=G, components=N, "
        "boundary-loops=N, min-angle=DEG, max-deviation=W, normal-deviation=DEG, features, kept-edges=PERCENT, born=N");
  }
}

/// What was measured, or a refusal.
template <class T>
const T& measured(const std::optional<T>& value, const char* what) {
  if (!value) refuse(std::string("the run did not measure the ") + what + " that a gate asks for");
  return *value;
}

std::string intersections_text(const RemeshReport& report) {
  if (!report.post_done) return "the mesh is no closed 2-manifold and was not tested";
  return counted(report.post.self_intersections, "pair", "pairs") + " intersect";
}

std::string deviation_text(double limit_world, const MeshDistance& distance) {
  std::ostringstream text;
  text << "max-deviation=" << limit_world << ": the result is up to " << distance.to_reference.max
       << " from the input, the input up to " << distance.from_reference.max << " from the result";
  return text.str();
}

std::string normals_text(double limit_deg, const MeshDistance& distance) {
  std::ostringstream text;
  text << "normal-deviation=" << limit_deg << ": normals of the result deviate by "
       << distance.normal_to_reference.mean_deg << " degrees on average from the input's, and those of the input by "
       << distance.normal_from_reference.mean_deg << " from the result's";
  return text.str();
}

std::string lost_text(const FeatureReport& features) {
  if (features.lost.empty()) return "features: " + features.given_up;
  const LostCurve& first = features.lost.front();
  std::ostringstream text;
  text << "features: " << counted(int64_t(features.lost.size()), "curve") << " of the input "
       << (features.lost.size() == 1 ? "is" : "are") << " lost; the first, a " << first.kind << " of length "
       << first.length_world << " from " << first.at.x << ' ' << first.at.y << ' ' << first.at.z << ": "
       << first.reason;
  return text.str();
}

/// With borders that are kept, triangles intersect only where the input's do.
bool are_the_inputs(const RunRecord& record) { return record.report.features.border_loops > 0; }

}  // namespace

Gates parse_gates(const std::string& list) {
  Gates gates;
  std::istringstream items(list);
  for (std::string gate; std::getline(items, gate, ',');) {
    set_gate(gate, gates);
    gates.asked.push_back(gate);
  }
  return gates;
}

std::vector<std::string> missed_gates(const Gates& g, const RunRecord& record) {
  std::vector<std::string> missed;
  if (const auto pairs = record.report.post.self_intersections;
      pairs > 0 && !g.allow_intersections && !g.no_self_intersections && !are_the_inputs(record))
    missed.push_back("the result intersects itself in " + counted(pairs, "pair", "pairs") +
                     " of triangles; --allow-intersections takes it as it is");
  if (!g.any()) return missed;
  const MeshTopology& t = measured(record.topology, "topology");
  const RemeshReport& report = record.report;
  const auto gate = [&](bool met, const std::string& text) {
    if (!met) missed.push_back(text);
  };
  if (g.closed) gate(t.closed, "closed: the mesh has " + counted(t.boundary_loops, "open boundary", "open boundaries"));
  if (g.manifold)
    gate(t.is_manifold_with(report.features.border_loops),
         report.features.border_loops > 0 ? "manifold: the mesh is not a 2-manifold with the borders that were kept"
                                          : "manifold: the mesh is not a closed 2-manifold");
  if (g.no_self_intersections)
    gate(report.post_done && report.post.self_intersections == 0,
         "no-self-intersections: " + intersections_text(report));
  if (g.genus)
    gate(t.genus == *g.genus, "genus=" + std::to_string(*g.genus) + ": the mesh has " +
                                  (t.genus < 0 ? "none, it is no closed 2-manifold" : std::to_string(t.genus)));
  if (g.components)
    gate(t.components == *g.components,
         "components=" + std::to_string(*g.components) + ": the mesh has " + std::to_string(t.components));
  if (g.boundary_loops)
    gate(t.boundary_loops == *g.boundary_loops,
         "boundary-loops=" + std::to_string(*g.boundary_loops) + ": the mesh has " + std::to_string(t.boundary_loops));
  if (g.min_angle_deg) {
    const double smallest = measured(record.quality, "quality").theta_min_deg;
    std::ostringstream text;
    text << "min-angle=" << *g.min_angle_deg << ": the smallest angle is " << smallest;
    gate(smallest >= *g.min_angle_deg, text.str());
  }
  if (g.max_deviation_world) {
    const MeshDistance& distance = measured(record.distance, "distance");
    gate(distance.largest() <= *g.max_deviation_world, deviation_text(*g.max_deviation_world, distance));
  }
  if (g.normal_deviation_deg) {
    const MeshDistance& distance = measured(record.distance, "deviation of normals");
    gate(distance.normal_deviation_deg() <= *g.normal_deviation_deg, normals_text(*g.normal_deviation_deg, distance));
  }
  if (g.features) gate(report.features.lost.empty() && report.features.given_up.empty(), lost_text(report.features));
  if (record.options.previous) {
    const CoherenceReport& coherence = report.coherence;
    std::ostringstream kept;
    kept << "kept-edges=" << g.kept_edges_pct.value_or(0) << ": the frame before has " << coherence.kept_edges_pct
         << " % of the edges";
    gate(coherence.kept_edges_pct >= g.kept_edges_pct.value_or(0), kept.str());
    gate(coherence.born <= g.born.value_or(INT64_MAX), "born=" + std::to_string(g.born.value_or(0)) + ": " +
                                                           counted(coherence.born, "vertex is", "vertices are") +
                                                           " not where those of the frame before went");
  }
  return missed;
}

}  // namespace isoshell
