// One region as a mesh of its own.
#include <algorithm>
#include <string>
#include <utility>

#include "isoshell/error.h"
#include "isoshell/region_census.h"
#include "measure/region_surface.h"

namespace isoshell {
namespace {

constexpr size_t kMostNamed = 20;  ///< labels in a message

std::string listed_labels(const TriangleMesh& mesh) {
  const std::vector<int32_t> labels = region_labels(mesh);
  std::string list;
  for (size_t i = 0; i < std::min(labels.size(), kMostNamed); ++i) {
    const std::string name = region_name(mesh.regions, labels[i]);
    list += (i > 0 ? ", " : "") + std::to_string(labels[i]) + (name.empty() ? "" : " (" + name + ")");
  }
  if (labels.size() > kMostNamed) list += " and " + std::to_string(labels.size() - kMostNamed) + " more";
  return list;
}

std::vector<uint32_t> faces_with(const TriangleMesh& mesh, int32_t label) {
  std::vector<uint32_t> faces;
  const auto& labels = mesh.regions.labels;
  for (uint32_t f = 0; f < labels.size(); ++f)
    if (label != mesh.regions.background && !is_of_sheet(labels[f]) && (labels[f][0] == label || labels[f][1] == label))
      faces.push_back(f);
  if (faces.empty())
    throw Error(ErrorCode::usage, "regions",
                "the mesh has no region " + std::to_string(label) + "; its regions are " + listed_labels(mesh));
  return faces;
}

/// Gives every fan of faces a vertex of its own: `surface.vertex` then has those that were parted several times.
void part_fans_of(const std::vector<WorldPoint>& points, RegionSurface& surface) {
  RegionComplex complex = complex_of(surface, points);
  std::vector<std::pair<uint32_t, uint32_t>> fans;  // a vertex and the first corner
  for (uint32_t c = 0; c < 3 * surface.triangles.size(); ++c)
    if (complex.fans.root(c) == c) fans.push_back({surface.triangles[c / 3][c % 3], c});
  std::sort(fans.begin(), fans.end());
  std::vector<uint32_t> number(3 * surface.triangles.size()), vertex;
  for (const auto& [v, corner] : fans) {
    number[corner] = uint32_t(vertex.size());
    vertex.push_back(surface.vertex[v]);
  }
  for (uint32_t c = 0; c < number.size(); ++c) surface.triangles[c / 3][c % 3] = number[complex.fans.root(c)];
  surface.vertex = std::move(vertex);
}

/// The values of some things of the whole mesh.
std::vector<double> values_of(const Attribute& attribute, const std::vector<uint32_t>& things) {
  const size_t n = size_t(attribute.components);
  std::vector<double> values;
  values.reserve(n * things.size());
  for (const uint32_t thing : things)
    values.insert(values.end(), attribute.values.begin() + int64_t(n * thing),
                  attribute.values.begin() + int64_t(n * (thing + 1)));
  return values;
}

/// Values that corners share stay shared, but by faces that point to both sides of a normal.
void take_corners(const Attribute& attribute, const RegionSurface& surface, Attribute& taken) {
  const bool turns = means(attribute, kNormalName);
  std::vector<uint64_t> used;  // twice the value's number, and one more where it is turned
  used.reserve(3 * surface.face.size());
  for (size_t t = 0; t < surface.face.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const size_t corner = 3 * size_t(surface.face[t]) + corner_before_turn(i, surface.is_turned[t]);
      const uint64_t value = attribute.index.empty() ? corner : attribute.index[corner];
      used.push_back(2 * value + (turns && surface.is_turned[t] ? 1 : 0));
    }
  std::vector<uint64_t> kept = used;
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  taken.index.reserve(used.size());
  for (const uint64_t u : used)
    taken.index.push_back(uint32_t(std::lower_bound(kept.begin(), kept.end(), u) - kept.begin()));
  std::vector<uint32_t> values;
  for (const uint64_t k : kept) values.push_back(uint32_t(k / 2));
  taken.values = values_of(attribute, values);
  const size_t n = size_t(attribute.components);
  for (size_t i = 0; i < kept.size(); ++i)
    for (size_t c = 0; c < (kept[i] % 2 == 1 ? n : 0); ++c) taken.values[n * i + c] = -taken.values[n * i + c];
}

Attribute taken_along(const Attribute& attribute, const RegionSurface& surface) {
  Attribute taken{attribute.name, attribute.type, attribute.components, {}, attribute.domain, {}, attribute.labels};
  if (attribute.domain == AttributeDomain::corner)
    take_corners(attribute, surface, taken);
  else
    taken.values = values_of(attribute, attribute.domain == AttributeDomain::face ? surface.face : surface.vertex);
  return taken;
}

}  // namespace

TriangleMesh region_of(const TriangleMesh& mesh, int32_t label) {
  require_regions(mesh);
  RegionSurface surface = surface_of_region(mesh, label, faces_with(mesh, label));
  part_fans_of(mesh.vertices, surface);
  TriangleMesh region;
  region.vertices.reserve(surface.vertex.size());
  for (const uint32_t v : surface.vertex) region.vertices.push_back(mesh.vertices[v]);
  if (!mesh.gap.empty())
    for (const uint32_t v : surface.vertex) region.gap.push_back(mesh.gap[v]);
  for (const Attribute& attribute : mesh.attributes) region.attributes.push_back(taken_along(attribute, surface));
  region.files = mesh.files;
  region.triangles = std::move(surface.triangles);
  return region;
}

}  // namespace isoshell
