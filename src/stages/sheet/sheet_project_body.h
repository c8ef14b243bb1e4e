// The part of build_sheet that lays the quad mesh onto the surface: smoothing, projection, bridges over gaps.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/sheet/sheet_quads_body.h"
#include "voxel/exact_int.h"
#include "voxel/nearest_triangle.h"

namespace isoshell {

constexpr int kSheetSmoothingSteps = 2;                 ///< before projection
constexpr int kProxySmoothingSteps = 6;                 ///< even: odd ones turn checkerboards of corners over
constexpr int kBridgeSteps = 60;                        ///< for vertices over a gap, after projection
constexpr int64_t kBridgeDistanceQ8 = 2 * kOneVoxelQ8;  ///< vertices farther from the surface are over a gap

namespace sheet_steps {

/// Vertex numbers of the corners of a leaf and of those beyond its faces, with the ranks of all words at hand.
class CornersAround {
 public:
  ISOSHELL_HD CornersAround(const VoxelSetView& corners, int64_t leaf) {
    load(corners, uint32_t(leaf), 0);
    const Voxel l = leaf_of_key(corners.leaf_key[leaf]);
    for (int f = 0; f < 6; ++f) load(corners, find_leaf(corners, step_through(l, f)), 1 + f);
  }
  /// Of the corner through a face of the one at `offset`; any number where there is none.
  ISOSHELL_HD uint32_t through(int face, int offset) const {
    const int shift = face < 2 ? 6 : face < 4 ? 3 : 0, axis = 7 << shift, step = face & 1 ? 1 << shift : -(1 << shift);
    const int to = (offset & ~axis) | ((offset + step) & axis);
    const bool stays = (offset & axis) != (face & 1 ? axis : 0);
    const int n = stays ? 0 : 1 + face;
    return first_[n][to >> 6] + uint32_t(popcount64(word_[n][to >> 6] & ((uint64_t(1) << (to & 63)) - 1)));
  }

