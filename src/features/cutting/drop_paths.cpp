// See drop_paths.h.
#include "features/cutting/drop_paths.h"

#include <algorithm>
#include <utility>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr size_t kFewestSegments = 3;

bool is_short(const CurvePath& path) { return path.seeds.size() <= kFewestSegments; }

/// The path over some edges that follow each other, on a loop beyond its end.
CurvePath part_of(const FineMesh& mesh, const CurvePath& path, size_t first, size_t count) {
  CurvePath part;
  part.curve = path.curve;
  part.kind = path.kind;
  part.is_jagged = path.is_jagged;
  const size_t n = path.vertex.size();
  std::vector<char> is_seed(n, 0);
  for (const PathPoint& seed : path.seeds) is_seed[seed.edge % n] = 1;
  for (size_t i = first; i <= first + count; ++i) {
    if (is_seed[i % n]) part.seeds.push_back({part.vertex.size(), 0});
    part.vertex.push_back(path.vertex[i % n]);
  }
  measure_path(mesh.position, part);
  return part;
}

/// The runs of edges that stay.
void append_parts(const FineMesh& mesh, const CurvePath& path, const std::vector<char>& goes, Paths& parts) {
  const size_t edges = goes.size();
  size_t start = 0;  // on a loop one that goes
  while (path.is_loop && !goes[start]) ++start;
  for (size_t begin = start; begin < start + edges;) {
    size_t end = begin;
    while (end < start + edges && !goes[end % edges]) ++end;
    if (end > begin) parts.push_back(part_of(mesh, path, begin, end - begin));
    begin = end + 1;
  }
}

/// Where paths that are no loops begin and end, ascending: as often as they do.
std::vector<uint32_t> ends_of(const Paths& paths) {
  std::vector<uint32_t> ends;
  for (const CurvePath& path : paths)
    if (!path.is_loop) ends.insert(ends.end(), {path.vertex.front(), path.vertex.back()});
  std::sort(ends.begin(), ends.end());
  return ends;
}

/// Until there are none.
void drop_stubs(Paths& paths) {
  for (size_t before = paths.size() + 1; paths.size() < before;) {
    before = paths.size();
    const std::vector<uint32_t> ends = ends_of(paths);
    const auto is_free = [&](uint32_t v) {
      const auto [begin, end] = std::equal_range(ends.begin(), ends.end(), v);
      return end - begin == 1;
    };
    const auto is_stub = [&](const CurvePath& path) {
      return !path.is_loop && path.kind == CurveKind::crease && is_short(path) &&
             (is_free(path.vertex.front()) || is_free(path.vertex.back()));
    };
    paths.erase(std::remove_if(paths.begin(), paths.end(), is_stub), paths.end());
  }
}

}  // namespace

EdgesOfPaths no_edges_of(const Paths& paths) {
  EdgesOfPaths out;
  for (const CurvePath& path : paths) out.emplace_back(path.edge_count(), 0);
  return out;
}

std::vector<double> turns_of(const FineMesh& mesh) {
  struct Beside {
    uint64_t edge;
    uint32_t path;
    uint32_t triangles = 0;
    WorldPoint normal{0, 0, 0};
    double turn = 0;
  };
  std::vector<Beside> edges;
  for (uint32_t p = 0; p < mesh.paths.size(); ++p)
    for (size_t i = 0; i < mesh.paths[p].edge_count(); ++i)
      edges.push_back({edge_key(mesh.paths[p].vertex[i], mesh.paths[p].edge_end(i)), p});
  std::sort(edges.begin(), edges.end(), [](const Beside& a, const Beside& b) { return a.edge < b.edge; });
  std::vector<char> is_on_path(mesh.position.size(), 0);
  for (const Beside& e : edges) is_on_path[e.edge >> 32] = is_on_path[uint32_t(e.edge)] = 1;
  for (const auto& t : mesh.triangles)
    for (size_t i = 0; i < 3; ++i) {
      const uint32_t u = t[i], v = t[(i + 1) % 3];
      if (!is_on_path[u] || !is_on_path[v]) continue;
      const auto at = std::lower_bound(edges.begin(), edges.end(), edge_key(u, v),
                                       [](const Beside& e, uint64_t key) { return e.edge < key; });
      if (at == edges.end() || at->edge != edge_key(u, v)) continue;
      const WorldPoint n = doubled_area(mesh.position[t[0]], mesh.position[t[1]], mesh.position[t[2]]);
      const double scale = length(n) * length(at->normal);
      if (++at->triangles == 2 && scale > 0) at->turn = 1 - dot(n, at->normal) / scale;
      at->normal = n;
    }
  std::vector<double> sum(mesh.paths.size(), 0), turns(mesh.paths.size());
  for (const Beside& e : edges)
    sum[e.path] += e.turn * length(mesh.position[e.edge >> 32] - mesh.position[uint32_t(e.edge)]);
  for (size_t p = 0; p < turns.size(); ++p) turns[p] = mesh.paths[p].length > 0 ? sum[p] / mesh.paths[p].length : 0;
  return turns;
}

Paths without_edges(const FineMesh& mesh, const EdgesOfPaths& goes) {
  Paths paths;
  for (size_t p = 0; p < mesh.paths.size(); ++p) {
    if (std::none_of(goes[p].begin(), goes[p].end(), [](char g) { return g; })) {
      paths.push_back(mesh.paths[p]);
      continue;
    }
    Paths parts;
    append_parts(mesh, mesh.paths[p], goes[p], parts);
    for (CurvePath& part : parts)
      if (!is_short(part)) paths.push_back(std::move(part));
  }
  drop_stubs(paths);
  return paths;
}

}  // namespace isoshell
