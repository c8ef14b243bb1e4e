// Pieces of triangles: as few again as their outlines need, in the same place.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "geometry/box.h"
#include "geometry/weld.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/stages.h"
#include "repair/arrangement/dissolve_cuts.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "unit/arranged_faces.h"

using namespace isoshell;

namespace {

repair::PiecedFaces arranged_pieces(const TriangleSoup& soup) {
  const repair::ArrangedFaces faces = arranged::arrange(soup);
  const WeldedVertices welded = weld_vertices(faces.point, faces.face);
  repair::PiecedFaces pieces{welded.position, faces.face, faces.source, {}};
  for (const uint32_t t : faces.source) pieces.is_piece.push_back(faces.is_cut[t]);
  for (auto& f : pieces.face)
    for (uint32_t& v : f) v = welded.place[v];
  return pieces;
}

/// Of so many triangles each its own kind: no two are joined.
std::vector<uint32_t> own_kinds(size_t triangles) {
  std::vector<uint32_t> kind(triangles);
  std::iota(kind.begin(), kind.end(), 0u);
  return kind;
}

/// Those of the faces whose triangles come first in the soup.
repair::PiecedFaces first_of(const repair::PiecedFaces& all, uint32_t sources) {
  repair::PiecedFaces out{all.point, {}, {}, {}};
  for (size_t f = 0; f < all.face.size(); ++f) {
    if (all.source[f] >= sources) continue;
    out.face.push_back(all.face[f]);
    out.source.push_back(all.source[f]);
    out.is_piece.push_back(all.is_piece[f]);
  }
  return out;
}

double area_of(const repair::PiecedFaces& faces) {
  double sum = 0;
  for (const auto& [a, b, c] : faces.face) sum += triangle_area(faces.point[a], faces.point[b], faces.point[c]);
  return sum;
}

TriangleSoup soup_of(const repair::PiecedFaces& faces) {
  TriangleSoup soup;
  soup.vertices = faces.point;
  soup.triangles = faces.face;
  return soup;
}

}  // namespace

TEST_CASE("dissolved cuts: a box that others have cut, and that has all its pieces, is its twelve triangles again",
          "[dissolve_cuts]") {
  const TriangleSoup bar = shapes::box({0, 0, 0}, {10, 1, 1});
  TriangleSoup all = bar;
  for (int i = 0; i < 4; ++i)
    all = shapes::together(all, shapes::box({2. * i + 1.1, -.3, -.2 - .1 * i}, {2. * i + 1.7, 1.4, 1.3}));
  repair::PiecedFaces pieces = first_of(arranged_pieces(all), uint32_t(bar.triangles.size()));
  REQUIRE(pieces.face.size() > 60);
  const auto is_corner = [&](const WorldPoint& p) {
    return std::find(bar.vertices.begin(), bar.vertices.end(), p) != bar.vertices.end();
  };
  std::vector<uint8_t> is_kept;
  for (const WorldPoint& p : pieces.point) is_kept.push_back(is_corner(p));
  repair::dissolve_cuts(pieces, own_kinds(all.triangles.size()), is_kept, box_of(all.vertices), Context());
  CHECK(pieces.face.size() == 12);
  CHECK(volume(soup_of(pieces)) == Approx(10));
}

TEST_CASE("dissolved cuts: what is left of triangles keeps its area, its outline and points that are to stay",
          "[dissolve_cuts]") {
  const TriangleSoup bar = shapes::box({0, 0, 0}, {10, 1, 1});
  TriangleSoup all = bar;
  for (int i = 0; i < 4; ++i) all = shapes::together(all, shapes::box({2. * i + 1.1, .2, .4}, {2. * i + 1.7, .8, 2}));
  repair::PiecedFaces pieces = first_of(arranged_pieces(all), uint32_t(bar.triangles.size()));
  repair::PiecedFaces outside{pieces.point, {}, {}, {}};
  for (size_t f = 0; f < pieces.face.size(); ++f) {
    const auto& [a, b, c] = pieces.face[f];
    const WorldPoint m = (1. / 3) * (pieces.point[a] + pieces.point[b] + pieces.point[c]);
    const double x = std::fmod(m.x - 1.1, 2);
    if (m.z > 1 - 1e-6 && m.x > 1.1 && m.x < 7.7 && x < .6 && m.y > .2 && m.y < .8) continue;
    outside.face.push_back(pieces.face[f]);
    outside.source.push_back(pieces.source[f]);
    outside.is_piece.push_back(pieces.is_piece[f]);
  }
  const double area = area_of(outside);
  CHECK(area == Approx(42 - 4 * .36));
  const size_t before = outside.face.size();
  std::vector<uint8_t> is_kept(outside.point.size(), 0);
  for (size_t v = 0; v < is_kept.size(); ++v)
    for (const WorldPoint& p : all.vertices) is_kept[v] |= p == outside.point[v];
  repair::dissolve_cuts(outside, own_kinds(all.triangles.size()), is_kept, box_of(all.vertices), Context());
  CHECK(outside.face.size() <= before);
  CHECK(area_of(outside) == Approx(area));
  Context context;
  CHECK(measure_topology(soup_of(outside), context).topology.boundary_loops == 4);
}
