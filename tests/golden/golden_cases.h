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

#include "golden/golden_inputs.h"
#include "isoshell/advanced/digest.h"
#include "isoshell/io/memory_input.h"
#include "isoshell/io/mesh_file.h"
#include "isoshell/isoshell.h"
#include "isoshell/run/sequence.h"
#include "regions/label_volumes.h"
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
  std::function<Input(int frame)> input;
  RemeshOptions options;
  int frames = 1;  ///< each begins with the one before; the last one counts
};

/// The level set of a whole run, with the default band.
struct LevelSetCase {
  std::string name;
  std::function<Input()> input;
  LevelSetOf of = LevelSetOf::input;
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

inline RemeshOptions defaults(int64_t vertices) {
  RemeshOptions o;
  o.vertices = vertices;
  return o;
}

inline RemeshOptions keeping_borders(RemeshOptions o) {
  o.boundary = Boundary::keep;
  return o;
}
inline RemeshOptions parted(RemeshOptions o, const char* regions) {
  o.regions = regions;
  return o;
}

/// What is the same in every frame.
template <class Shape>
std::function<Input(int)> still(Shape shape) {
  return [shape](int) { return input_of(shape(), "shape"); };
}
inline std::function<Input(int)> points(const PointCloud& cloud) {
  return [cloud](int) { return input_of(cloud, "points", 0); };
}
inline std::function<Input(int)> labels(const LabelVolume& volume) {
  return [volume](int) { return input_of(volume, "labels", Context()); };
}

inline std::vector<RunCase> run_cases() {
  const auto block = [] { return shapes::box({0, 0, 0}, {3, 2, 1}); };
  const auto scan = [] { return read_mesh(source_folder() + "/tests/data/nefertiti.ply"); };
  const auto inward = [] { return shapes::inside_out(shapes::box({0, 0, 0}, {3, 2, 1})); };
  RemeshOptions borders = keeping_borders(defaults(500));
  borders.closing_vox = 0;
  return {{"a part keeps its creases", still(block), defaults(400)},
          {"a scan has none", still(scan), defaults(1200)},
          {"borders are kept", still(half_torus), borders},
          {"attributes are carried over and seams kept", still(painted_torus), defaults(500)},
          {"a frame begins with the one before", [](int frame) { return input_of(twisted_torus(frame), "shape"); },
           defaults(500), 2},
          {"a border ends creases", still(open_box), keeping_borders(defaults(500))},
          {"a dirty mesh is repaired", still(dirty_torus), defaults(800)},
          {"solids that cross are united, with creases", still(crossing_boxes), defaults(800)},
          {"walls between blocks go", still([] { return blocks(3); }), defaults(500)},
          {"a part that looks inward is turned", still(inward), defaults(400)},
          {"of two that overlap one looks inward", still(mixed_boxes), defaults(600)},
          {"patches of a thin wall are simplified", still([] { return bent_plate(1.5, 0.01); }), defaults(100)},
          {"patches of a thinner wall are simplified", still([] { return bent_plate(0.5, 0.004); }), defaults(100)},
          {"a wall too thin for its count loses its least creases", still([] { return bent_plate(0.5, 0.004); }),
           defaults(20)},
          {"points without normals", points(points_of_torus(3000)), defaults(800)},
          {"points of a sharp body", points(points_of_box({30, 20, 10})), defaults(600)},
          {"grains of a volume of labels", labels(voronoi_grains(64, 20)), defaults(3000)},
          {"labels whose walls are mended", labels(random_labels(38)), defaults(500)},
          {"walls that make cells", still(box_with_walls), parted(defaults(800), "cells")},
          {"parts that touch", still([] { return pin_in_a_plate(); }), parted(defaults(800), "components")},
          {"faces with regions", still(labelled_cubes), defaults(500)}};
}

inline std::vector<LevelSetCase> level_set_cases() {
  const auto scan = [] { return input_of(read_mesh(source_folder() + "/tests/data/nefertiti.ply"), "scan"); };
  const auto dirty = [] { return input_of(dirty_torus(), "shape"); };
  return {{"a closed scan", scan},
          {"a mesh with holes, flipped and doubled faces", dirty},
          {"a volume of distances", distances_to_torus},
          {"the result of a mesh with holes", dirty, LevelSetOf::result}};
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

/// FNV-1a of the numbers' bits.
inline std::string digest_of(const std::vector<double>& values) {
  uint64_t hash = 14695981039346656037u;
  for (const double value : values) {
    uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 1099511628211u;
  }
  return digest_text(hash);
}

inline std::string text_of(const FaceRegions& regions, const RegionCensus& census) {
  std::vector<double> labels;
  for (const auto& [behind, front] : regions.labels) labels.insert(labels.end(), {double(behind), double(front)});
  return "  regions " + std::to_string(census.regions.size()) + "\n  walls " + std::to_string(census.walls.size()) +
         "\n  labels " + digest_of(labels) + "\n";
}

/// The same of a whole run: what it kept, and a digest of the mesh, of each attribute and of each product.
inline std::string run(const RunCase& c, Context& context) {
  FrameChain chain;
  RunResult result;
  for (int frame = 0; frame < c.frames; ++frame) {
    RunRequest request;
    request.options = requested_options(c.options);
    request.measures = Measures::all;
    result = chain.run(c.input(frame), request, context);
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
  if (!result.mesh.regions.empty()) text += text_of(result.mesh.regions, *result.record.regions);
  for (const Attribute& a : result.mesh.attributes) text += "  attribute " + a.name + " " + digest_of(a.values) + "\n";
  for (const auto& [product, digest] : r.digests) text += "  digest " + product + " " + digest + "\n";
  return text;
}

inline std::string run(const LevelSetCase& c, Context& context) {
  RunRequest request;
  request.options = requested_options(options(500, 96));
  request.level_set.of = c.of;
  request.level_set.keep = true;
  if (c.of == LevelSetOf::input) request.stop_after = StopAfter::level_set;  // no mesh is needed
  const RunResult result = isoshell::run(c.input(), request, context);
  const View<const float> distances = result.level_set->distance_vox.view();
  const int64_t inside = std::count_if(distances.begin(), distances.end(), [](float d) { return d < 0; });
  return "level set of " + c.name + "\n  voxels " + std::to_string(distances.size) + "\n  inside " +
         std::to_string(inside) + "\n  digest " + digest_text(digest(*result.level_set)) + "\n";
}

/// The golden file as it is now.
inline std::string all(Context& context) {
  std::string text;
  for (const Case& c : cases()) text += run(c, context);
  for (const RunCase& c : run_cases()) text += run(c, context);
  for (const LevelSetCase& c : level_set_cases()) text += run(c, context);
  return text;
}

}  // namespace isoshell::golden
