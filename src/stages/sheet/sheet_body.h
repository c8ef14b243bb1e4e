// build_sheet (see stages.h), written once over an executor: from sites to a closed 2-manifold on the surface.
#pragma once

#include <algorithm>

#include "isoshell/advanced/stages.h"
#include "isoshell/error.h"
#include "stages/sheet/sheet_closing_body.h"
#include "stages/sheet/sheet_components_body.h"
#include "stages/sheet/sheet_off_surface_body.h"
#include "stages/sheet/sheet_project_body.h"
#include "stages/sheet/sheet_quads_body.h"
#include "stages/sheet/sheet_repair_body.h"
#include "stages/sparse/drop_empty_leaves.h"
#include "voxel/proxy_depth.h"

namespace isoshell {
namespace sheet_steps {

struct SplitQuads {
  View<const Quad> quads;
  View<const PointQ8> position;
  View<TriangleIndices> triangles;
  ISOSHELL_HD void operator()(int64_t i) const {
    const SplitQuad split = split_quad(quads[i], position);
    triangles[2 * i] = split.first;
    triangles[2 * i + 1] = split.second;
  }
};

struct CountTrianglesAround {
  View<const TriangleIndices> triangles;
  View<uint32_t> count;
  ISOSHELL_HD void operator()(int64_t t) const {
    atomic_add(count[triangles[t].a], 1u);
    atomic_add(count[triangles[t].b], 1u);
    atomic_add(count[triangles[t].c], 1u);
  }
};

/// Each triangle takes a place at each of its corners, in any order: `end` of a vertex falls to its first place.
struct TakePlaces {
  View<const TriangleIndices> triangles;
  View<uint32_t> end, around;
  ISOSHELL_HD void operator()(int64_t t) const {
    const uint32_t corner[3] = {triangles[t].a, triangles[t].b, triangles[t].c};
    for (const uint32_t v : corner) around[atomic_take_one_below(end[v])] = uint32_t(t);
  }
};

struct SortAround {
  View<const uint32_t> first;
  View<uint32_t> around;
  ISOSHELL_HD void operator()(int64_t v) const {
    for (int64_t i = first[v] + 1; i < first[v + 1]; ++i) {
      const uint32_t t = around[i];
      int64_t at = i;
      for (; at > first[v] && around[at - 1] > t; --at) around[at] = around[at - 1];
      around[at] = t;
    }
  }
};

/// Direction of the area vectors around a vertex before projection; where they cancel, of the lattice faces, and where
/// those cancel too, of the first triangle that has area.
struct FindNormal {
  View<const TriangleIndices> triangles;
  View<const uint32_t> first;
  View<const uint32_t> around;
  View<const PointQ8> smooth;
  View<Normal8> normal;  ///< as given that of the lattice
  ISOSHELL_HD void operator()(int64_t v) const {
    Vec64 sum = {0, 0, 0}, any = {0, 0, 0};
    for (int64_t i = first[v]; i < first[v + 1]; ++i) {
      const Vec64 n = area_vector(triangles[around[i]], smooth);
      sum = sum + n;
      if (is_zero(any)) any = n;
    }
    if (is_zero(sum)) sum = {normal[v].x, normal[v].y, normal[v].z};
    normal[v] = normal8(is_zero(sum) ? any : sum);
  }
  ISOSHELL_HD static bool is_zero(Vec64 n) { return n.x == 0 && n.y == 0 && n.z == 0; }
};

/// A coarse proxy's vertices go to about where the surface is.
struct MoveIn {
  View<const Normal8> normal;
  View<PointQ8> position;
  ISOSHELL_HD void operator()(int64_t v) const {
    position[v] = moved_by_proxy_depth(position[v], normal[v], -kOneVoxelQ8);
  }
};

/// A block's centre is that of its leaf's voxels.
struct PlaceBlock {
  View<const uint64_t> leaf_key;
  View<PointQ8> centre;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    constexpr int32_t kHalfLeafVox = 4;
    const Voxel l = leaf_of_key(leaf_key[leaf]);
    const auto middle = [](int32_t leaf_coordinate) { return (leaf_coordinate * 8 + kHalfLeafVox) * kOneVoxelQ8; };
    centre[leaf] = {middle(l.x), middle(l.y), middle(l.z)};
  }
};

/// Cuts the vertices into blocks, the leaves of their lattice corners.
template <class Exec>
void cut_into_blocks(Exec& exec, Sheet& sheet) {
  const BlockExtent extent(sheet.corners.view());
  for (int axis = 0; axis < 3; ++axis) sheet.extent_vox[axis] = extent.vox[axis];
  const int64_t leaves = sheet.corners.leaf_count();
  sheet.blocks.first = exec.template make<int64_t>(leaves + 1);
  exec.copy(View<const int64_t>(sheet.corners.first.view()), sheet.blocks.first.view());
  sheet.blocks.centre = exec.template make<PointQ8>(leaves);
  exec.for_each("place blocks", leaves, PlaceBlock{sheet.corners.leaf_key.view(), sheet.blocks.centre.view()});
}

/// Fills vertex_first and vertex_triangles.
struct PlainListTrianglesAround {
  template <class Exec>
  static void run(Exec& exec, SurfaceMesh& sheet) {
    const int64_t vertices = sheet.vertex_count(), triangles = sheet.triangles.size();
    sheet.vertex_first = exec.template make<uint32_t>(vertices + 1);
    exec.fill(sheet.vertex_first.view(), 0u);
    exec.for_each("count triangles around", triangles,
                  CountTrianglesAround{sheet.triangles.view(), sheet.vertex_first.view()});
    exec.inclusive_scan(sheet.vertex_first.view());
    sheet.vertex_triangles = exec.template make<uint32_t>(3 * triangles);
    exec.for_each("list triangles around", triangles,
                  TakePlaces{sheet.triangles.view(), sheet.vertex_first.view(), sheet.vertex_triangles.view()});
    exec.for_each("sort triangles around", vertices,
                  SortAround{sheet.vertex_first.view(), sheet.vertex_triangles.view()});
  }
};

/// The boundary of the sites' closed, well-composed solid.
template <class Exec>
QuadMesh boundary_of_sites(Exec& exec, const SiteSet& sites, int32_t closing_vox) {
  Solid solid = close_sites(exec, sites, closing_vox);
  if (make_well_composed(exec, solid) > 0)
    fill_cavities(exec, solid, sites.hollows.view());  // an addition may wall up a pocket
  return list_boundary(exec, solid);
}

/// Euler: V - E + F = 2 components - 2 genus; a quad has two edges of its own.
inline int64_t genus_of(int64_t components, int64_t vertices, int64_t quads) {
  return components - (vertices - quads) / 2;
}

/// Drops small components, splits the quads and finds what belongs to each vertex.
template <class Exec>
Sheet finish_sheet(Exec& exec, const LatticeFrame& frame, QuadMesh mesh, Components found, LaidMesh laid,
                   int64_t min_component_area_q16) {
  const ComponentCount components = drop_small_components(exec, found, mesh, laid, min_component_area_q16);
  found = {};
  mesh.edges = {};
  if (components.kept == 0)
    throw Error(ErrorCode::nothing_to_mesh, "sheet",
                "all " + std::to_string(components.dropped) + " components are smaller than " +
                    std::to_string(min_component_area_q16 >> 16) + " square voxels; lower the limit");
  constexpr int64_t kMostTriangles = int64_t(kNone) / 3;  // their corners are counted in 32 bits
  if (mesh.quads.size() * 2 >= kMostTriangles)
    throw Error(ErrorCode::out_of_memory, "sheet",
                "the sheet has " + std::to_string(mesh.quads.size() * 2) + " triangles; at most " +
                    std::to_string(kMostTriangles) + " can be numbered; lower the resolution");

  Sheet sheet;
  sheet.frame = frame;
  sheet.corners = std::move(mesh.corners);
  cut_into_blocks(exec, sheet);
  sheet.position = std::move(laid.position);
  sheet.source_triangle = std::move(laid.source_triangle);
  sheet.triangles = exec.template make<TriangleIndices>(2 * mesh.quads.size());
  exec.for_each("split quads", mesh.quads.size(),
                SplitQuads{mesh.quads.view(), sheet.position.view(), sheet.triangles.view()});
  mesh.quads = {};
  Exec::Kernels::ListTrianglesAround::run(exec, sheet);
  sheet.normal = std::move(mesh.lattice_normal);
  exec.for_each("normals", sheet.vertex_count(),
                FindNormal{sheet.triangles.view(), sheet.vertex_first.view(), sheet.vertex_triangles.view(),
                           laid.smooth.view(), sheet.normal.view()});
  sheet.topology.components = components.kept;
  sheet.topology.genus = genus_of(components.kept, sheet.vertex_count(), sheet.triangles.size() / 2);
  sheet.topology.dropped_components = components.dropped;
  sheet.topology.bridged_vertices = exec.sum(sheet.vertex_count(), IsBridge{sheet.source_triangle.view()});
  return sheet;
}

}  // namespace sheet_steps

