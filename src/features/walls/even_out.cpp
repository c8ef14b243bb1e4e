// even_out (see even_out.h).
#include "features/walls/even_out.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "core/watched.h"
#include "features/walls/coarsen.h"
#include "geometry/half_edges.h"
#include "isoshell/advanced/voxel_set.h"
#include "voxel/closest_point.h"

namespace isoshell {
namespace {

constexpr uint32_t kStepsBetweenLooks = 1024;
constexpr int kRounds = 16;
constexpr int kRoundsToSplit = 4;    ///< edges are split in every one of so many
constexpr double kLong = 1.35;       ///< mean edges: longer ones are split
constexpr int64_t kMostSplits = 16;  ///< one vertex in so many, at once

class Evening {
 public:
  Evening(WallMesh& mesh, const Context& context) : mesh_(mesh), cut_(mesh.lookup().cut()), context_(context) {}

  void flip_edges() {
    for (uint32_t t = 0; t < mesh_.triangles().size(); ++t) {
      look_at_cancel(t);
      for (size_t i = 0; i < 3; ++i) mesh_.flip(t, i);
    }
  }
  void move_vertices() {
    for (uint32_t v = 0; v < mesh_.vertices().size(); ++v) {
      look_at_cancel(v);
      if (mesh_.around(v).empty()) continue;
      if (mesh_.vertex(v).kind == RegionVertex::Kind::free) move_free(v);
      if (mesh_.vertex(v).kind == RegionVertex::Kind::on_curve) move_along(v);
    }
  }
  void split_long_edges(int64_t most) {
    for (const uint64_t edge : long_edges()) {
      if (most == 0) return;
      most -= split(uint32_t(edge >> 32), uint32_t(edge)) ? 1 : 0;
    }
  }

 private:
  void look_at_cancel(uint32_t step) const {
    if (step % kStepsBetweenLooks == 0) check_cancel(context_, "features");
  }

  /// The longest first, in terms of the length aimed at.
  std::vector<uint64_t> long_edges() const {
    std::vector<std::pair<double, uint64_t>> edges;
    for (const RegionTriangle& t : mesh_.triangles())
      for (size_t i = 0; i < 3 && !t.is_gone(); ++i) {
        const auto [u, v] = std::minmax(t.corner[i], t.corner[(i + 1) % 3]);
        const double aimed_at = mesh_.aimed_at(u) + mesh_.aimed_at(v);
        edges.push_back({-std::sqrt(distance_sq(mesh_.at(u), mesh_.at(v))) / aimed_at, uint64_t(u) << 32 | v});
      }
    std::sort(edges.begin(), edges.end());
    edges.erase(std::unique(edges.begin(), edges.end()), edges.end());
    double sum = 0;
    for (const auto& edge : edges) sum += edge.first;
    std::vector<uint64_t> out;
    for (const auto& edge : edges)
      if (edge.first < kLong * sum / double(edges.size())) out.push_back(edge.second);
    return out;
  }

  bool split(uint32_t u, uint32_t v) {
    const std::optional<uint32_t> curve = mesh_.curve_between(u, v);
    if (!curve) return false;
    using Kind = RegionVertex::Kind;
    const Kind kind = *curve == kNone ? Kind::free : Kind::on_curve;
    if (mesh_.vertex(u).kind != kind) std::swap(u, v);
    if (mesh_.vertex(u).kind != kind) return false;
    const RegionVertex& from = mesh_.vertex(u);
    const std::optional<RegionVertex> middle = kind == Kind::free
                                                   ? on_surface_near(from, 0.5 * (mesh_.at(u) + mesh_.at(v)))
                                                   : along(from, way_to(v, from) / 2);
    return middle && mesh_.split(u, v, *middle);
  }

  void move_free(uint32_t v) {
    WorldPoint sum{0, 0, 0};
    double areas = 0;
    for (const uint32_t t : mesh_.around(v)) {
      const auto& c = mesh_.triangles()[t].corner;
      const double area = triangle_area(mesh_.at(c[0]), mesh_.at(c[1]), mesh_.at(c[2]));
      sum = sum + (area / 3) * (mesh_.at(c[0]) + mesh_.at(c[1]) + mesh_.at(c[2]));
      areas += area;
    }
    if (!(areas > 0)) return;
    const WorldPoint from = mesh_.at(v), way = (1 / areas) * sum - from;
    for (const double part : {1., .5, .25}) {
      const std::optional<RegionVertex> there = on_surface_near(mesh_.vertex(v), from + part * way);
      if (there && mesh_.move(v, *there)) return;
    }
  }

