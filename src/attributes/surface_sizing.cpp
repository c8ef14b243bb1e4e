// Edge lengths at a surface's vertices as a field (see sizing_vdb.h).
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <sstream>

#include "core/parallel_ranges.h"
#include "geometry/triangle_grid.h"
#include "geometry/triangle_list.h"
#include "isoshell/error.h"
#include "isoshell/io/sizing_vdb.h"

namespace isoshell {
namespace {

class SurfaceSizing final : public SizingField {
 public:
  SurfaceSizing(TriangleSoup surface, std::vector<double> lengths)
      : surface_(std::move(surface)), lengths_(std::move(lengths)), grid_(surface_.vertices, surface_.triangles) {}

  std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const override {
    std::vector<double> out(points.size());
    for_each_index(size_t(0), points.size(), [&](size_t i) {
      const MeshPoint place = grid_.nearest(points[i]);
      const std::array<uint32_t, 3>& t = surface_.triangles[place.triangle];
      const double length = interpolate(place, lengths_[t[0]], lengths_[t[1]], lengths_[t[2]]);
      out[i] = std::isnan(length) ? 0 : length;
    });
    return out;
  }

 private:
  const TriangleSoup surface_;
  const std::vector<double> lengths_;
  const TriangleGrid grid_;
};

[[noreturn]] void refuse(ErrorCode code, const std::string& message) { throw Error(code, "sizing", message); }

void check_lengths(const std::vector<double>& lengths, const std::string& name) {
  bool says_something = false;
  for (size_t v = 0; v < lengths.size(); ++v) {
    if (std::isnan(lengths[v])) continue;
    says_something = true;
    if (lengths[v] > 0 && std::isfinite(lengths[v])) continue;
    std::ostringstream text;
    text << name << "[" << v << "] is " << lengths[v]
         << "; edge lengths are finite and more than 0, in world units, or NaN where nothing is asked for";
    refuse(ErrorCode::unreadable_input, text.str());
  }
  if (!says_something)
    refuse(ErrorCode::unreadable_input, name + " has no edge length; give one at some of the vertices at least");
}

}  // namespace

std::shared_ptr<const SizingField> sizing_on(const TriangleSoup& surface, std::vector<double> lengths,
                                             const std::string& name) {
  if (lengths.size() != surface.vertices.size())
    refuse(ErrorCode::usage, name + " has " + std::to_string(lengths.size()) + " edge lengths for " +
                                 std::to_string(surface.vertices.size()) + " vertices; give one a vertex");
  check_lengths(lengths, name);
  TriangleSoup usable;
  usable.vertices = surface.vertices;
  const auto is_placed = [&](uint32_t v) { return is_finite(surface.vertices[v]); };
  std::copy_if(surface.triangles.begin(), surface.triangles.end(), std::back_inserter(usable.triangles),
               [&](const auto& t) { return std::all_of(t.begin(), t.end(), is_placed); });
  if (usable.triangles.empty()) refuse(ErrorCode::nothing_to_mesh, name + ": the surface has no triangle");
  return std::make_shared<SurfaceSizing>(std::move(usable), std::move(lengths));
}

bool is_sizing_file(const std::string& text) {
  constexpr const char* kEnding = ".vdb";
  const size_t at = text.rfind(kEnding);
  return at != std::string::npos && (at + 4 == text.size() || text[at + 4] == ':');
}

std::shared_ptr<const SizingField> sizing_of_attribute(const TriangleSoup& surface, const std::string& name,
                                                       const std::string& surface_name) {
  std::string others;
  for (const Attribute& a : surface.attributes) {
    if (a.domain != AttributeDomain::vertex || a.components != 1 || !a.labels.empty()) continue;
    if (a.name == name) return sizing_on(surface, a.values, name);
    others += (others.empty() ? "" : ", ") + a.name;
  }
  refuse(ErrorCode::usage, "--sizing names '" + name + "', which is no .vdb file and no number of the vertices of " +
                               surface_name + "; these have: " + (others.empty() ? "none" : others));
}

}  // namespace isoshell