template <class Exec>
Sheet build_sheet_body(Exec& exec, const LatticeSurface& surface, const SiteSet& solid_voxels, const SiteSet& sites,
                       const SiteSamples& samples, SiteSamples* spent, const SheetOptions& options) {
  using namespace sheet_steps;
  QuadMesh mesh = boundary_of_sites(exec, solid_voxels, options.closing_vox);
  Components components = find_components(exec, mesh);
  const bool is_one = components.roots.size() == 1;  // of several, small ones may go with their handles
  if (options.genus != kNoGenus && is_one) {
    Sheet unfinished;
    unfinished.topology.components = 1;
    unfinished.topology.genus = genus_of(1, mesh.corners.voxel_count(), mesh.quads.size());
    if (unfinished.topology.genus > std::max<int64_t>(0, options.genus)) return unfinished;
  }
  const SitedSurfaceView surface_view = {surface.points.view(), surface.triangles.view(), sites.voxels.view(),
                                         samples.first.view(), samples.triangles.view()};
  LaidMesh laid = lay_onto_surface(exec, mesh, surface_view, options.closing_vox > 0);
  if (spent && (options.genus == kNoGenus || is_one)) *spent = {};
  Sheet sheet = finish_sheet(exec, surface.frame, std::move(mesh), std::move(components), std::move(laid),
                             options.min_component_area_q16);
  if (surface.topology.closed && surface.topology.oriented) find_off_surface(exec, surface, sheet);
  return sheet;
}

template <class Exec>
Sheet build_proxy_body(Exec& exec, const SiteSet& sites, const LatticeFrame& frame, const SheetOptions& options) {
  using namespace sheet_steps;
  QuadMesh mesh = boundary_of_sites(exec, sites, options.closing_vox);
  Components components = find_components(exec, mesh);
  LaidMesh laid = lay_smooth(exec, mesh);
  Sheet sheet = finish_sheet(exec, frame, std::move(mesh), std::move(components), std::move(laid),
                             options.min_component_area_q16);
  if (options.move_in)
    exec.for_each("move in", sheet.vertex_count(), MoveIn{sheet.normal.view(), sheet.position.view()});
  return sheet;
}

}  // namespace isoshell
