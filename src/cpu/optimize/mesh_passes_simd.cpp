#include "cpu/optimize/mesh_passes_simd.h"

#include <algorithm>

#include "core/vector_versions.h"
#include "cpu/relax/walk_ahead.h"

namespace isoshell {
namespace {

using namespace optimize;

constexpr int kLanes = 16;

struct TriangleLanes {
  double bx[kLanes], by[kLanes], bz[kLanes], cx[kLanes], cy[kLanes], cz[kLanes];
  double area[3][kLanes], x[3][kLanes], y[3][kLanes], z[3][kLanes], cotangent[3][kLanes];
  double nx[kLanes], ny[kLanes], nz[kLanes];

  void set(int i, PointQ8 a, PointQ8 b, PointQ8 c) {
    const Vector ab = from_to(a, b), ac = from_to(a, c);
    bx[i] = ab.x, by[i] = ab.y, bz[i] = ab.z, cx[i] = ac.x, cy[i] = ac.y, cz[i] = ac.z;
  }
  TriangleCells at(int i) const {
    TriangleCells out;
    for (int k = 0; k < 3; ++k) {
      out.part[k] = {area[k][i], x[k][i], y[k][i], z[k][i]};
      out.cotangent[k] = cotangent[k][i];
    }
    out.normal = {nx[i], ny[i], nz[i]};
    return out;
  }
};

ISOSHELL_VECTOR_VERSIONS void measure_lanes(TriangleLanes& l) {
  for (int i = 0; i < kLanes; ++i) {
    const TriangleCells cells = cells_of_triangle({l.bx[i], l.by[i], l.bz[i]}, {l.cx[i], l.cy[i], l.cz[i]});
    l.area[0][i] = cells.part[0].area, l.area[1][i] = cells.part[1].area, l.area[2][i] = cells.part[2].area;
    l.x[0][i] = cells.part[0].x, l.x[1][i] = cells.part[1].x, l.x[2][i] = cells.part[2].x;
    l.y[0][i] = cells.part[0].y, l.y[1][i] = cells.part[1].y, l.y[2][i] = cells.part[2].y;
    l.z[0][i] = cells.part[0].z, l.z[1][i] = cells.part[1].z, l.z[2][i] = cells.part[2].z;
    l.cotangent[0][i] = cells.cotangent[0], l.cotangent[1][i] = cells.cotangent[1],
    l.cotangent[2][i] = cells.cotangent[2];
    l.nx[i] = cells.normal.x, l.ny[i] = cells.normal.y, l.nz[i] = cells.normal.z;
  }
}

struct MeasureGroup {
  MeshPasses passes;
  View<const PointQ8> at;
  void operator()(int64_t group) const {
    const int64_t begin = group * kLanes, last = passes.mesh.triangles.size - 1;
    TriangleLanes lanes;
    for (int i = 0; i < kLanes; ++i) {
      const TriangleIndices t = passes.mesh.triangles[std::min(begin + i, last)];
      lanes.set(i, at[t.a], at[t.b], at[t.c]);
    }
    measure_lanes(lanes);
    for (int i = 0; i < kLanes && begin + i <= last; ++i) passes.take(uint32_t(begin + i), lanes.at(i));
  }
};

struct IsBeyondDelaunay {
  DelaunayKey key;
  bool operator()(int64_t h) const { return key.is_beyond(uint32_t(h)); }
};
struct ClaimListed {
  ClaimVertices<DelaunayKey> claim;
  View<const uint32_t> listed;
  void operator()(int64_t i) const { claim(listed[i]); }
};
struct ListedWins {
  WinsItsVertices<DelaunayKey> winner;
  View<const uint32_t> listed;
  bool operator()(int64_t i) const { return winner(listed[i]); }
};
struct FlipListed {
  FlipInPass flip;
  View<const uint32_t> listed, winners;
  void operator()(int64_t i) const { flip(listed[winners[i]]); }
};

void flip_edges(CpuExecutor& exec, const MeshPasses& passes, int32_t pass) {
  const DelaunayKey key = delaunay_key(passes, pass);
  const Buffer<uint32_t> listed = exec.select(passes.mesh.twin.size, IsBeyondDelaunay{key});
  if (listed.empty()) return;
  exec.for_each("claim flips", listed.size(), ClaimListed{{key, passes.claim}, listed.view()});
  const Buffer<uint32_t> winners = exec.select(listed.size(), ListedWins{{key, passes.claim}, listed.view()});
  exec.for_each("flip edges", winners.size(), FlipListed{{passes, pass}, listed.view(), winners.view()});
}

}  // namespace

void CpuMeshPasses::run(CpuExecutor& exec, const MeshPasses& passes) {
  const int64_t vertices = passes.home.size, triangles = passes.mesh.triangles.size;
  exec.fill(passes.claim, uint64_t(0));
  for (int32_t pass = 0; pass < passes.options.passes; ++pass) {
    exec.for_each("measure cells", (triangles + kLanes - 1) / kLanes, MeasureGroup{passes, passes.from(pass)});
    if (passes.flips(pass)) flip_edges(exec, passes, pass);
    exec.for_each("move in ring", vertices, MoveInRing{passes, pass, passes.noise_q8(pass)});
    if (passes.returns(pass))
      WalksAhead::to_targets(exec, "return onto sheet", passes.walk, passes.home, ReturnOntoSheet{passes, pass});
  }
}

}  // namespace isoshell
