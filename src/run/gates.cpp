#include "isoshell/run/gates.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <sstream>
#include <variant>

#include "isoshell/error.h"
#include "isoshell/options/option_text.h"
#include "isoshell/readable.h"
#include "run/warnings.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::usage, "gates", message); }

enum class GateOf { mesh, distance, curves, frame, input, request };

/// A gate. Flags hold or not, others have a limit, or the number that must be.
struct GateRow {
  const char *name, *value_name, *words;  ///< words: empty where the name says it
  std::variant<bool Gates::*, std::optional<int64_t> Gates::*, std::optional<double> Gates::*> member;
  OptionRange range;  ///< of a real number
  GateOf of;
  /// What was found where the gate is not met; empty where it is.
  std::string (*miss)(const Gates& gates, const Measured& m);
};

/// What was measured, or a refusal.
template <class T>
const T& measured(const std::optional<T>& value, const char* what) {
  if (!value) refuse(std::string("the run did not measure the ") + what + " that a gate asks for");
  return *value;
}
const MeshTopology& topology(const Measured& m) { return measured(m.topology, "topology"); }

template <class... Parts>
std::string text(const Parts&... parts) {
  std::ostringstream out;
  (out << ... << parts);
  return out.str();
}

/// Of RegionCounts, and of RegionName.
template <class Region>
std::string shown(const Region& region) {
  return text("region ", region.label, region.name.empty() ? "" : " (" + region.name + ")");
}

/// What is wrong with the first region that is not closed; empty where all are.
std::string open_region(const RegionCensus& census) {
  for (const RegionCounts& r : census.regions) {
    if (r.closed) continue;
    std::string what = shown(r) + " is not closed: ";
    if (r.open_edges > 0)
      return what + counted(r.open_edges, "edge has", "edges have") + " another number of its faces than two";
    return what + counted(r.inconsistent_edges, "edge", "edges") + " with two faces that pass it the same way";
  }
  return census.every_region_closed ? "" : "the mesh has no region";
}

std::string miss_regions(const Gates&, const Measured& m) {
  if (!m.regions) return "the mesh has no regions";
  const RegionCensus& census = *m.regions;
  std::string what = open_region(census);
  const auto add = [&](int64_t count, const char* one, const char* several) {
    if (count > 0) what += (what.empty() ? "" : "; ") + counted(count, one, several);
  };
  add(census.duplicate_faces, "face is there twice", "faces are there twice");
  add(census.inside_out_regions, "region is inside out", "regions are inside out");
  add(census.intersecting_pairs, "pair of triangles intersects", "pairs of triangles intersect");
  return what;
}

std::string miss_adjacency(const Gates&, const Measured& m) {
  return m.region_changes ? words_of(*m.region_changes) : "the input has no regions";
}

std::string miss_region_volume(const Gates& g, const Measured& m) {
  if (!m.region_changes) return "the input has no regions";
  if (const std::string open = open_region(*m.regions); !open.empty()) return open;
  const std::vector<RegionVolumes>& volumes = m.region_changes->volumes;
  const auto worst = std::max_element(volumes.begin(), volumes.end(), [](const auto& a, const auto& b) {
    return std::abs(a.change_pct()) < std::abs(b.change_pct());
  });
  if (!m.region_changes->lost.empty()) return shown(m.region_changes->lost.front()) + " is lost";
  if (worst == volumes.end() || std::abs(worst->change_pct()) <= *g.region_volume_pct) return "";
  return text(shown(worst->region), " has ", worst->after_world, " of ", worst->before_world, ", ", worst->change_pct(),
              " %");
}

std::string miss_closed(const Gates&, const Measured& m) {
  if (m.regions) return open_region(*m.regions);
  const MeshTopology& t = topology(m);
  return t.closed ? "" : "the mesh has " + counted(t.boundary_loops, "open boundary", "open boundaries");
}

