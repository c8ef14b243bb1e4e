// See parts.h.
#include "repair/regions/parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <map>
#include <sstream>

#include "core/index_sets.h"
#include "geometry/half_edges.h"
#include "isoshell/error.h"
#include "measure/around_edge.h"

namespace isoshell::repair {
namespace {

constexpr uint32_t kNone = 0xffffffff;

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
void join_solids_at(const TriangleSoup& soup, uint32_t u, uint32_t v, View<const EdgeSide> at_edge, IndexSets& sets) {
  std::vector<TriangleAtEdge> around;
  for (const EdgeSide& s : at_edge) {
    const auto& corner = soup.triangles[s.half_edge / 3];
    around.push_back({s.half_edge / 3, corner[(s.half_edge % 3 + 2) % 3], corner[s.half_edge % 3] == u});
  }
  sort_around_edge(soup.vertices, u, v, around);
  for (size_t i = 0; i < around.size(); ++i) {
    const TriangleAtEdge &here = around[i], &next = around[(i + 1) % around.size()];
    if (!here.rises && next.rises) sets.unite(here.triangle, next.triangle);
  }
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

Parts find_components(const TriangleSoup& soup) {
  IndexSets sets(int64_t(soup.triangles.size()));
  for_each_edge(find_edge_sides(soup.triangles, soup.vertices.size()),
                [&](uint32_t u, uint32_t v, View<const EdgeSide> at_edge) {
                  if (at_edge.size == 2) sets.unite(at_edge[0].half_edge / 3, at_edge[1].half_edge / 3);
                  if (at_edge.size > 2) join_solids_at(soup, u, v, at_edge, sets);
                });
  Parts parts;
  std::vector<uint32_t> number(soup.triangles.size(), kNone);
  uint32_t count = 0;
  for (uint32_t f = 0; f < soup.triangles.size(); ++f) {
    uint32_t& part = number[sets.root(f)];
    if (part == kNone) part = count++;
    parts.of_face.push_back(part);
  }
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
