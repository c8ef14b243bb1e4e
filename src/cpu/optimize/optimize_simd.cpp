#include "cpu/optimize/optimize_simd.h"

#include <algorithm>

#include "cpu/optimize/pull_simd.h"
#include "cpu/optimize/vertex_simd.h"
#include "cpu/relax/walk_ahead.h"

namespace isoshell {
namespace {

using namespace optimize;

struct CountTrianglesAround {
  MeshView mesh;
  View<uint32_t> count;
  void operator()(int64_t v) const {
    uint32_t n = 0;
    for_each_triangle_around(mesh, uint32_t(v), [&](uint32_t, uint32_t) { ++n; });
    count[v] = n;
  }
};

struct ListTrianglesAround {
  MeshView mesh;
  View<const uint32_t> first;
  View<TrianglesAround::Triangle> triangles;
  void operator()(int64_t v) const {
    uint32_t at = first[v];
    for_each_half_edge_around(mesh, uint32_t(v), [&](uint32_t h) {
      triangles[at++] = {mesh.to(h), mesh.opposite(h), h};
    });
  }
};

/// A few vertices, one after the other in their order.
struct VertexGroup {
  View<const uint32_t> first;
  View<const TrianglesAround::Triangle> triangles;
  View<const PointQ8> position;

  static constexpr int kLanes = VertexSimd::kLanes;
  int64_t groups() const { return (position.size + kLanes - 1) / kLanes; }

  /// Calls each(lanes, i, half-edge) for every triangle that vertex i of the group has, add(lanes) after one of each.
  template <class Each, class Add>
  void sum(int64_t group, VertexSimd& lanes, Each each, Add add) const {
    const int64_t begin = group * kLanes;
    const int count = count_of(group);
    uint32_t most = 0;
    for (int i = 0; i < count; ++i) most = std::max(most, first[begin + i + 1] - first[begin + i]);
    for (uint32_t n = 0; n < most; ++n) {
      for (int i = 0; i < kLanes; ++i) {
        const int64_t v = begin + std::min(i, count - 1);
        const bool is_there = i < count && n < first[v + 1] - first[v];
        const TrianglesAround::Triangle& t = triangles[first[v] + (is_there ? n : 0)];
        lanes.to_b.set(i, position[v], position[t.b]);
        lanes.to_c.set(i, position[v], position[t.c]);
        lanes.is_there[i] = is_there ? 1 : 0;
        each(lanes, i, t.half_edge);
      }
      add(lanes);
    }
  }
  int count_of(int64_t group) const { return int(std::min<int64_t>(kLanes, position.size - group * kLanes)); }
};

struct SmoothVertices {
  SmoothVertex step;
  VertexGroup vertices;

  void operator()(int64_t group) const {
    const int64_t begin = group * VertexSimd::kLanes;
    const int count = vertices.count_of(group);
    VertexSimd lanes;
    lanes.clear();
    for (int i = 0; i < count; ++i) lanes.radius_q8[i] = step.radius_q8(begin + i);
    vertices.sum(
        group, lanes, [](VertexSimd&, int, uint32_t) {}, [&](VertexSimd& l) { l.add(step.options.evenness); });
    for (int i = 0; i < count; ++i) {
      const FitSums s = lanes.sums(i);
      step.to[begin + i] =
          step.is_locked(begin + i) ? step.from[begin + i] : step.place(begin + i, {s.corners, s.normal, {s.planes}});
    }
  }
};

struct LayOntoSheet {
  SmoothVertex step;
  bool aims(int64_t v, PointQ8& target) const {
    target = step.to[v];
    return !step.is_locked(v);
  }
  void arrives(int64_t v, uint32_t vertex, PointQ8 p) const { step.home[v] = vertex, step.to[v] = p; }
};

/// Some groups, whose vertices may walk.
struct FitVertices {
  FitVertex step;
  VertexGroup vertices;
  WalkAhead ahead;

  static constexpr int64_t kGroups = 8;
  int64_t runs() const { return (vertices.groups() + kGroups - 1) / kGroups; }

  void operator()(int64_t run) const {
    const int64_t end = std::min(vertices.groups(), (run + 1) * kGroups);
    for (int64_t group = run * kGroups; group < end; ++group) fit(group, std::min(step.to.size, end * vertices.kLanes));
  }

