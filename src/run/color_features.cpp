// color_features (see color_features.h).
#include "run/color_features.h"

#include <algorithm>
#include <array>

namespace isoshell {
namespace {

using Color = std::array<double, 3>;

constexpr Color kCurve{0, 0, 0}, kCorner{255, 0, 0};

/// Light colours; those of successive numbers are far apart.
Color color_of_patch(uint32_t patch) {
  constexpr uint32_t kGoldenTurn = 2654435769u;  // of 2^32
  constexpr uint32_t kDark = 96, kRange = 160;
  const uint32_t hue = uint32_t(patch * kGoldenTurn) >> 16;  // of 2^16
  const auto part = [&](uint32_t shift) {
    const uint32_t at = (hue + shift) % 65536;
    const uint32_t rise = at < 32768 ? at : 65535 - at;
    return double(kDark + kRange * rise / 32768);
  };
  return {part(0), part(21845), part(43690)};
}

Attribute make_color(AttributeDomain domain, const std::vector<Color>& colors) {
  Attribute a{kColorName, NumberType::u8, 3, {}, domain};
  for (const Color& c : colors) a.values.insert(a.values.end(), c.begin(), c.end());
  return a;
}

void drop_colors(TriangleMesh& mesh, AttributeReport& report) {
  auto& all = mesh.attributes;
  const auto is_color = [](const Attribute& a) { return a.name == kColorName; };
  if (std::none_of(all.begin(), all.end(), is_color)) return;
  all.erase(std::remove_if(all.begin(), all.end(), is_color), all.end());
  report.kept.erase(std::remove(report.kept.begin(), report.kept.end(), kColorName), report.kept.end());
  report.dropped.push_back({kColorName, "the colours show the features"});
}

}  // namespace

void color_features(TriangleMesh& mesh, AttributeReport& report, const Tell& tell) {
  const MeshFeatures& features = mesh.features;
  if (features.patch.empty()) return tell(MessageKind::warning, "the result has no curves that colours could show");
  drop_colors(mesh, report);
  std::vector<Color> of_face, of_vertex(mesh.vertices.size());
  for (size_t t = 0; t < mesh.triangles.size(); ++t) {
    of_face.push_back(color_of_patch(features.patch[t]));
    for (const uint32_t v : mesh.triangles[t]) of_vertex[v] = of_face.back();
  }
  for (const MeshCurveEdge& e : features.curve_edges)
    for (const uint32_t v : e.vertex) of_vertex[v] = kCurve;
  for (const uint32_t v : features.corners) of_vertex[v] = kCorner;
  mesh.attributes.push_back(make_color(AttributeDomain::vertex, of_vertex));
  mesh.attributes.push_back(make_color(AttributeDomain::face, of_face));
}

}  // namespace isoshell
