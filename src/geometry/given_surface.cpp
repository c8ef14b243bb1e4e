#include "geometry/given_surface.h"

#include <sstream>

#include "core/attribute_values.h"
#include "geometry/triangle_list.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

[[noreturn]] void refuse(const std::string& message) { throw Error(ErrorCode::unreadable_input, "read", message); }

}  // namespace

void check_surface(const TriangleSoup& soup, const std::string& name) {
  for (size_t t = 0; t < soup.triangles.size(); ++t)
    for (const uint32_t v : soup.triangles[t]) {
      if (v < soup.vertices.size() && is_finite(soup.vertices[v])) continue;
      std::ostringstream text;
      text << name << ": triangle " << t << " has vertex " << v;
      if (v < soup.vertices.size()) {
        const WorldPoint& p = soup.vertices[v];
        text << " at (" << p.x << ", " << p.y << ", " << p.z << "); positions must be finite";
      } else {
        text << " of a surface of " << counted(int64_t(soup.vertices.size()), "vertex", "vertices")
             << "; indices count from 0 and are below that";
      }
      refuse(text.str());
    }
  if (!soup.regions.empty() && soup.regions.labels.size() != soup.triangles.size())
    refuse(name + ": there are regions of " + std::to_string(soup.regions.labels.size()) + " faces for " +
           std::to_string(soup.triangles.size()) + " triangles; give two labels a triangle");
  if (!soup.regions.side.empty() && soup.regions.side.size() != soup.triangles.size())
    refuse(name + ": there are sides of " + std::to_string(soup.regions.side.size()) + " faces for " +
           std::to_string(soup.triangles.size()) + " triangles; give one a triangle, or none at all");
  for (const Attribute& a : soup.attributes)
    if (const std::string misfit = misfit_of(a, soup.vertices.size(), soup.triangles.size()); !misfit.empty())
      refuse(name + ": " + misfit);
}

TriangleSoup surface_of(const TriangleMesh& mesh) {
  TriangleSoup soup;
  soup.vertices = mesh.vertices;
  soup.triangles = mesh.triangles;
  soup.faces_in_file = int64_t(mesh.triangles.size());
  soup.attributes = mesh.attributes;
  soup.files = mesh.files;
  soup.regions = mesh.regions;
  check_surface(soup, "the mesh");
  return soup;
}

}  // namespace isoshell