std::string miss_manifold(const Gates&, const Measured& m) {
  if (m.regions) {
    for (const RegionCounts& r : m.regions->regions)
      if (r.touching_vertices > 0)
        return shown(r) + " touches itself in " + counted(r.touching_vertices, "vertex", "vertices");
    return open_region(*m.regions);
  }
  if (topology(m).is_manifold_with(m.border_loops())) return "";
  return m.border_loops() > 0 ? "the mesh is not a 2-manifold with the borders that were kept"
                              : "the mesh is not a closed 2-manifold";
}

std::string miss_no_intersections(const Gates&, const Measured& m) {
  if (!m.self_intersections) return "the mesh is no closed 2-manifold and was not tested";
  return *m.self_intersections == 0 ? "" : counted(*m.self_intersections, "pair", "pairs") + " intersect";
}

std::string miss_genus(const Gates& g, const Measured& m) {
  const int64_t genus = topology(m).genus;
  if (genus == *g.genus) return "";
  return "the mesh has " + (genus < 0 ? "none, it is no closed 2-manifold" : std::to_string(genus));
}

std::string miss_components(const Gates& g, const Measured& m) {
  const int64_t count = topology(m).components;
  return count == *g.components ? "" : text("the mesh has ", count);
}

std::string miss_boundary_loops(const Gates& g, const Measured& m) {
  const int64_t count = topology(m).boundary_loops;
  return count == *g.boundary_loops ? "" : text("the mesh has ", count);
}

std::string miss_min_angle(const Gates& g, const Measured& m) {
  const double smallest = measured(m.quality, "quality").theta_min_deg;
  return smallest >= *g.min_angle_deg ? "" : text("the smallest angle is ", smallest);
}

std::string miss_min_dihedral(const Gates& g, const Measured& m) {
  const LeastDihedral& least = measured(m.quality, "quality").dihedral;
  if (least.degrees >= *g.min_dihedral_deg) return "";
  return text("two triangles meet at ", least.degrees, " degrees near ", exact_place(least.middle));
}

std::string miss_max_deviation(const Gates& g, const Measured& m) {
  const MeshDistance& distance = measured(m.distance, "distance");
  if (distance.largest() <= *g.max_deviation_world) return "";
  if (distance.is_one_way) return text("the points are up to ", distance.from_reference.max, " from the mesh");
  return text("the result is up to ", distance.to_reference.max, " from the input, the input up to ",
              distance.from_reference.max, " from the result");
}

std::string miss_normal_deviation(const Gates& g, const Measured& m) {
  const MeshDistance& distance = measured(m.distance, "deviation of normals");
  if (distance.normal_deviation_deg() <= *g.normal_deviation_deg) return "";
  return text("normals of the result deviate by ", distance.normal_to_reference.mean_deg,
              " degrees on average from the input's, and those of the input by ",
              distance.normal_from_reference.mean_deg, " from the result's");
}

std::string miss_count(const Gates&, const Measured& m) {
  if (!m.count || !m.count->asked) return "no number of vertices was asked for";
  return m.count->is_near() ? "" : m.count->words();
}

std::string miss_features(const Gates&, const Measured& m) {
  if (!m.features || m.features->lost.empty()) return m.features ? m.features->given_up : "";
  const std::vector<LostCurve>& lost = m.features->lost;
  const LostCurve& first = lost.front();
  return text(counted(int64_t(lost.size()), "curve"), " of the input ", lost.size() == 1 ? "is" : "are",
              " lost; the first, a ", first.kind, " of length ", first.length_world, " from ",
              readable_place(first.at, m.frame), ": ", first.reason);
}

std::string miss_kept_edges(const Gates& g, const Measured& m) {
  if (!m.coherence || m.coherence->kept_edges_pct >= *g.kept_edges_pct) return "";
  return text("the frame before has ", m.coherence->kept_edges_pct, " % of the edges");
}

std::string miss_born(const Gates& g, const Measured& m) {
  if (!m.coherence || m.coherence->born <= *g.born) return "";
  return counted(m.coherence->born, "vertex is", "vertices are") + " not where those of the frame before went";
}

