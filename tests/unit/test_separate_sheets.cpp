// Edges of four faces: what has solid between it goes on as one sheet.
#include <cmath>

#include "geometry/weld.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/boolean_union.h"
#include "repair/regions/separate_sheets.h"
#include "support/catch.h"
#include "support/shapes.h"

using namespace isoshell;
using shapes::box;
using shapes::together;

namespace {

struct Separated {
  TriangleSoup soup;
  std::vector<uint32_t> source;
  int64_t edges;
};

Separated separated(const TriangleSoup& soup) {
  Separated s;
  const WeldedVertices welded = weld_vertices(soup.vertices, soup.triangles);
  s.soup.vertices = welded.position;
  for (const auto& [a, b, c] : soup.triangles) {
    s.source.push_back(uint32_t(s.soup.triangles.size()));
    s.soup.triangles.push_back({welded.place[a], welded.place[b], welded.place[c]});
  }
  s.edges = repair::separate_sheets(1e-3, s.soup.vertices, s.soup.triangles, s.source);
  return s;
}

InputTopology topology_of(const TriangleSoup& soup) {
  Context context;
  return measure_topology(soup, context).topology;
}

}  // namespace

TEST_CASE("separated sheets: boxes that share an edge come apart, each by the gap into itself", "[separate_sheets]") {
  const TriangleSoup boxes = together(box({0, 0, 0}, {1, 1, 1}), box({1, 1, 0}, {2, 2, 1}));
  const Separated s = separated(boxes);
  CHECK(s.edges == 1);
  const InputTopology found = topology_of(s.soup);
  CHECK(found.closed);
  CHECK(found.oriented);
  CHECK(found.components == 2);
  CHECK(s.soup.triangles.size() == boxes.triangles.size());
  for (size_t t = 0; t < s.soup.triangles.size(); ++t)
    for (size_t i = 0; i < 3; ++i) {
      const WorldPoint &before = boxes.vertices[boxes.triangles[t][i]],
                       &after = s.soup.vertices[s.soup.triangles[t][i]];
      const double moved =
          std::sqrt((after.x - before.x) * (after.x - before.x) + (after.y - before.y) * (after.y - before.y) +
                    (after.z - before.z) * (after.z - before.z));
      CHECK(moved == Approx(before.x == 1 && before.y == 1 ? 1e-3 : 0).margin(1e-12));
    }
  CHECK(volume(s.soup) < 2);
}

TEST_CASE("separated sheets: an edge both ends of which its sheets share otherwise is divided", "[separate_sheets]") {
  // A frame of solid around the middle of a 2 x 2 x 3 stack: the cubes of its middle layer touch along one edge, and
  // are joined above and below.
  TriangleSoup stack = together(box({0, 0, 0}, {2, 2, 1}), box({0, 0, 2}, {2, 2, 3}));
  stack = together(stack, together(box({0, 0, 1}, {1, 1, 2}), box({1, 1, 1}, {2, 2, 2})));
  Context context;
  UnionReport report;
  UnionOptions options;
  options.sheet_gap_world = 1e-3;
  const UnitedSoup united = boolean_union(stack, options, report, context);
  CHECK(report.separated_edges > 0);
  const InputTopology found = topology_of(united.soup);
  CHECK(found.closed);
  CHECK(found.oriented);
  CHECK(found.components == 1);
  CHECK(volume(united.soup) == Approx(10).epsilon(1e-3));
}

TEST_CASE("separated sheets: what has two faces at each edge stays as it is", "[separate_sheets]") {
  const Separated s = separated(box({0, 0, 0}, {1, 1, 1}));
  CHECK(s.edges == 0);
  CHECK(s.soup.vertices.size() == 8);
}
