// The cases of the golden file: shapes made by code, options, and what the run gives as text.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "isoshell/advanced/digest.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/isoshell.h"
#include "isoshell/run/sequence.h"
#include "support/shapes.h"
#include "support/source_folder.h"

namespace isoshell::golden {

/// Stages alone, on a given grid and without creases.
struct Case {
  std::string name;
  std::function<TriangleSoup()> shape;
  RemeshOptions options;
};

/// A whole run as a user has it, where nothing but the count and what is said here differs from the defaults.
struct RunCase {
  std::string name;
  std::function<TriangleSoup(int frame)> shape;
  RemeshOptions options;
  int frames = 1;  ///< each begins with the one before; the last one counts
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

/// A torus that is twisted about its axis, more from frame to frame.
inline TriangleSoup twisted_torus(int frame) {
  TriangleSoup soup = shapes::torus(2, 0.7, 64, 32);
  for (WorldPoint& p : soup.vertices) {
    const double angle = 0.06 * frame * p.x;
    p = {p.x, p.y * std::cos(angle) - p.z * std::sin(angle), p.y * std::sin(angle) + p.z * std::cos(angle)};
  }
  return soup;
}

/// A torus with a colour at its vertices, and texture coordinates that jump where its angles begin again.
inline TriangleSoup painted_torus() {
  constexpr double kTau = 6.283185307179586;
  TriangleSoup soup = shapes::torus(2, 0.7, 64, 32);
  Attribute color{"color", NumberType::u8, 3, {}}, uv{"uv", NumberType::f32, 2, {}, AttributeDomain::corner};
  for (const WorldPoint& p : soup.vertices)
    color.values.insert(color.values.end(), {(p.x + 3) / 6, (p.y + 3) / 6, (p.z + 1) / 2});
  for (const auto& t : soup.triangles) {
    std::array<std::array<double, 2>, 3> corner;
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint p = soup.vertices[t[i]];
      corner[i] = {std::atan2(p.y, p.x) / kTau, std::atan2(p.z, std::hypot(p.x, p.y) - 2) / kTau};
    }
    for (size_t axis = 0; axis < 2; ++axis) {
      const double most = std::max({corner[0][axis], corner[1][axis], corner[2][axis]});
      for (auto& c : corner) c[axis] += c[axis] < most - 0.5 ? 1 : 0;
    }
    for (const auto& c : corner) uv.values.insert(uv.values.end(), c.begin(), c.end());
  }
  soup.attributes = {color, uv};
  return soup;
}

/// The part of a torus where x is above 0: two borders.
inline TriangleSoup half_torus() {
  TriangleSoup soup = shapes::torus(2, 0.6, 64, 32);
  std::vector<std::array<uint32_t, 3>> kept;
  for (const auto& t : soup.triangles)
    if (soup.vertices[t[0]].x > 0 && soup.vertices[t[1]].x > 0 && soup.vertices[t[2]].x > 0) kept.push_back(t);
  soup.triangles = kept;
  return soup;
}

inline RemeshOptions defaults(int64_t vertices) {
  RemeshOptions o;
  o.vertices = vertices;
  return o;
}

inline std::vector<RunCase> run_cases() {
  const auto block = [](int) { return shapes::box({0, 0, 0}, {3, 2, 1}); };
  const auto scan = [](int) { return read_mesh(source_folder() + "/tests/data/nefertiti.ply"); };
  const auto open = [](int) { return half_torus(); };
  RemeshOptions borders = defaults(500);
  borders.boundary = Boundary::keep;
  borders.closing_vox = 0;
  return {{"a part keeps its creases", block, defaults(400)},
          {"a scan has none", scan, defaults(1200)},
          {"borders are kept", open, borders},
          {"attributes are carried over and seams kept", [](int) { return painted_torus(); }, defaults(500)},
          {"a frame begins with the one before", twisted_torus, defaults(500), 2}};
}

/// One block of text a case: counts with their meaning, then a digest per product.
inline std::string run(const Case& c, Context& context) {
  const RemeshResult result = remesh(c.shape(), c.options, context);
  const RemeshReport& r = result.report;
  std::string text = "case " + c.name + "\n";
  const auto count = [&](const char* name, int64_t value) {
    text += std::string("  ") + name + " " + std::to_string(value) + "\n";
  };
  count("sites", r.grid.sites);
  count("active_voxels", r.grid.active_voxels);
  count("sheet_vertices", r.sheet.vertices);
  count("components", r.sheet.topology.components);
  count("genus", r.sheet.topology.genus);
  count("passes", r.relax.passes);
  count("inserted_seeds", r.dual.inserted_seeds);
  count("failed_cells", r.dual.failed_cells);
  count("vertices", int64_t(result.mesh.vertices.size()));
  count("triangles", int64_t(result.mesh.triangles.size()));
  for (const auto& [product, digest] : r.digests) text += "  digest " + product + " " + digest + "\n";
  return text;
}

/// The same of a whole run: what it kept, and a digest of the mesh, of each attribute and of each product.
inline std::string run(const RunCase& c, Context& context) {
  FrameChain chain;
  RunResult result;
  for (int frame = 0; frame < c.frames; ++frame) {
    RunRequest request;
    request.options = requested_options(c.options);
    request.measures = Measures::all;
    result = chain.run(input_of(c.shape(frame), "shape"), request, context);
  }
  const RemeshReport& r = result.record.report;
  std::string text = "run " + c.name + "\n";
  const auto count = [&](const char* name, int64_t value) {
    text += std::string("  ") + name + " " + std::to_string(value) + "\n";
  };
  count("vertices", int64_t(result.mesh.vertices.size()));
  count("triangles", int64_t(result.mesh.triangles.size()));
  count("curves", r.features.kept ? r.features.curves : 0);
  count("seams", r.features.seams);
  count("corners", int64_t(result.mesh.features.corners.size()));
  count("border_loops", r.features.border_loops);
  count("began_warm", r.coherence.began_warm);
  for (const Attribute& a : result.mesh.attributes) {
    uint64_t hash = 14695981039346656037u;  // FNV-1a of the values' bits
    for (const double value : a.values) {
      uint64_t bits;
      std::memcpy(&bits, &value, sizeof bits);
      hash = (hash ^ bits) * 1099511628211u;
    }
    text += "  attribute " + a.name + " " + digest_text(hash) + "\n";
  }
  for (const auto& [product, digest] : r.digests) text += "  digest " + product + " " + digest + "\n";
  return text;
}

}  // namespace isoshell::golden
