// Sheets that relaxation is tested on.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "stages/labels/label_body.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"

namespace isoshell {

inline Sheet torus_sheet() { return sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1); }

/// With lengths that grow along x from 1 to `ratio`.
inline Sheet with_lengths(Sheet sheet, uint32_t ratio) {
  EdgeLengths& lengths = sheet.lengths;
  int32_t lo = INT32_MAX, hi = 0;
  for (const PointQ8& p : sheet.position) lo = std::min(lo, p.x), hi = std::max(hi, p.x);
  lengths.least = 1000;
  lengths.largest = 1000 * ratio;
  lengths.at = Buffer<uint32_t>(sheet.vertex_count());
  for (int64_t v = 0; v < sheet.vertex_count(); ++v)
    lengths.at[v] = 1000 + uint32_t(int64_t(1000) * (ratio - 1) * (sheet.position[v].x - lo) / (hi - lo));
  return sheet;
}

/// A plate two voxels thick: two walls with opposite normals, and a rim that makes it a closed manifold as sheets are.
inline Sheet plate_sheet() {
  TriangleSoup s;
  const int n = 41;
  for (int k = 0; k < 2; ++k)
    for (int i = 0; i < n; ++i)
      for (int j = 0; j < n; ++j) s.vertices.push_back({i * 0.1, j * 0.1, k * 0.07});
  const auto at = [&](int k, int i, int j) { return uint32_t((k * n + i) * n + j); };
  for (int i = 0; i + 1 < n; ++i)
    for (int j = 0; j + 1 < n; ++j) {
      s.triangles.push_back({at(1, i, j), at(1, i + 1, j), at(1, i + 1, j + 1)});
      s.triangles.push_back({at(1, i, j), at(1, i + 1, j + 1), at(1, i, j + 1)});
      s.triangles.push_back({at(0, i, j), at(0, i + 1, j + 1), at(0, i + 1, j)});
      s.triangles.push_back({at(0, i, j), at(0, i, j + 1), at(0, i + 1, j + 1)});
    }
  const int e = n - 1;
  const auto add_rim = [&](int i, int j, int to_i, int to_j) {
    s.triangles.push_back({at(1, to_i, to_j), at(1, i, j), at(0, i, j)});
    s.triangles.push_back({at(1, to_i, to_j), at(0, i, j), at(0, to_i, to_j)});
  };
  for (int i = 0; i < e; ++i) {
    add_rim(i, 0, i + 1, 0);
    add_rim(e, i, e, i + 1);
    add_rim(e - i, e, e - i - 1, e);
    add_rim(0, e - i, 0, e - i - 1);
  }
  return sheet_of_soup(s, 120, 2, 0);
}

/// The label of every vertex by its definition.
inline std::vector<uint32_t> brute_force_labels(const SurfaceMesh& surface, const SeedSet& seeds,
                                                const SeedSpacing& spacing) {
  std::vector<uint32_t> labels;
  for (int64_t v = 0; v < surface.vertex_count(); ++v) {
    int64_t best = INT64_MAX;
    uint32_t id = kNone;
    for (int64_t s = 0; s < seeds.size(); ++s) {
      const bool opposite = 4 * dot(surface.normal[v], seeds.normal[s]) < -127 * 127;
      const int64_t cost =
          distance_sq_q16(surface.position[v], seeds.position[s]) + (opposite ? spacing.penalty_q16 : 0);
      if (cost < best) best = cost, id = uint32_t(s);
    }
    labels.push_back(id);
  }
  return labels;
}

/// What the optimisation begins with: a sheet, seeds that were relaxed on it, and their dual.
struct DualStart {
  std::string name;
  Sheet sheet;
  SeedSet seeds;
  DualMesh mesh;
};

inline DualStart dual_start(const char* name, const TriangleSoup& soup, int32_t resolution, int64_t count,
                            int32_t passes) {
  TestContext context;
  const MeshTopology t = check_mesh({soup.vertices, soup.triangles});
  DualStart s{name, sheet_of_soup(soup, resolution, t.components, t.genus), {}, {}};
  s.seeds = place_seeds(s.sheet, {count, 3}, context);
  if (passes > 0) relax_on_sheet(s.sheet, s.seeds, {passes}, context);
  DualReport report;
  s.mesh = triangulate_dual(s.sheet, s.seeds, {}, report, context);
  REQUIRE(report.failed_cells == 0);
  return s;
}

inline DualMesh copy_of(const DualMesh& mesh) { return {mesh.position.to_host(), mesh.triangles.to_host()}; }

inline bool same(const DualMesh& a, const DualMesh& b) {
  return std::equal(a.position.begin(), a.position.end(), b.position.begin(), b.position.end()) &&
         std::equal(a.triangles.begin(), a.triangles.end(), b.triangles.begin(), b.triangles.end());
}

}  // namespace isoshell
