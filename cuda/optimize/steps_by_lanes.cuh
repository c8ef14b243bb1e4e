// Smoothing and fit (see stages/optimize/optimize_steps.h) on the device. A small mesh has eight lanes a vertex, which
// share its triangles, since a thread a vertex would leave most of the device idle. They are listed once: who follows
// half-edges waits for each before the next. A large mesh has a thread a vertex, as the plain step does. Samples are
// pulled a lane each, and what those of one triangle ask for is added up within a warp first.
#pragma once

#include <utility>

#include "cuda/relax/group_walk.cuh"
#include "cuda/runtime/executor_cuda.cuh"
#include "stages/optimize/optimize_steps.h"

namespace isoshell::optimize {
namespace step_lanes {

constexpr int kLanes = cuda_relax::kWalkLanes;
constexpr int kRounds = 2;                  ///< a lane has so many triangles
constexpr int kPlaces = kRounds * kLanes;   ///< for triangles around a vertex
constexpr int kVertices = 8;                ///< a block
constexpr int64_t kMostVertices = 1 << 15;  ///< of a small mesh
constexpr uint32_t kMany = kNone - 1;

/// A triangle (v, b, c) around a vertex v.
struct TriangleAround {
  uint32_t half_edge;  ///< from v to b; kNone: there is no triangle; kMany, of a vertex's first: more than places
  uint32_t b, c;
};

/// Those of all vertices, in the order of for_each_half_edge_around.
struct TrianglesAround {
  View<TriangleAround> all;
  ISOSHELL_HD TriangleAround& at(int64_t v, int place) const { return all[v * kPlaces + place]; }
};

struct ListAround {
  MeshView mesh;
  TrianglesAround around;
  ISOSHELL_HD void operator()(int64_t v) const {
    int count = 0;
    for_each_half_edge_around(mesh, uint32_t(v), [&](uint32_t h) {
      if (count < kPlaces) around.at(v, count) = {h, mesh.to(h), mesh.opposite(h)};
      ++count;
    });
    if (count > kPlaces) around.at(v, 0).half_edge = kMany;
    for (; count < kPlaces; ++count) around.at(v, count) = {kNone, 0, 0};
  }
};

/// What the triangles around a vertex ask for, a column each, in shared memory.
template <class Sums>
struct Terms {
  static_assert(sizeof(Sums) % sizeof(double) == 0, "nothing but doubles");
  static constexpr int kTerms = sizeof(Sums) / sizeof(double);
  double of[kTerms][kPlaces];

  __device__ void put(int place, const Sums& sums) {
    const double* const term = reinterpret_cast<const double*>(&sums);
#pragma unroll
    for (int k = 0; k < kTerms; ++k) of[k][place] = term[k];
  }
  /// Adds the first columns in their order, as one thread would; by all lanes of the vertex.
  __device__ Sums sum_of(int triangles, int lane) {
    __syncwarp();
    for (int k = lane; k < kTerms; k += kLanes) {
      double sum = 0;
      for (int i = 0; i < triangles; ++i) sum += of[k][i];
      of[k][0] = sum;
    }
    __syncwarp();
    Sums sums;
    double* const out = reinterpret_cast<double*>(&sums);
#pragma unroll
    for (int k = 0; k < kTerms; ++k) out[k] = of[k][0];
    return sums;
  }
};

/// The last part of a step, by all lanes of its vertex. Result: where the vertex goes; only the first lane knows.
__device__ inline PointQ8 finish(const SmoothVertex& step, int64_t v, bool active, int lane,
                                 const SmoothingSums& sums) {
  PointQ8 place = step.from[v];
  if (lane == 0 && active) place = step.place(v, sums);
  if (step.options.onto_sheet) {
    const int first = int(threadIdx.x) & 31 & ~(kLanes - 1);
    const PointQ8 target = {__shfl_sync(kWholeWarp, place.x, first), __shfl_sync(kWholeWarp, place.y, first),
                            __shfl_sync(kWholeWarp, place.z, first)};
    const cuda_relax::Landing landing = cuda_relax::walk_together(step.walk, step.home[v], target, active);
    if (lane == 0 && active) step.home[v] = landing.vertex, place = landing.point;
  }
  return place;
}
__device__ inline PointQ8 finish(const FitVertex& step, int64_t v, bool active, int lane, const FitSums& sums) {
  return lane == 0 && active ? step.place(v, sums) : step.from[v];
}

template <class Step>
__global__ void __launch_bounds__(kVertices* kLanes) step_by_lanes(int64_t count, Step step, TrianglesAround around) {
  using Sums = typename Step::Sums;
  __shared__ Terms<Sums> terms[kVertices];
  const int lane = int(threadIdx.x) % kLanes, slot = int(threadIdx.x) / kLanes;
  const int64_t vertex = int64_t(blockIdx.x) * kVertices + slot;
  const int64_t v = vertex < count ? vertex : count - 1;  // the lanes of a warp stay together
  const bool active = vertex < count && !step.is_locked(v);
  const PointQ8 p = step.from[v];
  const double radius = step.radius_q8(v);
  const bool many = around.at(v, 0).half_edge == kMany;
  int triangles = 0;
#pragma unroll
  for (int round = 0; round < kRounds; ++round) {
    const int place = round * kLanes + lane;
    const TriangleAround mine = around.at(v, place);
    const bool has_triangle = active && !many && mine.half_edge != kNone;
    if (has_triangle) {
      Sums own;
      step.add(mine.half_edge, p, step.from[mine.b], step.from[mine.c], radius, own);
      terms[slot].put(place, own);
    }
    const unsigned lanes = __ballot_sync(kWholeWarp, has_triangle) >> (threadIdx.x & 31 & ~(kLanes - 1));
    triangles += __popc(lanes & ((1u << kLanes) - 1));
  }
  Sums sums = terms[slot].sum_of(triangles, lane);
  if (many && active && lane == 0)
    for_each_half_edge_around(step.mesh, uint32_t(v), [&](uint32_t h) {
      step.add(h, p, step.from[step.mesh.to(h)], step.from[step.mesh.opposite(h)], radius, sums);
    });
  const PointQ8 place = finish(step, v, active, lane, sums);
  if (lane == 0 && vertex < count) step.to[v] = place;
}

/// The sample's number above its triangle, which is what they are sorted by; those without one come last.
struct KeySample {
  View<const FitSample> samples;
  uint32_t triangles;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t triangle = samples[i].triangle;
    key[i] = uint64_t(i) << 32 | (triangle == kNone ? triangles : triangle);
  }
};
struct GatherSample {
  View<const uint64_t> key;
  View<const FitSample> samples;
  View<FitSample> sorted;
  ISOSHELL_HD void operator()(int64_t i) const { sorted[i] = samples[int64_t(key[i] >> 32)]; }
};

constexpr int kPullThreads = 128;

__device__ inline int64_t shuffled_down(int64_t value, int d) { return __shfl_down_sync(kWholeWarp, value, d); }

/// A run of lanes with samples of one triangle adds its sums at once.
__global__ void __launch_bounds__(kPullThreads) pull_by_runs(PullCorners step) {
  const int64_t i = int64_t(blockIdx.x) * kPullThreads + threadIdx.x;
  const int lane = int(threadIdx.x) & 31;
  uint32_t triangle = kNone;
  TrianglePull asked{};
  if (i < step.sample.size) {
    FitSample s = step.sample[i];
    Foot foot;
    if (step.slide_to_foot(i, s, foot)) asked = step.asked_of_triangle(i, s, foot);
    triangle = s.triangle;
  }
  const uint32_t before = __shfl_up_sync(kWholeWarp, triangle, 1);
  const bool is_first = lane == 0 || before != triangle;
  const unsigned later_runs = __ballot_sync(kWholeWarp, is_first) & ~((2u << lane) - 1);
  const int end = later_runs ? __ffs(int(later_runs)) - 1 : 32;  // of the lane's run
#pragma unroll
  for (int d = 1; d < 32; d <<= 1)
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      const int64_t weight = shuffled_down(asked.weight[k], d), pull = shuffled_down(asked.pull[k], d);
      if (lane + d < end) asked.weight[k] += weight, asked.pull[k] += pull;
    }
  if (is_first && triangle != kNone) step.add_to_triangle(triangle, asked);
}

}  // namespace step_lanes

