// Small components that are inside out. Four seeds on a long component of the surface may make a tetrahedron of either
// orientation, and a step may take a flat one through itself. Its triangles are the right ones, seen from the other
// side: they are turned around.
#pragma once

#include "isoshell/advanced/stages.h"
#include "voxel/atomic.h"
#include "voxel/exact_int.h"
#include "voxel/union_find.h"

namespace isoshell::optimize {

/// A component of more triangles would have to intersect itself before it is inside out.
constexpr int64_t kMostTurned = 32;

/// Sums over the triangles of a component are at its root, its smallest vertex.
struct ComponentsView {
  View<uint32_t> root;  ///< per vertex
  View<int64_t> triangles;
  View<int64_t> high, low;  ///< six times the signed volume takes 69 bits: its upper part, rounded down, and 32 bits

  ISOSHELL_HD bool is_inside_out(uint32_t v) const { return high[root[v]] + (low[root[v]] >> 32) < 0; }
};

struct JoinTriangle {
  View<const TriangleIndices> triangles;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[i];
    join(parent, t.a, t.b);
    join(parent, t.a, t.c);
  }
};

/// Adds a run of triangles to their components; one addition per change of component.
struct AddTriangles {
  static constexpr int64_t kRun = 64;
  View<const TriangleIndices> triangles;
  View<const PointQ8> position;
  ComponentsView components;
  ISOSHELL_HD void operator()(int64_t run) const {
    const int64_t begin = run * kRun, end = begin + kRun < triangles.size ? begin + kRun : triangles.size;
    uint32_t current = components.root[triangles[begin].a];
    int64_t count = 0;
    Int128 six_volumes = 0;
    for (int64_t i = begin; i < end; ++i) {
      const TriangleIndices t = triangles[i];
      if (components.root[t.a] != current) {
        add(current, count, six_volumes);
        current = components.root[t.a];
        count = 0;
        six_volumes = 0;
      }
      const PointQ8 a = position[t.a];
      const Vec64 n = cross(difference(position[t.b], a), difference(position[t.c], a));
      six_volumes += Int128(n.x) * a.x + Int128(n.y) * a.y + Int128(n.z) * a.z;
      ++count;
    }
    add(current, count, six_volumes);
  }

 private:
  ISOSHELL_HD void add(uint32_t root, int64_t count, Int128 six_volumes) const {
    atomic_add(components.triangles[root], count);
    atomic_add(components.high[root], int64_t(six_volumes >> 32));
    atomic_add(components.low[root], int64_t(six_volumes & 0xffffffff));
  }
};

/// Of closed surfaces; of open ones the volumes mean nothing.
struct Components {
  Buffer<uint32_t> root;
  Buffer<int64_t> triangles, high, low;

  template <class Exec>
  Components(Exec& exec, View<const TriangleIndices> all, View<const PointQ8> position)
      : root(exec.template make<uint32_t>(position.size)),
        triangles(exec.template make<int64_t>(position.size)),
        high(exec.template make<int64_t>(position.size)),
        low(exec.template make<int64_t>(position.size)) {
    exec.for_each("start components", position.size, StartAlone{root.view()});
    exec.for_each("join components", all.size, JoinTriangle{all, root.view()});
    exec.for_each("root components", position.size, PointAtRoot{root.view()});
    for (Buffer<int64_t>* sums : {&triangles, &high, &low}) exec.fill(sums->view(), int64_t(0));
    exec.for_each("measure components", (all.size + AddTriangles::kRun - 1) / AddTriangles::kRun,
                  AddTriangles{all, position, view()});
  }
  ComponentsView view() { return {root.view(), triangles.view(), high.view(), low.view()}; }
};

/// Whether a vertex is the root of a small component without borders, whose vertices would be the first ones.
struct IsSmallClosed {
  ComponentsView components;
  int64_t on_borders;
  ISOSHELL_HD int64_t operator()(int64_t v) const {
    const int64_t triangles = components.root[v] == v && v >= on_borders ? components.triangles[v] : 0;
    return triangles > 0 && triangles <= kMostTurned ? 1 : 0;
  }
};

struct TurnTriangle {
  View<TriangleIndices> triangles;
  IsSmallClosed of_mesh;
  ComponentsView of_surface;
  View<const uint32_t> home;
  ISOSHELL_HD void operator()(int64_t i) const {
    TriangleIndices& t = triangles[i];
    const uint32_t root = of_mesh.components.root[t.a];
    if (!of_mesh(root) || of_mesh.components.is_inside_out(root) == of_surface.is_inside_out(home[root])) return;
    const uint32_t b = t.b;
    t.b = t.c;
    t.c = b;
  }
};

/// Gives small components the orientation of the surface's components that they are on, of hollows too.
template <class Exec>
void turn_small_components(Exec& exec, const SurfaceMesh& surface, const SeedSet& seeds, DualMesh& mesh) {
  Components of_mesh(exec, mesh.triangles.view(), mesh.position.view());
  const IsSmallClosed is_small{of_mesh.view(), seeds.fixed.count};
  if (exec.sum(mesh.position.size(), is_small) == 0) return;
  Components of_surface(exec, surface.triangles.view(), surface.position.view());
  exec.for_each("turn triangles", mesh.triangles.size(),
                TurnTriangle{mesh.triangles.view(), is_small, of_surface.view(), seeds.home.view()});
}

}  // namespace isoshell::optimize
