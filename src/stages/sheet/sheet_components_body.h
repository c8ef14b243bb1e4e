// The part of build_sheet that finds the components of the quad mesh and drops the small ones.
#pragma once

#include "stages/sheet/sheet_project_body.h"
#include "voxel/union_find.h"

namespace isoshell {

/// Two triangles of a quad, split along its shorter diagonal; the first corner's when both are as long.
struct SplitQuad {
  TriangleIndices first, second;
};
ISOSHELL_HD inline SplitQuad split_quad(const Quad& quad, const View<const PointQ8>& position) {
  const uint32_t a = quad.corner[0], b = quad.corner[1], c = quad.corner[2], d = quad.corner[3];
  if (distance_sq_q16(position[a], position[c]) <= distance_sq_q16(position[b], position[d]))
    return {{a, b, c}, {a, c, d}};
  return {{a, b, d}, {b, c, d}};
}

ISOSHELL_HD inline Vec64 area_vector(TriangleIndices t, const View<const PointQ8>& position) {
  return cross(difference(position[t.b], position[t.a]), difference(position[t.c], position[t.a]));
}
/// Area in 1/65536 voxel^2, rounded down.
ISOSHELL_HD inline int64_t area_q16(TriangleIndices t, const View<const PointQ8>& position) {
  const Vec64 n = area_vector(t, position);
  return int64_t(isqrt(uint64_t(dot(n, n)))) / 2;
}

namespace sheet_steps {

/// Joins the components of a quad's corners.
struct JoinCorners {
  View<const Quad> quads;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const {
    for (int k = 1; k < 4; ++k) join(parent, quads[i].corner[0], quads[i].corner[k]);
  }
};

/// Joins what the boundary's quads connect; every parent is its own before.
struct PlainJoinComponents {
  template <class Exec>
  static void run(Exec& exec, const QuadMesh& mesh, View<uint32_t> parent) {
    exec.for_each("join corners", mesh.quads.size(), JoinCorners{mesh.quads.view(), parent});
  }
};

struct IsRoot {
  View<const uint32_t> parent;
  ISOSHELL_HD bool operator()(int64_t v) const { return parent[v] == uint32_t(v); }
};

/// Adds the areas of a run of quads to their components; one addition per change of component.
struct AddAreas {
  static constexpr int64_t kRun = 256;
  View<const Quad> quads;
  View<const PointQ8> position;
  View<const uint32_t> root;
  View<int64_t> area_q16_of;  ///< per vertex; only roots get any
  ISOSHELL_HD void operator()(int64_t run) const {
    const int64_t end = (run + 1) * kRun < quads.size ? (run + 1) * kRun : quads.size;
    uint32_t last = kNone;
    int64_t sum = 0;
    for (int64_t i = run * kRun; i < end; ++i) {
      const uint32_t here = root[quads[i].corner[0]];
      if (here != last && last != kNone) {
        atomic_add(area_q16_of[last], sum);
        sum = 0;
      }
      last = here;
      const SplitQuad split = split_quad(quads[i], position);
      sum += area_q16(split.first, position) + area_q16(split.second, position);
    }
    if (last != kNone) atomic_add(area_q16_of[last], sum);
  }
};

struct IsLargeEnough {
  View<const uint32_t> roots;
  View<const int64_t> area_q16_of;
  int64_t limit_q16;
  ISOSHELL_HD bool operator()(int64_t i) const { return area_q16_of[roots[i]] >= limit_q16; }
};

struct IsKeptVertex {
  View<const uint32_t> root;
  View<const int64_t> area_q16_of;
  int64_t limit_q16;
  ISOSHELL_HD bool operator()(int64_t v) const { return area_q16_of[root[v]] >= limit_q16; }
};

struct IsKeptQuad {
  IsKeptVertex vertex;
  View<const Quad> quads;
  ISOSHELL_HD bool operator()(int64_t i) const { return vertex(quads[i].corner[0]); }
};

struct KeepCorners {
  VoxelSetView corners;
  IsKeptVertex keep;
  View<LeafMask> mask;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    mask[leaf] = LeafMask{};
    for_each_active(corners, leaf, [&](int offset, int64_t v) {
      if (keep(v)) mask[leaf].word[offset >> 6] |= uint64_t(1) << (offset & 63);
    });
  }
};

struct RenumberVertex {
  View<const uint32_t> kept;
  View<uint32_t> number;
  ISOSHELL_HD void operator()(int64_t i) const { number[kept[i]] = uint32_t(i); }
};

struct RenumberQuad {
  View<const uint32_t> kept, number;
  View<const Quad> from;
  View<Quad> to;
  ISOSHELL_HD void operator()(int64_t i) const {
    for (int k = 0; k < 4; ++k) to[i].corner[k] = number[from[kept[i]].corner[k]];
  }
};

template <class T>
struct Gather {
  View<const uint32_t> kept;
  View<const T> from;
  View<T> to;
  ISOSHELL_HD void operator()(int64_t i) const { to[i] = from[kept[i]]; }
};

template <class Exec, class T>
void keep_only(Exec& exec, View<const uint32_t> kept, Buffer<T>& values) {
  Buffer<T> out = exec.template make<T>(kept.size);
  exec.for_each("keep", kept.size, Gather<T>{kept, values.view(), out.view()});
  values = std::move(out);
}

template <class Exec>
void keep_components(Exec& exec, QuadMesh& mesh, LaidMesh& laid, const IsKeptVertex& keep) {
  const int64_t vertices = laid.position.size();
  const Buffer<uint32_t> kept = exec.select(vertices, keep);
  const Buffer<uint32_t> kept_quads = exec.select(mesh.quads.size(), IsKeptQuad{keep, mesh.quads.view()});
  {
    const VoxelSetView corners = mesh.corners.view();
    Buffer<LeafMask> mask = exec.template make<LeafMask>(corners.leaf_key.size);
    exec.for_each("keep corners", corners.leaf_key.size, KeepCorners{corners, keep, mask.view()});
    mesh.corners = voxel_set_of(exec, corners.leaf_key, mask.view(), BlockExtent(corners).vox);
  }
  Buffer<uint32_t> number = exec.template make<uint32_t>(vertices);
  exec.for_each("renumber vertices", kept.size(), RenumberVertex{kept.view(), number.view()});
  Buffer<Quad> quads = exec.template make<Quad>(kept_quads.size());
  exec.for_each("renumber quads", kept_quads.size(),
                RenumberQuad{kept_quads.view(), number.view(), mesh.quads.view(), quads.view()});
  mesh.quads = std::move(quads);
  keep_only(exec, kept.view(), mesh.lattice_normal);
  keep_only(exec, kept.view(), laid.smooth);
  keep_only(exec, kept.view(), laid.position);
  keep_only(exec, kept.view(), laid.source_triangle);
}

}  // namespace sheet_steps

