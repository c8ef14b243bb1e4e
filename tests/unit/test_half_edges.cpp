// Half-edges and borders of closed and open meshes, against what all triangles say.
#include "isoshell/error.h"
#include "isoshell/mesh_topology.h"
#include "support/catch.h"
#include "support/open_surfaces.h"
#include "support/refusals.h"
#include "voxel/random.h"

using namespace isoshell;
using optimize::Connections;
using optimize::MeshView;

namespace {

DualMesh mesh_of(const NamedMesh& mesh) { return {to_buffer(mesh.position), to_buffer(mesh.triangles)}; }

/// Some triangles of a mesh taken away at random, as long as what is left is a manifold that uses every vertex.
NamedMesh nibbled(NamedMesh mesh, int tries, uint64_t seed) {
  mesh.name += ", nibbled";
  for (int i = 0; i < tries; ++i) {
    std::vector<TriangleIndices> fewer = mesh.triangles;
    fewer.erase(fewer.begin() + int64_t(random_bits(seed, uint64_t(i)) % fewer.size()));
    const MeshTopology t = check_mesh({fewer.data(), int64_t(fewer.size())}, mesh.vertex_count());
    if (t.manifold && t.unreferenced_vertices == 0) mesh.triangles = std::move(fewer);
  }
  return mesh;
}

std::vector<NamedMesh> meshes() {
  std::vector<NamedMesh> out = {{"triangle", {{0, 0, 0}, {256, 0, 0}, {0, 256, 0}}, {{2, 0, 1}}},
                                patch(1, 5),
                                patch(7, 6),
                                patch_with_holes(12, 9),
                                sphere_mesh(true, 5, 9, 3000),
                                sphere_mesh(false, 6, 7, 3000)};
  for (uint64_t seed = 0; seed < 4; ++seed) {
    out.push_back(nibbled(patch(8, 8), 200, seed));
    out.push_back(nibbled(sphere_mesh(false, 8, 8, 3000), 150, seed));
  }
  return out;
}

/// Half-edges of a mesh, as the plain executor finds them.
struct Connected {
  Context context;
  DualMesh mesh;
  PlainExecutor exec{context, "test"};
  Connections connections;
  explicit Connected(const NamedMesh& from) : mesh(mesh_of(from)), connections(exec, mesh) {}
  MeshView view() { return connections.view(mesh); }
};

}  // namespace

TEST_CASE("half-edges: a turn around a vertex visits each of its triangles and neighbours once", "[half_edges][unit]") {
  for (const NamedMesh& from : meshes()) {
    INFO(from.name);
    Connected connected(from);
    const MeshView view = connected.view();
    const auto neighbours = neighbours_in(from.triangles, from.vertex_count());
    for (uint32_t v = 0; v < from.position.size(); ++v) {
      std::vector<uint32_t> triangles, visited, expected;
      for (uint32_t t = 0; t < from.triangles.size(); ++t)
        for (int i = 0; i < 3; ++i)
          if (optimize::corner(from.triangles[t], i) == v) expected.push_back(t);
      optimize::for_each_half_edge_around(view, v, [&](uint32_t h) {
        CHECK(view.from(h) == v);
        triangles.push_back(h / 3);
      });
      std::sort(triangles.begin(), triangles.end());
      CHECK(triangles == expected);
      optimize::for_each_neighbour(view, v, [&](uint32_t u) { visited.push_back(u); });
      std::sort(visited.begin(), visited.end());
      CHECK(visited == std::vector<uint32_t>(neighbours[v].begin(), neighbours[v].end()));
      CHECK(view.valence[v] == neighbours[v].size());
      for (uint32_t u = 0; u < from.position.size(); ++u)
        CHECK(view.are_neighbours(v, u) == (neighbours[v].count(u) > 0));
    }
  }
}

TEST_CASE("half-edges: a turn goes from triangle to triangle across edges, and from any start all the way round",
          "[half_edges][unit]") {
  for (const NamedMesh& from : meshes()) {
    INFO(from.name);
    Connected connected(from);
    const MeshView view = connected.view();
    for (uint32_t h = 0; h < view.twin.size; ++h) {
      if (!view.is_border(h)) {
        CHECK(view.twin[view.twin[h]] == h);
        CHECK(view.from(view.twin[h]) == view.to(h));
        CHECK(view.to(view.twin[h]) == view.from(h));
      }
      int64_t count = 0, jumps = 0;
      uint32_t last = kNone;
      view.any_from(h, [&](uint32_t g) {
        if (last != kNone) jumps += view.opposite(last) != view.to(g);
        last = g;
        ++count;
        return false;
      });
      const uint32_t v = view.from(h);
      const bool on_border = view.is_border(view.outgoing[v]);
      CHECK(count == int64_t(view.valence[v]) - on_border);
      CHECK(jumps == (on_border && h != view.outgoing[v]));  // beyond the border
    }
  }
}

