// subdivide_seeds (see stages.h): the seeds of the next finer level from a coarse dual.
#pragma once

#include <algorithm>

#include "isoshell/advanced/stages.h"
#include "stages/labels/edge_lengths.h"
#include "stages/sheet/sheet_walk.h"

namespace isoshell {
namespace subdivide {

struct Edge {
  uint32_t a, b;
};
/// The half-edge that runs from the smaller to the larger vertex stands for the edge: one of the two in a closed mesh.
struct StandsForEdge {
  View<const TriangleIndices> triangles;
  ISOSHELL_HD Edge edge(int64_t half_edge) const {
    const TriangleIndices t = triangles[half_edge / 3];
    const int i = int(half_edge % 3);
    return i == 0 ? Edge{t.a, t.b} : (i == 1 ? Edge{t.b, t.c} : Edge{t.c, t.a});
  }
  ISOSHELL_HD bool operator()(int64_t half_edge) const {
    const Edge e = edge(half_edge);
    return e.a < e.b;
  }
};

/// Where a new seed may go: the middle of an edge, or of a triangle. Larger ones, beside the lengths there, come first,
/// then smaller indices.
struct Place {
  int64_t size;
  uint32_t index, zero = 0;
};
struct LargestFirst {
  ISOSHELL_HD bool operator()(const Place& p, const Place& q) const {
    return p.size != q.size ? p.size > q.size : p.index < q.index;
  }
};
struct ByIndex {
  ISOSHELL_HD bool operator()(const Place& p, const Place& q) const { return p.index < q.index; }
};

struct MeasureEdge {
  StandsForEdge edges;
  View<const uint32_t> half_edge;
  View<const PointQ8> position;
  View<const uint32_t> home;
  EdgeLengthsView lengths;
  View<Place> out;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Edge e = edges.edge(half_edge[i]);
    const int64_t length_sq = distance_sq_q16(position[e.a], position[e.b]);
    out[i] = {lengths.share_of_seeds(length_sq, {home[e.a], home[e.a], home[e.b]}), half_edge[i]};
  }
};
struct MeasureTriangle {
  View<const TriangleIndices> triangles;
  View<const PointQ8> position;
  View<const uint32_t> home;
  EdgeLengthsView lengths;
  View<Place> out;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    const Vec64 n = cross(difference(position[t.b], position[t.a]), difference(position[t.c], position[t.a]));
    const auto area2 =
        int64_t(__builtin_sqrt(double(n.x) * double(n.x) + double(n.y) * double(n.y) + double(n.z) * double(n.z)));
    out[i] = {lengths.share_of_seeds(area2, {home[t.a], home[t.b], home[t.c]}), uint32_t(i)};
  }
};

/// Seeds as they are filled in; a new one walks to its place from the home of a neighbour.
struct NewSeeds {
  WalkOntoSheet walk;
  View<PointQ8> position;
  View<Normal8> normal;
  View<uint32_t> home;
  ISOSHELL_HD void put(int64_t at, uint32_t start, PointQ8 target) const {
    const uint32_t vertex = walk.nearest_vertex(start, target);
    home[at] = vertex;
    normal[at] = walk.normal[vertex];
    position[at] = walk.closest_around(vertex, target);
  }
};
struct KeepSeed {
  View<const PointQ8> position;
  View<const Normal8> normal;
  View<const uint32_t> home;
  NewSeeds out;
  ISOSHELL_HD void operator()(int64_t i) const {
    out.position[i] = position[i];
    out.normal[i] = normal[i];
    out.home[i] = home[i];
  }
};
struct PutOnEdge {
  StandsForEdge edges;
  View<const Place> places;
  View<const PointQ8> position;
  View<const uint32_t> home;
  int64_t first;
  NewSeeds out;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Edge e = edges.edge(places[i].index);
    const PointQ8 p = position[e.a], q = position[e.b];
    out.put(first + i, home[e.a], {(p.x + q.x) >> 1, (p.y + q.y) >> 1, (p.z + q.z) >> 1});
  }
};
struct PutInTriangle {
  View<const TriangleIndices> triangles;
  View<const Place> places;
  View<const PointQ8> position;
  View<const uint32_t> home;
  int64_t first;
  NewSeeds out;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[places[i].index];
    const PointQ8 a = position[t.a], b = position[t.b], c = position[t.c];
    out.put(first + i, home[t.a],
            {int32_t(round_div(int64_t(a.x) + b.x + c.x, 3)), int32_t(round_div(int64_t(a.y) + b.y + c.y, 3)),
             int32_t(round_div(int64_t(a.z) + b.z + c.z, 3))});
  }
};

}  // namespace subdivide

template <class Exec>
SeedSet subdivide_seeds_body(Exec& exec, const SurfaceMesh& surface, const DualMesh& mesh, const SeedSet& seeds,
                             int64_t target) {
  using namespace subdivide;
  const StandsForEdge stands{mesh.triangles.view()};
  const Buffer<uint32_t> half_edges = exec.select(3 * mesh.triangles.size(), stands);
  const int64_t old = seeds.size();
  const int64_t on_edges = std::min(half_edges.size(), target - old);
  const int64_t in_triangles = target - old - on_edges;

  SeedSet out;
  out.position = exec.template make<PointQ8>(target);
  out.normal = exec.template make<Normal8>(target);
  out.home = exec.template make<uint32_t>(target);
  const WalkOntoSheet walk = walk_onto(surface);
  const NewSeeds put{walk, out.position.view(), out.normal.view(), out.home.view()};
  exec.for_each("keep seeds", old, KeepSeed{seeds.position.view(), seeds.normal.view(), seeds.home.view(), put});

  Buffer<Place> edges = exec.template make<Place>(half_edges.size());
  exec.for_each("measure edges", edges.size(),
                MeasureEdge{stands, half_edges.view(), seeds.position.view(), seeds.home.view(), lengths_of(surface),
                            edges.view()});
  if (on_edges < edges.size()) exec.sort(edges.view(), LargestFirst{});
  const View<Place> chosen{edges.data(), on_edges};
  exec.sort(chosen, ByIndex{});
  exec.for_each("seeds on edges", on_edges,
                PutOnEdge{stands, chosen, seeds.position.view(), seeds.home.view(), old, put});
  if (in_triangles > 0) {
    Buffer<Place> triangles = exec.template make<Place>(mesh.triangles.size());
    exec.for_each("measure triangles", triangles.size(),
                  MeasureTriangle{mesh.triangles.view(), seeds.position.view(), seeds.home.view(), lengths_of(surface),
                                  triangles.view()});
    exec.sort(triangles.view(), LargestFirst{});
    exec.for_each("seeds in triangles", in_triangles,
                  PutInTriangle{mesh.triangles.view(), triangles.view(), seeds.position.view(), seeds.home.view(),
                                old + on_edges, put});
  }
  return out;
}

}  // namespace isoshell
