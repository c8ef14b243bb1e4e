// The optimisation leaves no small component inside out.
#include <algorithm>
#include <cmath>
#include <numeric>

#include "isoshell/advanced/stages.h"
#include "support/catch.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

/// Per vertex whether the faces of its component look inwards, by the sign of the volume inside.
std::vector<bool> looks_inwards(const Buffer<PointQ8>& position, const Buffer<TriangleIndices>& triangles) {
  std::vector<uint32_t> part(size_t(position.size()));
  std::iota(part.begin(), part.end(), 0u);
  for (bool changed = true; changed;) {
    changed = false;
    for (const TriangleIndices& t : triangles) {
      const uint32_t least = std::min({part[t.a], part[t.b], part[t.c]});
      for (const uint32_t v : {t.a, t.b, t.c}) {
        changed |= part[v] != least;
        part[v] = least;
      }
    }
  }
  std::vector<double> volume(part.size(), 0);
  for (const TriangleIndices& t : triangles) {
    const PointQ8 o = position[part[t.a]];
    const Vec64 a = difference(position[t.a], o), b = difference(position[t.b], o), c = difference(position[t.c], o);
    const Vec64 n = cross(b, c);
    volume[part[t.a]] += double(a.x) * double(n.x) + double(a.y) * double(n.y) + double(a.z) * double(n.z);
  }
  std::vector<bool> out;
  for (const uint32_t p : part) out.push_back(volume[p] < 0);
  return out;
}

/// Vertices whose component has not the orientation of the sheet's.
int64_t count_inside_out(const Sheet& sheet, const SeedSet& seeds, const DualMesh& mesh) {
  const std::vector<bool> of_sheet = looks_inwards(sheet.position, sheet.triangles);
  const std::vector<bool> of_mesh = looks_inwards(mesh.position, mesh.triangles);
  int64_t count = 0;
  for (size_t v = 0; v < of_mesh.size(); ++v) count += of_mesh[v] != of_sheet[seeds.home[int64_t(v)]];
  return count;
}

constexpr double kApart = 20;  ///< between the parts

/// A sphere that is long, in a direction of its own.
TriangleSoup long_part(uint32_t number) {
  TriangleSoup part = shapes::sphere({0, 0, 0}, 1, 12);
  for (WorldPoint& p : part.vertices) {
    p.x *= 6 + number % 3;
    p.y = (p.y + p.x * (number % 5) / 8) * (1 + number % 2);
    p.z += p.x * (number % 7) / 16 + kApart * number;
  }
  return part;
}
int part_at(const WorldPoint& p) { return int(std::lround(p.z / kApart)); }

}  // namespace

TEST_CASE("optimize: small components have the orientation of the surface, and so do those of hollows",
          "[optimize][stage]") {
  constexpr uint32_t kParts = 24;
  TriangleSoup soup;
  for (uint32_t i = 0; i < kParts; ++i) {
    const TriangleSoup part = long_part(i);
    soup = shapes::together(std::move(soup), i % 6 == 5 ? shapes::inside_out(part) : part);
  }
  TestContext context;
  const Sheet sheet = sheet_of_soup(soup, 2000, kParts, 0);
  SeedSet seeds = place_seeds(sheet, {4 * kParts, 1}, context);
  relax_on_sheet(sheet, seeds, {20}, context);
  DualReport report;
  DualMesh mesh = triangulate_dual(sheet, seeds, {}, report, context);
  REQUIRE(report.failed_cells == 0);
  REQUIRE(count_inside_out(sheet, seeds, mesh) == 0);
  for (TriangleIndices& t : mesh.triangles)
    if (part_at(sheet.frame.to_world(mesh.position[t.a])) % 4 == 1) std::swap(t.b, t.c);
  REQUIRE(count_inside_out(sheet, seeds, mesh) > 0);
  const int64_t triangles = mesh.triangles.size();
  SECTION("when vertices move") { optimize_mesh(sheet, {}, seeds, mesh, context); }
  SECTION("when only edges are flipped") { optimize_mesh(sheet, {6, 0, 0}, seeds, mesh, context); }
  CHECK(mesh.triangles.size() == triangles);
  CHECK(count_inside_out(sheet, seeds, mesh) == 0);
}