 private:
  ISOSHELL_HD void load(const VoxelSetView& corners, uint32_t leaf, int n) {
    uint32_t at = leaf == kNone ? 0 : uint32_t(corners.first[leaf]);
    for (int w = 0; w < 8; ++w) {
      word_[n][w] = leaf == kNone ? 0 : corners.mask[leaf].word[w];
      first_[n][w] = at;
      at += uint32_t(popcount64(word_[n][w]));
    }
  }
  uint32_t first_[7][8];  ///< of the leaf itself, then through each face
  uint64_t word_[7][8];
};

/// Six coordinates fit 32 bits, twice; so does what rounding needs.
ISOSHELL_HD inline int32_t rounded_mean(int32_t sum, int32_t count) {
  const int32_t n = 2 * sum + count, d = 2 * count;
  return n / d - (n % d < 0);
}
ISOSHELL_HD inline PointQ8 mean_of(PointQ8 sum, int32_t count) {
  return {rounded_mean(sum.x, count), rounded_mean(sum.y, count), rounded_mean(sum.z, count)};
}
ISOSHELL_HD inline PointQ8 sum_of(PointQ8 a, PointQ8 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }

/// One umbrella step: every vertex goes to the mean of its neighbours.
struct SmoothCorners {
  VoxelSetView corners;
  View<const uint8_t> edges;
  View<const PointQ8> from;
  View<PointQ8> to;
  ISOSHELL_HD void operator()(int64_t leaf) const {
    const CornersAround around(corners, leaf);
    for_each_active(corners, leaf, [&](int offset, int64_t v) { smooth(around, offset, v); });
  }
  /// Edges that are not there add zeros: which of the six are is not to be foreseen, and costs more than it spares.
  ISOSHELL_HD void smooth(const CornersAround& around, int offset, int64_t v) const {
    const uint8_t on = edges[v];
    PointQ8 sum = {0, 0, 0};
    for (int f = 0; f < 6; ++f) {
      const int32_t is_on = on >> f & 1;
      const PointQ8 n = from[is_on ? int64_t(around.through(f, offset)) : v];
      sum = sum_of(sum, {is_on * n.x, is_on * n.y, is_on * n.z});
    }
    to[v] = mean_of(sum, popcount64(on));
  }
};

/// Moves vertices from where they went with one smoothing by what a second one moved them, the other way.
struct GiveBack {
  View<const PointQ8> twice;
  View<PointQ8> once;
  ISOSHELL_HD void operator()(int64_t v) const {
    const PointQ8 p = once[v], q = twice[v];
    once[v] = {2 * p.x - q.x, 2 * p.y - q.y, 2 * p.z - q.z};
  }
};

/// Puts every vertex on the nearest triangle. Only with `may_bridge` a vertex farther than two voxels stays in place.
struct ProjectVertex {
  SitedSurfaceView surface;
  bool may_bridge;
  View<const PointQ8> smooth;
  View<PointQ8> position;
  View<uint32_t> source_triangle;
  ISOSHELL_HD void operator()(int64_t v) const {
    NearestTriangleSearch search(surface, smooth[v]);
    bool found = search.search(1) || search.search(2);
    if (may_bridge) found = search.best().distance_sq_q16 <= kBridgeDistanceQ8 * kBridgeDistanceQ8;
    for (int32_t reach = 4; !found && !may_bridge && reach <= 16; reach *= 2) found = search.search(reach);
    position[v] = found ? search.best().point : smooth[v];
    source_triangle[v] = found ? search.best().triangle : kNone;
  }
};

struct IsBridge {
  View<const uint32_t> source_triangle;
  ISOSHELL_HD bool operator()(int64_t v) const { return source_triangle[v] == kNone; }
};

/// Neighbours of the bridging vertices: six places each, those beyond the last neighbour hold kNone.
struct ListBridgeNeighbours {
  VoxelSetView corners;
  View<const uint8_t> edges;
  View<const uint32_t> bridges;
  View<uint32_t> neighbours;
  ISOSHELL_HD void operator()(int64_t i) const {
    const Voxel corner = voxel_of_index(corners, bridges[i]);
    int count = 0;
    for (int f = 0; f < 6; ++f)
      if (edges[bridges[i]] >> f & 1)
        neighbours[6 * i + count++] = uint32_t(find_voxel(corners, step_through(corner, f)));
    while (count < 6) neighbours[6 * i + count++] = kNone;
  }
};

struct SmoothBridge {
  View<const uint32_t> neighbours;
  View<const PointQ8> position;
  View<PointQ8> moved;  ///< per bridging vertex
  ISOSHELL_HD void operator()(int64_t i) const {
    PointQ8 sum = {0, 0, 0};
    int32_t count = 0;
    for (; count < 6 && neighbours[6 * i + count] != kNone; ++count)
      sum = sum_of(sum, position[neighbours[6 * i + count]]);
    moved[i] = mean_of(sum, count);
  }
};

struct MoveBridge {
  View<const uint32_t> bridges;
  View<const PointQ8> moved;
  View<PointQ8> position;
  ISOSHELL_HD void operator()(int64_t i) const { position[bridges[i]] = moved[i]; }
};

template <class Exec>
void smooth_bridges(Exec& exec, const QuadMesh& mesh, View<const uint32_t> source_triangle, View<PointQ8> position) {
  const Buffer<uint32_t> bridges = exec.select(source_triangle.size, IsBridge{source_triangle});
  if (bridges.empty()) return;
  Buffer<uint32_t> neighbours = exec.template make<uint32_t>(6 * bridges.size());
  exec.for_each("neighbours on bridges", bridges.size(),
                ListBridgeNeighbours{mesh.corners.view(), mesh.edges.view(), bridges.view(), neighbours.view()});
  Buffer<PointQ8> moved = exec.template make<PointQ8>(bridges.size());
  for (int step = 0; step < kBridgeSteps; ++step) {
    exec.for_each("smooth bridges", bridges.size(), SmoothBridge{neighbours.view(), position, moved.view()});
    exec.for_each("move bridges", bridges.size(), MoveBridge{bridges.view(), moved.view(), position});
  }
}

}  // namespace sheet_steps

/// The quad mesh with its vertices where they belong.
struct LaidMesh {
  Buffer<PointQ8> smooth;  ///< before projection: sides are plain here
  Buffer<PointQ8> position;
  Buffer<uint32_t> source_triangle;
};

/// Takes vertices to the means of their neighbours, `steps` times.
template <class Exec>
void smooth_corners(Exec& exec, const QuadMesh& mesh, int steps, Buffer<PointQ8>& position, Buffer<PointQ8>& scratch) {
  for (int step = 0; step < steps; ++step) {
    exec.for_each("smooth", mesh.corners.leaf_count(),
                  sheet_steps::SmoothCorners{mesh.corners.view(), mesh.edges.view(), position.view(), scratch.view()});
    std::swap(position, scratch);
  }
}

/// Smooths only: the vertices stay where the solid's boundary is, and have no source. What smoothing takes from the
/// volume is what as many steps more would take, so that much is given back.
template <class Exec>
LaidMesh lay_smooth(Exec& exec, QuadMesh& mesh) {
  using namespace sheet_steps;
  LaidMesh laid;
  const int64_t vertices = mesh.position.size();
  laid.position = std::move(mesh.position);
  laid.smooth = exec.template make<PointQ8>(vertices);
  Buffer<PointQ8> scratch = exec.template make<PointQ8>(vertices);
  smooth_corners(exec, mesh, kProxySmoothingSteps, laid.position, scratch);
  exec.copy(View<const PointQ8>(laid.position.view()), laid.smooth.view());
  smooth_corners(exec, mesh, kProxySmoothingSteps, laid.smooth, scratch);
  exec.for_each("give back", vertices, GiveBack{laid.smooth.view(), laid.position.view()});
  laid.source_triangle = exec.template make<uint32_t>(vertices);
  exec.fill(laid.source_triangle.view(), kNone);
  return laid;
}

/// Runs the step for all vertices, which are the mesh's corners.
struct PlainProjectVertices {
  template <class Exec>
  static void run(Exec& exec, const VoxelSetView&, const sheet_steps::ProjectVertex& step) {
    exec.for_each("project", step.position.size, step);
  }
};

template <class Exec>
LaidMesh lay_onto_surface(Exec& exec, QuadMesh& mesh, const SitedSurfaceView& surface, bool may_bridge) {
  using namespace sheet_steps;
  LaidMesh laid;
  const int64_t vertices = mesh.position.size();
  laid.smooth = std::move(mesh.position);
  laid.position = exec.template make<PointQ8>(vertices);
  laid.source_triangle = exec.template make<uint32_t>(vertices);
  smooth_corners(exec, mesh, kSheetSmoothingSteps, laid.smooth, laid.position);
  Exec::Kernels::ProjectVertices::run(
      exec, mesh.corners.view(),
      ProjectVertex{surface, may_bridge, laid.smooth.view(), laid.position.view(), laid.source_triangle.view()});
  smooth_bridges(exec, mesh, laid.source_triangle.view(), laid.position.view());
  return laid;
}

}  // namespace isoshell
