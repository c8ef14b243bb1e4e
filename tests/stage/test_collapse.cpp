// Taking vertices out of a mesh: as many as asked, without a change of topology.
#include <map>
#include <set>

#include "core/copy_product.h"
#include "isoshell/advanced/stages.h"
#include "isoshell/mesh_topology.h"
#include "stages/halfedge/triangle_shape.h"
#include "support/catch.h"
#include "support/refusals.h"
#include "support/shapes.h"
#include "support/soup_sheet.h"
#include "support/test_context.h"

using namespace isoshell;

namespace {

struct Meshed {
  SeedSet seeds;
  DualMesh mesh;
};
Meshed meshed(const Sheet& sheet, int64_t count, int32_t passes, TestContext& context) {
  Meshed out{place_seeds(sheet, {count, 4}, context), {}};
  relax_on_sheet(sheet, out.seeds, {passes}, context);
  DualReport report;
  out.mesh = triangulate_dual(sheet, out.seeds, {}, report, context);
  REQUIRE(report.failed_cells == 0);
  return out;
}

std::map<uint32_t, std::set<uint32_t>> neighbours_of(const DualMesh& mesh) {
  std::map<uint32_t, std::set<uint32_t>> out;
  for (const TriangleIndices& t : mesh.triangles)
    for (const auto& [u, v] : {std::pair{t.a, t.b}, {t.b, t.c}, {t.c, t.a}}) out[u].insert(v), out[v].insert(u);
  return out;
}

/// Whether a triangle around `v` without `other` turns by more than 60 degrees when `v` goes to `to`.
bool turns(const DualMesh& mesh, uint32_t v, uint32_t other, PointQ8 to) {
  for (const TriangleIndices& t : mesh.triangles) {
    const uint32_t corner[3] = {t.a, t.b, t.c};
    if (std::count(corner, corner + 3, v) == 0 || std::count(corner, corner + 3, other) > 0) continue;
    const auto at = [&](uint32_t u) { return u == v ? to : mesh.position[u]; };
    const optimize::Vector before = optimize::normal_of(mesh.position[t.a], mesh.position[t.b], mesh.position[t.c]),
                           after = optimize::normal_of(at(t.a), at(t.b), at(t.c));
    if (!(dot(before, after) > 0.5 * std::sqrt(dot(before, before)) * std::sqrt(dot(after, after)))) return true;
  }
  return false;
}

/// The cheapest edge by looking at all of them.
std::pair<uint32_t, uint32_t> cheapest_edge(const DualMesh& mesh) {
  std::map<uint32_t, std::set<uint32_t>> near = neighbours_of(mesh);
  const auto uneven = [](size_t valence) { return (int64_t(valence) - 6) * (int64_t(valence) - 6); };
  int64_t least = INT64_MAX;
  std::pair<uint32_t, uint32_t> best{0, 0};
  for (const auto& [a, around] : near)
    for (const uint32_t b : around) {
      if (b < a) continue;
      std::vector<uint32_t> shared;
      std::set_intersection(around.begin(), around.end(), near[b].begin(), near[b].end(), std::back_inserter(shared));
      if (shared.size() != 2 || near[shared[0]].size() < 4 || near[shared[1]].size() < 4) continue;
      const PointQ8 p = mesh.position[a], q = mesh.position[b], m{(p.x + q.x) >> 1, (p.y + q.y) >> 1, (p.z + q.z) >> 1};
      if (turns(mesh, a, b, m) || turns(mesh, b, a, m)) continue;
      int64_t change = uneven(around.size() + near[b].size() - 4) - uneven(around.size()) - uneven(near[b].size());
      for (const uint32_t c : shared) change += uneven(near[c].size() - 1) - uneven(near[c].size());
      const int64_t cost = distance_sq_q16(p, q) * std::max<int64_t>(1, 8 + change);
      if (cost < least) least = cost, best = {a, b};
    }
  return best;
}

}  // namespace

TEST_CASE("collapse: leaves as many vertices as asked, and the topology", "[collapse][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  for (const int64_t target : {399, 380, 300, 200, 100}) {
    Meshed m = meshed(sheet, 400, 20, context);
    collapse_edges(sheet, target, m.seeds, m.mesh, context);
    const MeshTopology t = check_mesh(m.mesh.triangles.view(), m.mesh.position.size());
    INFO(target << " vertices");
    CHECK(m.seeds.size() == target);
    CHECK(m.mesh.position.size() == target);
    CHECK(t.is_closed_manifold());
    CHECK(t.components == 1);
    CHECK(t.genus == 1);
    CHECK(std::equal(m.mesh.position.begin(), m.mesh.position.end(), m.seeds.position.begin()));
    CHECK(std::is_sorted(m.mesh.triangles.begin(), m.mesh.triangles.end(), [](TriangleIndices s, TriangleIndices u) {
      return std::tie(s.a, s.b, s.c) < std::tie(u.a, u.b, u.c);
    }));
  }
}

TEST_CASE("collapse: the edge that goes is the cheapest by brute force", "[collapse][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  for (const int32_t passes : {0, 2, 20}) {
    Meshed m = meshed(sheet, 150, passes, context);
    const auto [kept, gone] = cheapest_edge(m.mesh);
    const std::vector<PointQ8> before(m.mesh.position.begin(), m.mesh.position.end());
    collapse_edges(sheet, m.seeds.size() - 1, m.seeds, m.mesh, context);
    REQUIRE(m.seeds.size() + 1 == int64_t(before.size()));
    int64_t moved = 0;
    for (uint32_t v = 0, i = 0; v < before.size(); ++v) {
      if (v == gone) continue;
      if (!(m.mesh.position[i] == before[v])) {
        ++moved;
        CHECK(v == kept);
      }
      ++i;
    }
    INFO(passes << " passes");
    CHECK(moved == 1);
  }
}