/// In the order of their messages.
constexpr GateRow kRows[] = {
    {"closed", "", "", &Gates::closed, {}, GateOf::mesh, miss_closed},
    {"manifold", "", "", &Gates::manifold, {}, GateOf::mesh, miss_manifold},
    {"no-self-intersections", "", "", &Gates::no_self_intersections, {}, GateOf::mesh, miss_no_intersections},
    {"genus", "G", "", &Gates::genus, {}, GateOf::mesh, miss_genus},
    {"components", "N", "", &Gates::components, {}, GateOf::mesh, miss_components},
    {"boundary-loops", "N", "", &Gates::boundary_loops, {}, GateOf::mesh, miss_boundary_loops},
    {"regions",
     "",
     "each is closed, walls are shared, no triangles intersect",
     &Gates::regions,
     {},
     GateOf::mesh,
     miss_regions},
    {"adjacency",
     "",
     "regions that touch in the input share a wall, and no others do",
     &Gates::adjacency,
     {},
     GateOf::input,
     miss_adjacency},
    {"region-volume",
     "PERCENT",
     "by which the volume of a region may differ from the input's",
     &Gates::region_volume_pct,
     {0, 100},
     GateOf::input,
     miss_region_volume},
    {"min-angle", "DEG", "smallest angle in degrees", &Gates::min_angle_deg, {0, 60}, GateOf::mesh, miss_min_angle},
    {"min-dihedral",
     "DEG",
     "smallest angle between triangles with a common edge",
     &Gates::min_dihedral_deg,
     {0, 180},
     GateOf::mesh,
     miss_min_dihedral},
    {"max-deviation",
     "W",
     "distance between result and input in world units",
     &Gates::max_deviation_world,
     {},
     GateOf::distance,
     miss_max_deviation},
    {"normal-deviation",
     "DEG",
     "mean angle between normals of result and input",
     &Gates::normal_deviation_deg,
     {0, 90},
     GateOf::distance,
     miss_normal_deviation},
    {"count", "", "as many vertices as were asked for, to a tenth", &Gates::count, {}, GateOf::request, miss_count},
    {"features", "", "no curve of the input is lost", &Gates::features, {}, GateOf::curves, miss_features},
    {"kept-edges",
     "PERCENT",
     "of a frame that follows another: edges that it keeps, at least",
     &Gates::kept_edges_pct,
     {0, 100},
     GateOf::frame,
     miss_kept_edges},
    {"born",
     "N",
     "of a frame that follows another: vertices that are new, at most",
     &Gates::born,
     {},
     GateOf::frame,
     miss_born},
};

template <class Holds>
bool any_row(Holds holds) {
  return std::any_of(std::begin(kRows), std::end(kRows), holds);
}

bool is_requested(const GateRow& row, const Gates& gates) {
  return std::visit([&](auto member) { return bool(gates.*member); }, row.member);
}

/// As in "genus=3", with the limit as it holds.
std::string requested_text(const GateRow& row, const Gates& gates) {
  return std::visit(
      [&](auto member) -> std::string {
        if constexpr (std::is_same_v<decltype(member), bool Gates::*>)
          return row.name;
        else
          return text(row.name, '=', *(gates.*member));
      },
      row.member);
}

void set(const GateRow& row, const std::string& value, Gates& gates) {
  const std::string shown = std::string("--require ") + row.name;
  std::visit(
      [&](auto member) {
        if constexpr (std::is_same_v<decltype(member), bool Gates::*>) {
          gates.*member = true;
        } else if constexpr (std::is_same_v<decltype(member), std::optional<int64_t> Gates::*>) {
          gates.*member = parse_count(shown, value);
        } else {
          gates.*member = parse_number(shown, value);
          check_range(shown, *(gates.*member), row.range);
        }
      },
      row.member);
}