class StepsByLanes {
 public:
  void begin(CudaExecutor& exec, const MeshView& mesh) {
    using namespace step_lanes;
    const int64_t vertices = mesh.valence.size;
    if (vertices > kMostVertices) return;
    if (listed_.empty()) listed_ = exec.make<TriangleAround>(vertices * kPlaces);
    exec.for_each("list triangles around", vertices, ListAround{mesh, {listed_.view()}});
  }
  void smooth(CudaExecutor& exec, const SmoothVertex& step) { run(exec, "smooth", step); }
  void fit(CudaExecutor& exec, const FitVertex& step) { run(exec, "fit", step); }
  /// Those of the sheet by triangle, once: few slide to another one later.
  void sort(CudaExecutor& exec, int64_t triangles, int64_t of_sheet, Buffer<FitSample>& samples) {
    if (is_sorted_ || of_sheet == 0) return;
    is_sorted_ = true;
    int bits = 1;
    while (triangles >> bits) ++bits;
    Buffer<uint64_t> key = exec.make<uint64_t>(of_sheet);
    exec.for_each("key samples", of_sheet, step_lanes::KeySample{samples.view(), uint32_t(triangles), key.view()});
    sort_keys_async(exec.device(), key.view(), bits);
    Buffer<FitSample> sorted = exec.make<FitSample>(samples.size());
    exec.for_each("gather samples", of_sheet, step_lanes::GatherSample{key.view(), samples.view(), sorted.view()});
    const int64_t others = samples.size() - of_sheet;
    exec.copy(View<const FitSample>(samples.view()).part(of_sheet, others), sorted.view().part(of_sheet, others));
    samples = std::move(sorted);
  }
  void pull(CudaExecutor& exec, const PullCorners& step) {
    using namespace step_lanes;
    if (step.sample.empty()) return;
    pull_by_runs<<<blocks_for(step.sample.size, kPullThreads), kPullThreads, 0, exec.stream()>>>(step);
    exec.check("pull corners");
  }

 private:
  template <class Step>
  void run(CudaExecutor& exec, const char* name, const Step& step) {
    using namespace step_lanes;
    const int64_t count = step.to.size;
    if (count > kMostVertices) return exec.for_each(name, count, step);
    step_by_lanes<<<blocks_for(count, kVertices), kVertices * kLanes, 0, exec.stream()>>>(count, step,
                                                                                          {listed_.view()});
    exec.check(name);
  }

  Buffer<step_lanes::TriangleAround> listed_;
  bool is_sorted_ = false;
};

}  // namespace isoshell::optimize