  /// The point of the surface that is nearest to one, in the triangles around the vertex of it that is. None where that
  /// is on a border.
  std::optional<RegionVertex> on_surface_near(const RegionVertex& from, const WorldPoint& near) const {
    RegionVertex out = from;
    out.home = mesh_.lookup().nearest_from(from.home, near);
    if (cut_.place[out.home] != kNone) return {};
    const SurfaceMesh& surface = cut_.surface;
    double nearest = std::numeric_limits<double>::infinity();
    for (int64_t n = surface.vertex_first[out.home]; n < surface.vertex_first[out.home + 1]; ++n) {
      const TriangleIndices t = surface.triangles[surface.vertex_triangles[n]];
      const PointQ8 at =
          closest_point_on_triangle(rounded(near), surface.position[t.a], surface.position[t.b], surface.position[t.c]);
      const WorldPoint there{double(at.x), double(at.y), double(at.z)};
      if (const double d = distance_sq(there, near); d < nearest) nearest = d, out.position = there;
    }
    return out;
  }

  void move_along(uint32_t v) {
    mesh_.list_targets(v, ends_);
    if (ends_.size() != 2) return;
    const RegionVertex from = mesh_.vertex(v);
    const double way = (way_to(ends_[0], from) + way_to(ends_[1], from)) / 2;
    for (const double part : {1., .5})
      if (mesh_.move(v, along(from, part * way))) return;
  }

  /// From a vertex on a curve to the next one, along it; negative towards its beginning.
  double way_to(uint32_t next, const RegionVertex& from) const {
    const RegionVertex& to = mesh_.vertex(next);
    const CutCurve& curve = cut_.curves[from.curve];
    const double here = curve.at_q8[from.at], half = curve.length_q8 / 2;
    if (to.kind == RegionVertex::Kind::corner) {
      const uint32_t place = cut_.place[to.home];
      const bool is_first = curve.place.front() == place, is_last = curve.place.back() == place;
      return (is_last && (!is_first || here > half) ? curve.length_q8 : 0) - here;
    }
    const double way = curve.at_q8[to.at] - here;
    if (!curve.is_loop || std::abs(way) <= half) return way;
    return way > 0 ? way - curve.length_q8 : way + curve.length_q8;
  }

  /// The place of a curve that is nearest to so far from a vertex on it, no corner.
  RegionVertex along(const RegionVertex& from, double way) const {
    const CutCurve& curve = cut_.curves[from.curve];
    const std::vector<double>& at = curve.at_q8;
    double wanted = at[from.at] + way;
    if (curve.is_loop && wanted < 0) wanted += curve.length_q8;
    if (curve.is_loop && wanted >= curve.length_q8) wanted -= curve.length_q8;
    auto i = size_t(std::lower_bound(at.begin(), at.end(), wanted) - at.begin());
    if (i == at.size() || (i > 0 && wanted - at[i - 1] < at[i] - wanted)) --i;
    if (!curve.is_loop) i = std::min(std::max(i, size_t(1)), at.size() - 2);
    RegionVertex out = from;
    out.at = i;
    out.home = mesh_.lookup().home_on(from.curve, i);
    out.position = mesh_.lookup().position(out.home);
    return out;
  }

  WallMesh& mesh_;
  const CutSurface& cut_;
  const Context& context_;
  std::vector<uint32_t> ends_;
};

}  // namespace

void even_out(WallMesh& mesh, int64_t vertices, const Context& context) {
  Evening evening(mesh, context);
  for (int round = 0; round < kRounds; ++round) {
    evening.flip_edges();
    evening.move_vertices();
    if (round % kRoundsToSplit != 0 || mesh.vertex_count() > vertices) continue;
    evening.split_long_edges(vertices / kMostSplits);
    coarsen(mesh, vertices, context);
  }
  evening.flip_edges();
}

}  // namespace isoshell
