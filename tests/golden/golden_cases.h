// The cases of the golden file: shapes made by code, options, and what the run gives as text.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/isoshell.h"
#include "support/shapes.h"

namespace isoshell::golden {

struct Case {
  std::string name;
  std::function<TriangleSoup()> shape;
  RemeshOptions options;
};

inline RemeshOptions options(int64_t vertices, int32_t resolution, Method method = Method::sheet,
                             int32_t closing_vox = -1) {
  RemeshOptions o;
  o.vertices = vertices;
  o.resolution = resolution;
  o.method = method;
  o.closing_vox = closing_vox;
  o.want_shell = o.want_digests = true;
  o.features.creases = Features::Creases::off;
  return o;
}

/// Edge lengths that grow along x.
class GrowingLengths final : public SizingField {
 public:
  std::vector<double> lengths_at(const std::vector<WorldPoint>& points) const override {
    std::vector<double> lengths;
    for (const WorldPoint& p : points) lengths.push_back(0.15 + 0.06 * (p.x + 3));
    return lengths;
  }
};

inline RemeshOptions adaptive(RemeshOptions o, double adaptivity) {
  o.adaptivity = adaptivity;
  return o;
}
inline RemeshOptions sized(RemeshOptions o) {
  o.sizing = std::make_shared<GrowingLengths>();
  return o;
}

inline std::vector<Case> cases() {
  using namespace shapes;
  const auto ball = [] { return sphere({0.25, -1, 3}, 1.5, 48); };
  const auto ring = [] { return torus(2, 0.6, 64, 32); };
  const auto block = [] { return box({0, 0, 0}, {3, 2, 1}); };
  const auto pair = [] { return together(torus(2, 0.5, 48, 24), sphere({0, 0, 4}, 1, 32)); };
  const auto wall = [] { return two_sheets(4, 0.5); };
  return {{"sphere", ball, options(500, 64)},
          {"torus", ring, options(1000, 96)},
          {"torus, coarse levels on outlines", ring, options(600, 160)},
          {"torus by curvature", ring, adaptive(options(600, 160), 0.8)},
          {"torus by a field, which decides the count", ring, sized(options(0, 130))},
          {"torus shell", ring, options(1000, 96, Method::shell)},
          {"box", block, options(300, 72)},
          {"torus and sphere", pair, options(900, 100)},
          {"two sheets, closed", wall, options(400, 80, Method::sheet, 6)}};
}

/// One block of text a case: counts with their meaning, then a digest per product.
inline std::string run(const Case& c, Context& context) {
  const RemeshResult result = remesh(c.shape(), c.options, context);
  const RemeshReport& r = result.report;
  std::string text = "case " + c.name + "\n";
  const auto count = [&](const char* name, int64_t value) {
    text += std::string("  ") + name + " " + std::to_string(value) + "\n";
  };
  count("sites", r.sites);
  count("active_voxels", r.active_voxels);
  count("sheet_vertices", r.sheet_vertices);
  count("components", r.sheet.components);
  count("genus", r.sheet.genus);
  count("passes", r.relax.passes);
  count("inserted_seeds", r.dual.inserted_seeds);
  count("failed_cells", r.dual.failed_cells);
  count("vertices", int64_t(result.mesh.vertices.size()));
  count("triangles", int64_t(result.mesh.triangles.size()));
  for (const auto& [product, digest] : r.digests) text += "  digest " + product + " " + digest + "\n";
  return text;
}

}  // namespace isoshell::golden