TEST_CASE("half-edges: turns begin at the smallest half-edge, or on a border at the one without twin",
          "[half_edges][unit]") {
  for (const NamedMesh& from : meshes()) {
    INFO(from.name);
    Connected connected(from);
    const MeshView view = connected.view();
    std::vector<uint32_t> expected(from.position.size(), kNone);
    const auto borders = border_edges_of(from.triangles);
    for (uint32_t h = 0; h < view.twin.size; ++h) {
      const auto border = borders.find(view.from(h));
      const bool is_border = border != borders.end() && border->second == view.to(h);
      CHECK(view.is_border(h) == is_border);
      uint32_t& first = expected[view.from(h)];
      if (border == borders.end() ? h < first : is_border) first = h;
    }
    CHECK(std::equal(expected.begin(), expected.end(), view.outgoing.begin()));
    CHECK(connected.connections.border_edges[0] == borders.size());
    if (borders.empty())
      CHECK_NOTHROW(connected.connections.require_closed(connected.exec, "test"));
    else
      CHECK_THROWS_AS(connected.connections.require_closed(connected.exec, "test"), Error);
  }
}

TEST_CASE("surface: borders are chains, loops from their smallest vertex on", "[surface_mesh][unit]") {
  for (const NamedMesh& from : meshes()) {
    INFO(from.name);
    Context context;
    const SurfaceMesh surface = surface_of(from, context);
    const auto loops = border_loops_of(surface.triangles);
    CHECK(surface.is_closed() == loops.empty());
    REQUIRE(surface.chains.count() == int64_t(loops.size()));
    std::vector<uint32_t> before(from.position.size(), kNone);
    for (size_t i = 0; i < loops.size(); ++i) {
      const int64_t begin = surface.chains.first[int64_t(i)], end = surface.chains.first[int64_t(i) + 1];
      CHECK(std::vector<uint32_t>(surface.chains.vertex.begin() + begin, surface.chains.vertex.begin() + end) ==
            loops[i]);
      CHECK(surface.chains.kind[int64_t(i)] == ChainKind::border);
      CHECK(surface.chains.is_loop[int64_t(i)] == 1);
      for (size_t k = 0; k < loops[i].size(); ++k) before[loops[i][(k + 1) % loops[i].size()]] = loops[i][k];
    }
    if (loops.empty()) continue;
    CHECK(std::equal(before.begin(), before.end(), surface.border_before.begin()));
  }
}

TEST_CASE("surface: borders of what is no oriented manifold are an error", "[surface_mesh][unit]") {
  const std::vector<PointQ8> points = {{0, 0, 0}, {256, 0, 0}, {0, 256, 0}, {0, 0, 256}, {256, 256, 0}};
  Context context;
  for (const std::vector<TriangleIndices>& triangles :
       {std::vector<TriangleIndices>{{0, 1, 2}, {0, 3, 4}},                // two fans around vertex 0
        std::vector<TriangleIndices>{{0, 1, 2}, {0, 1, 3}, {3, 1, 4}},     // the same way along an edge
        std::vector<TriangleIndices>{{0, 1, 2}, {1, 0, 3}, {0, 1, 4}}}) {  // three triangles at an edge
    const NamedMesh mesh{"", points, triangles, {}};
    CHECK(contains(message_of(ErrorCode::usage, [&] { surface_of(mesh, context); }), "no oriented manifold"));
  }
}

TEST_CASE("surface: the neighbours of its vertices are those that share an edge with them", "[surface_mesh][unit]") {
  for (const NamedMesh& from : meshes()) {
    INFO(from.name);
    Context context;
    const SurfaceMesh surface = surface_of(from, context);
    const auto neighbours = neighbours_in(surface.triangles, surface.vertex_count());
    const SheetGraph graph = graph_of(surface);
    for (uint32_t v = 0; v < surface.vertex_count(); ++v) {
      std::vector<uint32_t> visited;
      graph.for_each_neighbour(v, [&](uint32_t u) { visited.push_back(u); });
      std::sort(visited.begin(), visited.end());
      CHECK(visited == std::vector<uint32_t>(neighbours[v].begin(), neighbours[v].end()));
    }
  }
}