void set_gate(const std::string& gate, Gates& gates) {
  const size_t equals = gate.find('=');
  const bool has_value = equals != std::string::npos;
  for (const GateRow& row : kRows)
    if (gate.substr(0, equals) == row.name && has_value == (*row.value_name != '\0'))
      return set(row, has_value ? gate.substr(equals + 1) : "", gates);
  refuse("--require has '" + gate + "'; gates are " + listed_gates(false));
}

template <class Holds>
std::string listed(bool with_words, Holds holds) {
  std::string list;
  for (const GateRow& row : kRows) {
    if (!holds(row)) continue;
    list += (list.empty() ? "" : ", ") + std::string(row.name);
    if (*row.value_name) list += std::string("=") + row.value_name;
    if (with_words && *row.words) list += std::string(" (") + row.words + ")";
  }
  return list;
}

}  // namespace

bool Gates::any() const {
  return any_row([&](const GateRow& row) { return is_requested(row, *this); });
}

bool Gates::needs_distance() const {
  return any_row([&](const GateRow& row) { return row.of == GateOf::distance && is_requested(row, *this); });
}

Gates parse_gates(const std::string& list) {
  Gates gates;
  std::istringstream items(list);
  for (std::string gate; std::getline(items, gate, ',');) {
    set_gate(gate, gates);
    gates.requested.push_back(gate);
  }
  return gates;
}

std::string listed_gates(bool with_words) {
  return listed(with_words, [](const GateRow&) { return true; });
}

std::string listed_gates_of_meshes(bool with_words) {
  return listed(with_words, [](const GateRow& row) { return row.of == GateOf::mesh || row.of == GateOf::distance; });
}

void check_gates_of_mesh(const Gates& gates, bool has_reference) {
  for (const GateRow& row : kRows) {
    if (!is_requested(row, gates)) continue;
    const std::string requested = std::string("--require ") + row.name;
    if (row.of == GateOf::curves) refuse(requested + " is for a run that keeps curves; leave it out");
    if (row.of == GateOf::input) refuse(requested + " is for a run, which knows the input's regions; leave it out");
    if (row.of == GateOf::request) refuse(requested + " is for a run, which knows what was asked for; leave it out");
    if (row.of == GateOf::frame) refuse(requested + " is for the frames of a sequence; leave it out");
    if (row.of == GateOf::distance && !has_reference)
      refuse(requested + " compares with a reference; give one by --ref");
  }
}

std::vector<std::string> missed_gates(const Gates& gates, const Measured& m) {
  std::vector<std::string> missed;
  if (gates.any()) topology(m);  // refuses a run that measured nothing
  for (const GateRow& row : kRows) {
    if (!is_requested(row, gates)) continue;
    if (const std::string what = row.miss(gates, m); !what.empty())
      missed.push_back(requested_text(row, gates) + ": " + what);
  }
  return missed;
}

std::vector<std::string> missed_gates(const Gates& gates, const RunRecord& record) {
  const RemeshReport& report = record.report;
  const bool has_regions = record.regions.has_value();
  const int64_t pairs = has_regions ? record.regions->intersecting_pairs : report.optimize.self_intersections;
  Measured m{record.topology, record.quality, record.distance};
  if (report.is_optimized || has_regions) m.self_intersections = pairs;
  if (has_regions) m.regions = &*record.regions;
  const std::optional<RegionChanges> changes = region_changes_of(record);
  if (changes) m.region_changes = &*changes;
  m.features = &report.features;
  m.count = &report.count;
  m.frame = report.grid.frame;
  if (record.options.previous) m.coherence = &report.coherence;
  std::vector<std::string> missed = missed_gates(gates, m);
  const bool is_asked = gates.no_self_intersections || gates.regions;
  if (pairs > 0 && !gates.allow_intersections && !is_asked)
    missed.insert(missed.begin(), "the result intersects itself in " + counted(pairs, "pair", "pairs") +
                                      " of triangles; --allow-intersections takes it as it is");
  for (const WrittenFile& file : record.files)
    if (file.held.lost_triangles > 0) missed.insert(missed.begin(), words_of_lost(file));
  return missed;
}

}  // namespace isoshell