 private:
  void fit(int64_t group, int64_t end) const {
    const int64_t begin = group * VertexSimd::kLanes;
    const int count = vertices.count_of(group);
    VertexSimd lanes;
    lanes.clear();
    for (int i = 0; i < count; ++i) lanes.radius_q8[i] = step.radius_q8(begin + i);
    vertices.sum(
        group, lanes,
        [&](VertexSimd& l, int i, uint32_t h) {
          const TrianglePull& asked = step.triangle_pull[h / 3];
          l.weight[i] = double(asked.weight[h % 3]), l.pull[i] = double(asked.pull[h % 3]);
        },
        [&](VertexSimd& l) { l.add_with_pulls(step.options.smooth.evenness); });
    for (int i = 0; i < count; ++i) {
      ahead.before(begin + i, end);
      step.to[begin + i] = step.is_locked(begin + i) ? step.from[begin + i] : step.place(begin + i, lanes.sums(i));
    }
  }
};

/// Some samples, one after the other in their order, which has most of a triangle's samples side by side.
struct PullSamples {
  PullCorners step;
  const TrianglesAround& around;
  bool alone;  ///< no other thread adds to the same sums

  static constexpr int64_t kRun = 8 * PullSimd::kLanes;
  int64_t runs() const { return (step.sample.size + kRun - 1) / kRun; }

  void operator()(int64_t run) const {
    const int64_t end = std::min(step.sample.size, (run + 1) * kRun);
    PullSimd lanes;
    for (int64_t begin = run * kRun; begin < end; begin += PullSimd::kLanes)
      pull(step.sample.part(begin, std::min<int64_t>(PullSimd::kLanes, end - begin)), begin, lanes);
  }