struct ComponentCount {
  int64_t kept = 0, dropped = 0;
};

/// Which component each vertex belongs to.
struct Components {
  Buffer<uint32_t> root;   ///< per vertex
  Buffer<uint32_t> roots;  ///< one a component
};
template <class Exec>
Components find_components(Exec& exec, const QuadMesh& mesh) {
  using namespace sheet_steps;
  const int64_t vertices = mesh.corners.voxel_count();
  Components found;
  found.root = exec.template make<uint32_t>(vertices);
  exec.for_each("components", vertices, StartAlone{found.root.view()});
  Exec::Kernels::JoinComponents::run(exec, mesh, found.root.view());
  exec.for_each("flatten components", vertices, PointAtRoot{found.root.view()});
  found.roots = exec.select(vertices, IsRoot{found.root.view()});
  return found;
}

/// Removes the components whose area is below the limit, and closes the gaps in every numbering.
template <class Exec>
ComponentCount drop_small_components(Exec& exec, const Components& components, QuadMesh& mesh, LaidMesh& laid,
                                     int64_t min_area_q16) {
  using namespace sheet_steps;
  const int64_t vertices = laid.position.size();
  const View<const uint32_t> root = components.root.view(), roots = components.roots.view();
  if (min_area_q16 <= 0) return {roots.size, 0};

  Buffer<int64_t> area = exec.template make<int64_t>(vertices);
  exec.fill(area.view(), int64_t(0));
  exec.for_each("areas", (mesh.quads.size() + AddAreas::kRun - 1) / AddAreas::kRun,
                AddAreas{mesh.quads.view(), laid.position.view(), root, area.view()});
  const int64_t kept = exec.sum(roots.size, IsLargeEnough{roots, area.view(), min_area_q16});
  if (kept < roots.size) keep_components(exec, mesh, laid, {root, area.view(), min_area_q16});
  return {kept, roots.size - kept};
}

}  // namespace isoshell