TEST_CASE("collapse: what would change the topology stays", "[collapse][stage]") {
  TestContext context;
  const Sheet torus = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  Meshed m = meshed(torus, 60, 20, context);
  collapse_edges(torus, 4, m.seeds, m.mesh, context);
  CHECK(m.seeds.size() >= 7);  // no torus has fewer
  CHECK(check_mesh(m.mesh.triangles.view(), m.mesh.position.size()).genus == 1);

  const Sheet ball = sheet_of_soup(shapes::sphere({0, 0, 0}, 1, 40), 320, 1, 0);
  Meshed four = meshed(ball, 4, 20, context);
  const int64_t before = four.seeds.size();
  collapse_edges(ball, 1, four.seeds, four.mesh, context);
  CHECK(four.seeds.size() <= before);
  CHECK(check_mesh(four.mesh.triangles.view(), four.mesh.position.size()).is_closed_manifold());
}

TEST_CASE("collapse: nothing is taken where nothing is asked for", "[collapse][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  Meshed m = meshed(sheet, 100, 5, context);
  const std::vector<TriangleIndices> before(m.mesh.triangles.begin(), m.mesh.triangles.end());
  const int64_t count = m.seeds.size();
  collapse_edges(sheet, 1000, m.seeds, m.mesh, context);
  CHECK(m.seeds.size() == count);
  CHECK(std::equal(before.begin(), before.end(), m.mesh.triangles.begin()));
}

TEST_CASE("collapse: seeds whose homes are no vertices of the surface are refused, by every stage that begins there",
          "[collapse][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  const int64_t vertices = sheet.vertex_count();
  Meshed m = meshed(sheet, 100, 5, context);
  on_host(m.seeds).home[7] = uint32_t(vertices);
  const auto refusal = [&](auto stage) { return message_of(ErrorCode::usage, stage); };
  const std::string expected = "home[7] is " + std::to_string(vertices) + "; it must be one of the ";
  CHECK(contains(refusal([&] {
                   collapse_edges(sheet, {host_copy(m.mesh), host_copy(m.seeds)}, {50}, context);
                 }),
                 expected));
  CHECK(contains(refusal([&] {
                   optimize_mesh(sheet, {host_copy(m.mesh), host_copy(m.seeds)}, {}, context);
                 }),
                 expected));
  CHECK(contains(refusal([&] { triangulate_dual(sheet, host_copy(m.seeds), {}, context); }), expected));
  CHECK(contains(refusal([&] { relax_on_sheet(sheet, host_copy(m.seeds), {}, context); }), expected));
  CHECK(contains(refusal([&] { subdivide_seeds(sheet, m.mesh, m.seeds, 200, context); }), expected));
  m.seeds.home.shorten(50);
  CHECK(contains(refusal([&] {
                   collapse_edges(sheet, {host_copy(m.mesh), host_copy(m.seeds)}, {50}, context);
                 }),
                 "home.size() is 50"));
}

TEST_CASE("collapse: ids below the number left are kept, and others take those set free", "[collapse][stage]") {
  TestContext context;
  const Sheet sheet = sheet_of_soup(shapes::torus(2, 0.7, 160, 70), 256, 1, 1);
  for (const int64_t target : {400, 399, 350, 120}) {
    Meshed m = meshed(sheet, 400, 20, context);
    on_host(m.mesh);
    const auto collapsed = [&](const CollapseOptions& options) {
      SeededMesh made = collapse_edges(sheet, {host_copy(m.mesh), host_copy(m.seeds)}, options, context);
      on_host(made.mesh);
      on_host(made.seeds);
      return made;
    };
    const SeededMesh closed = collapsed({target}), kept = collapsed({target, true});
    INFO(target << " vertices");
    // The same mesh under other numbers: found by positions, of which no two are the same.
    std::map<std::tuple<int32_t, int32_t, int32_t>, uint32_t> at;
    const auto key = [](PointQ8 p) { return std::tuple{p.x, p.y, p.z}; };
    for (int64_t v = 0; v < target; ++v) at[key(kept.mesh.position[v])] = uint32_t(v);
    REQUIRE(int64_t(at.size()) == target);
    std::vector<uint32_t> to;
    for (int64_t v = 0; v < target; ++v) to.push_back(at.at(key(closed.mesh.position[v])));
    std::set<std::array<uint32_t, 3>> expected, found;
    const auto turned = [](std::array<uint32_t, 3> t) {
      std::rotate(t.begin(), std::min_element(t.begin(), t.end()), t.end());
      return t;
    };
    for (const TriangleIndices& t : closed.mesh.triangles) expected.insert(turned({to[t.a], to[t.b], to[t.c]}));
    for (const TriangleIndices& t : kept.mesh.triangles) found.insert({t.a, t.b, t.c});
    CHECK(found == expected);
    // Vertices that did not move have their ids, unless these are beyond those that are left.
    int64_t stayed = 0;
    for (int64_t v = 0; v < target; ++v) {
      const auto same = at.find(key(m.mesh.position[v]));
      if (same == at.end()) continue;
      CHECK(same->second == uint32_t(v));
      ++stayed;
    }
    CHECK(stayed >= target - 2 * (400 - target));
    CHECK(std::equal(kept.seeds.position.begin(), kept.seeds.position.end(), kept.mesh.position.begin()));
  }
}