 private:
  void pull(View<const FitSample> samples, int64_t first, PullSimd& lanes) const {
    const int count = int(samples.size);
    for (int i = 0; i < count; ++i) lanes.set(i, samples[i].position);
    for (int begin = 0, end; begin < count; begin = end) {
      const uint32_t triangle = samples[begin].triangle;
      for (end = begin + 1; end < count && samples[end].triangle == triangle;) ++end;
      if (triangle != kNone)
        pull_one_triangle(triangle, first, begin, end, lanes);
      else
        std::fill_n(step.rest_sq.begin() + first + begin, end - begin, 0);
    }
  }
  void pull_one_triangle(uint32_t triangle, int64_t first, int begin, int end, PullSimd& lanes) const {
    const TriangleIndices t = step.mesh.triangles[triangle];
    lanes.find(begin, end, {step.position[t.a], step.position[t.b], step.position[t.c]}, step.options);
    TrianglePull sum{};
    for (int i = begin; i < end; ++i) {
      if (step.sample[first + i].is_off_surface || !(lanes.is_inside[i] > 0)) {
        pull_one(first + i);
        continue;
      }
      step.rest_sq[first + i] = int64_t(lanes.distance_sq[i]);
      for (int k = 0; k < 3; ++k) {
        sum.weight[k] += int64_t(lanes.weight[k][i]);
        sum.pull[k] += int64_t(lanes.pull[k][i]);
      }
    }
    add(sum, step.triangle_pull[triangle]);
  }
  void pull_one(int64_t i) const {
    const FitSample& s = step.sample[i];
    const Foot foot = step.foot_on(s.triangle, s.position);
    const double distance_sq = dot(foot.rest, foot.rest);
    if (step.is_far(distance_sq) && is_nearest(s, distance_sq))
      step.pull(i, s, foot);
    else
      step(i);
  }
  /// Whether no triangle around the sample's own one is nearer. Most far samples stay where they are, and what they
  /// look at takes more time than all others together.
  bool is_nearest(const FitSample& s, double distance_sq) const {
    const MeshView& mesh = step.mesh;
    FarSimd lanes;
    int count = 0;
    const auto add = [&](uint32_t t) {
      const TriangleIndices i = mesh.triangles[t];
      lanes.a.set(count, step.position[i.a]);
      lanes.b.set(count, step.position[i.b]);
      lanes.c.set(count, step.position[i.c]);
      ++count;
    };
    const uint32_t own = s.triangle, *twin = &mesh.twin[3 * own];
    const uint32_t beside[3] = {twin[0] / 3, twin[1] / 3, twin[2] / 3};  // no triangle's number on a border
    for (int k = 0; k < 3; ++k)
      if (twin[k] != kNone) add(beside[k]);
    for (int k = 0; k < 3; ++k) {
      const uint32_t v = corner(mesh.triangles[own], k);
      if (count + int(around.first[v + 1] - around.first[v]) > FarSimd::kLanes) return false;
      for (uint32_t n = around.first[v]; n < around.first[v + 1]; ++n) {
        const uint32_t t = around.triangles[n].half_edge / 3;
        if (t != own && t != beside[0] && t != beside[1] && t != beside[2]) add(t);
      }
    }
    lanes.find(s.position, count);
    return std::none_of(lanes.distance_sq, lanes.distance_sq + count, [&](double d) { return d < distance_sq; });
  }
  void add(const TrianglePull& sum, TrianglePull& to) const {
    for (int k = 0; k < 3; ++k) {
      add(sum.weight[k], to.weight[k]);
      add(sum.pull[k], to.pull[k]);
    }
  }
  void add(int64_t sum, int64_t& to) const {
    if (alone)
      to += sum;
    else
      atomic_add(to, sum);
  }
};

}  // namespace

void CpuStepSimd::begin(CpuExecutor& exec, const MeshView& mesh) {
  const int64_t vertices = mesh.outgoing.size;
  around_ = {};
  around_ = {Buffer<uint32_t>(vertices + 1), Buffer<TrianglesAround::Triangle>(mesh.twin.size)};
  around_.first[vertices] = 0;
  exec.for_each("count triangles around", vertices, CountTrianglesAround{mesh, around_.first.view()});
  exec.exclusive_scan(around_.first.view());
  exec.for_each("list triangles around", vertices,
                ListTrianglesAround{mesh, around_.first.view(), around_.triangles.view()});
}

void CpuStepSimd::smooth(CpuExecutor& exec, const SmoothVertex& step) {
  const VertexGroup vertices{around_.first.view(), around_.triangles.view(), step.from};
  exec.for_each("smooth", vertices.groups(), SmoothVertices{step, vertices});
  if (step.options.onto_sheet) WalksAhead::to_targets(exec, "lay onto sheet", step.walk, step.home, LayOntoSheet{step});
}

/// Run by run, each of which is a part of the sheet at first and stays about there: that takes memory for one run, and
/// breaks few triangles' samples apart.
void CpuStepSimd::sort(CpuExecutor& exec, int64_t triangles, int64_t of_sheet, Buffer<FitSample>& samples) {
  constexpr int64_t kRuns = 16;
  const int64_t longest = (of_sheet + kRuns - 1) / kRuns;
  const bool alone = loops_run_alone();
  Buffer<uint32_t> end(triangles + 1);  // of the places of each triangle, and of samples without one
  Buffer<FitSample> sorted(longest);
  for (int64_t begin = 0; begin < of_sheet; begin += longest) {
    const View<FitSample> run = samples.view().part(begin, std::min(longest, of_sheet - begin));
    const auto of = [&](int64_t i) -> uint32_t& { return end[std::min<int64_t>(run[i].triangle, triangles)]; };
    exec.fill(end.view(), 0u);
    exec.for_each("count samples", run.size, [&](int64_t i) { alone ? void(++of(i)) : atomic_add(of(i), 1u); });
    exec.inclusive_scan(end.view());
    exec.for_each("sort samples", run.size,
                  [&](int64_t i) { sorted[alone ? --of(i) : atomic_take_one_below(of(i))] = run[i]; });
    exec.copy(View<const FitSample>(sorted.view()).part(0, run.size), run);
  }
}

void CpuStepSimd::pull(CpuExecutor& exec, const PullCorners& step) {
  const PullSamples samples{step, around_, loops_run_alone()};
  exec.for_each("pull corners", samples.runs(), samples);
}

void CpuStepSimd::fit(CpuExecutor& exec, const FitVertex& step) {
  const VertexGroup vertices{around_.first.view(), around_.triangles.view(), step.from};
  const FitVertices work{step, vertices, WalkAhead(step.walk, step.home)};
  exec.for_each("fit", work.runs(), work);
}

}  // namespace isoshell
