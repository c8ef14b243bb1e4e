// See parts.h.
#include "repair/regions/parts.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <sstream>

#include "core/index_sets.h"
#include "core/watched.h"
#include "geometry/half_edges.h"
#include "geometry/weld.h"
#include "isoshell/error.h"
#include "measure/around_edge.h"

namespace isoshell::repair {
namespace {

/// The attribute of one value a face, or null.
const Attribute* find_of_faces(const TriangleSoup& soup, const std::string& name) {
  for (const Attribute& a : soup.attributes)
    if (a.name == name && a.domain == AttributeDomain::face && a.components == 1) return &a;
  return nullptr;
}

/// "groups" may be either.
const Attribute* find_groups(const TriangleSoup& soup) {
  const Attribute* const groups = find_of_faces(soup, kGroupName);
  return groups ? groups : find_of_faces(soup, kObjectName);
}

std::string name_of_value(const Attribute& attribute, double value) {
  if (!attribute.labels.empty())
    return value >= 0 && value < double(attribute.labels.size()) ? attribute.labels[size_t(value)] : "";
  std::ostringstream text;
  text.precision(17);
  text << value;
  return text.str();
}

[[noreturn]] void refuse_attribute(const TriangleSoup& soup, const std::string& asked) {
  std::string list;
  for (const Attribute& a : soup.attributes)
    if (a.domain == AttributeDomain::face && a.components == 1) list += (list.empty() ? "" : ", ") + a.name;
  throw Error(ErrorCode::usage, "regions",
              (asked == "groups" ? std::string("--regions groups: the faces have no groups and no objects")
                                 : "--regions " + asked + ": the faces have no attribute of one number of that name") +
                  "; " + (list.empty() ? "they have no attribute" : "what they have is " + list) +
                  ", and components and cells need none");
}

/// Of an edge of more than two triangles joins those that have a solid between them, which both of them face away from.
/// Triangles whose corners lie on a line join nothing there.
void join_solids_at(const std::vector<WorldPoint>& points, const std::vector<std::array<uint32_t, 3>>& triangles,
                    uint32_t u, uint32_t v, View<const EdgeSide> at_edge, IndexSets& sets) {
  std::vector<TriangleAtEdge> around = triangles_at_edge(triangles, u, at_edge);
  leave_out_flat(points, u, v, around);
  if (around.empty()) return;
  if (around.size() == 2) sets.unite(around[0].triangle, around[1].triangle);
  sort_around_edge(points, u, v, around);
  for (size_t i = 0; i < around.size(); ++i) {
    const TriangleAtEdge &here = around[i], &next = around[(i + 1) % around.size()];
    if (!here.rises && next.rises) sets.unite(here.triangle, next.triangle);
  }
}

void join_at(const std::vector<WorldPoint>& points, const std::vector<std::array<uint32_t, 3>>& triangles, uint32_t u,
             uint32_t v, View<const EdgeSide> at_edge, IndexSets& sets) {
  if (at_edge.size == 2) sets.unite(at_edge[0].half_edge / 3, at_edge[1].half_edge / 3);
  if (at_edge.size > 2) join_solids_at(points, triangles, u, v, at_edge, sets);
}

/// Joins across edges that lie on one another, of those half-edges that are alone on theirs. The others are left as
/// they are: which faces of solids that touch belong together is known from their vertices, even where these faces do
/// not agree about the outside.
void join_borders(const TriangleSoup& soup, const std::vector<uint8_t>& is_alone, const Context& context,
                  IndexSets& sets) {
  const WeldedVertices welded = weld_vertices(soup.vertices, soup.triangles);
  std::vector<std::array<uint32_t, 3>> placed = soup.triangles;
  for (auto& t : placed)
    for (uint32_t& v : t) v = welded.place[v];
  const auto is_kept = [&](const EdgeSide& s) {
    const auto& [a, b, c] = placed[s.half_edge / 3];
    return is_alone[s.half_edge] && a != b && b != c && c != a;
  };
  std::vector<EdgeSide> kept;
  CancelWatch watch(context, "regions");
  for_each_edge(find_edge_sides(placed, welded.position.size()),
                [&](uint32_t u, uint32_t v, View<const EdgeSide> at_edge) {
                  watch.check();
                  kept.clear();
                  for (const EdgeSide& s : at_edge)
                    if (is_kept(s)) kept.push_back(s);
                  join_at(welded.position, placed, u, v, {kept.data(), int64_t(kept.size())}, sets);
                });
}

/// Faces by the component that they are of.
IndexSets join_faces(const TriangleSoup& soup, const Context& context) {
  IndexSets sets(int64_t(soup.triangles.size()));
  std::vector<uint8_t> is_alone(3 * soup.triangles.size(), 0);
  bool have_borders = false;
  CancelWatch watch(context, "regions");
  for_each_edge(find_edge_sides(soup.triangles, soup.vertices.size()),
                [&](uint32_t u, uint32_t v, View<const EdgeSide> at_edge) {
                  watch.check();
                  join_at(soup.vertices, soup.triangles, u, v, at_edge, sets);
                  if (at_edge.size > 1) return;
                  is_alone[at_edge[0].half_edge] = 1;
                  have_borders = true;
                });
  if (have_borders) join_borders(soup, is_alone, context, sets);
  return sets;
}

/// Per part the name that all of its faces have.
std::vector<std::string> common_names(const Attribute& groups, const Parts& parts, size_t count) {
  std::vector<double> value(count, -1);
  std::vector<uint8_t> is_seen(count, 0), is_mixed(count, 0);
  for (size_t f = 0; f < parts.of_face.size(); ++f) {
    const uint32_t part = parts.of_face[f];
    if (!is_seen[part]) value[part] = groups.values[f];
    is_mixed[part] |= uint8_t(value[part] != groups.values[f]);
    is_seen[part] = 1;
  }
  std::vector<std::string> names(count);
  for (size_t p = 0; p < count; ++p)
    if (!is_mixed[p]) names[p] = name_of_value(groups, value[p]);
  return names;
}

}  // namespace

Parts find_components(const TriangleSoup& soup, const Context& context) {
  IndexSets sets = join_faces(soup, context);
  Parts parts;
  uint32_t count = 0;
  parts.of_face = sets.numbers(count);
  parts.name.resize(count);
  const Attribute* const groups = find_groups(soup);
  if (groups && !groups->labels.empty()) parts.name = common_names(*groups, parts, count);
  return parts;
}

Parts find_parts_by(const TriangleSoup& soup, const std::string& attribute) {
  const Attribute* const values = attribute == "groups" ? find_groups(soup) : find_of_faces(soup, attribute);
  if (!values) refuse_attribute(soup, attribute);
  Parts parts;
  std::map<double, uint32_t> number;
  for (const double value : values->values) {
    const double key = std::isnan(value) ? -1 : value;
    const auto [at, is_new] = number.emplace(key, uint32_t(parts.name.size()));
    if (is_new) parts.name.push_back(name_of_value(*values, key));
    parts.of_face.push_back(at->second);
  }
  return parts;
}

}  // namespace isoshell::repair
