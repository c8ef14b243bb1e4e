#include "io/mesh/precision.h"

#include <algorithm>
#include <cmath>
#include <functional>

#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "isoshell/mesh_census.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr auto kLarger = [](double a, double b) { return std::max(a, b); };

WorldPoint point_in_single(const WorldPoint& p) { return {in_single(p.x), in_single(p.y), in_single(p.z)}; }

/// A power of two that makes the mesh about 1 wide: squares of its lengths are neither 0 nor infinite, and all bits
/// stay.
double scale_of(const TriangleMesh& mesh) {
  const auto reach = [&](size_t i) {
    const WorldPoint &p = mesh.vertices[i], &q = mesh.vertices[0];
    return std::max({std::abs(p.x / 2 - q.x / 2), std::abs(p.y / 2 - q.y / 2), std::abs(p.z / 2 - q.z / 2)});
  };
  const double widest = joined_over(mesh.vertices.size(), 0.0, reach, kLarger);
  return widest > 0 && std::isfinite(widest) ? std::ldexp(1, std::clamp(-std::ilogb(widest), -1020, 1020)) : 1;
}

constexpr double kMostTilt = 0.5;  ///< cosine of 60 degrees

/// A triangle is lost where its normal is; one without area has none to lose.
bool is_lost(const std::array<WorldPoint, 3>& before, const std::array<WorldPoint, 3>& after, double scale) {
  const auto normal = [&](const std::array<WorldPoint, 3>& t) {
    return cross(scale * (t[1] - t[0]), scale * (t[2] - t[0]));
  };
  const WorldPoint n = normal(before);
  const WorldPoint m = normal(after);
  return length_sq(n) > 0 && !(length_sq(m) > 0 && dot(n, m) >= kMostTilt * length(n) * length(m));
}

}  // namespace

WorldPoint Placement::written(const WorldPoint& p) const {
  const WorldPoint exact = about_origin(p);
  return type == NumberType::f32 ? point_in_single(exact) : exact;
}

WorldPoint Placement::in_file(const WorldPoint& p) const {
  const auto moved = [](double number, double by) { return by == 0 ? number : number + by; };  // keeps the sign of 0
  const WorldPoint q = written(p);
  return {moved(q.x, origin.x), moved(q.y, origin.y), moved(q.z, origin.z)};
}

std::string offset_note(const Placement& placement) {
  return is_origin(placement.offset) ? "" : "offset " + exact_place(placement.offset);
}

int64_t count_lost_triangles(const TriangleMesh& mesh, const Placement& placement) {
  const double scale = scale_of(mesh);
  const auto lost = [&](size_t i) -> int64_t {
    std::array<WorldPoint, 3> before, after;
    for (size_t c = 0; c < 3; ++c) {
      before[c] = mesh.vertices[mesh.triangles[i][c]];
      after[c] = placement.in_file(before[c]);
    }
    return is_lost(before, after, scale);
  };
  return joined_over(mesh.triangles.size(), int64_t(0), lost, std::plus<int64_t>());
}

double largest_move_world(const TriangleMesh& mesh, const Placement& placement) {
  const auto moved = [](double number, double offset, double in_file) {
    const double less = number - offset, back = less - number;
    const double rest = (number - (less - back)) - (offset + back);  // number - offset is less + rest, exactly
    return (in_file - less) - rest;
  };
  const auto moved_at = [&](size_t i) {
    const WorldPoint &p = mesh.vertices[i], &o = placement.offset, q = placement.in_file(p);
    return length({moved(p.x, o.x, q.x), moved(p.y, o.y, q.y), moved(p.z, o.z, q.z)});
  };
  return joined_over(mesh.vertices.size(), 0.0, moved_at, kLarger);
}

namespace {

/// How far single precision moves a corner of a triangle, at most, over its least height.
double largest_move_of_heights(const TriangleMesh& mesh, const WorldPoint& offset) {
  const double scale = scale_of(mesh);
  const auto scaled_sq = [&](const WorldPoint& a, const WorldPoint& b) { return length_sq(scale * (b - a)); };
  const auto moved_sq = [&](uint32_t v) {
    const WorldPoint p = mesh.vertices[v] - offset;
    return scaled_sq(point_in_single(p), p);
  };
  const auto move_sq = [&](size_t i) {
    const auto& t = mesh.triangles[i];
    const WorldPoint &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const double edge_sq[] = {scaled_sq(a, b), scaled_sq(b, c), scaled_sq(c, a)};
    const auto [least, most] = std::minmax_element(std::begin(edge_sq), std::end(edge_sq));
    const double area_sq = length_sq(cross(scale * (b - a), scale * (c - a)));
    const double height_sq = area_sq > 0 ? area_sq / *most : *least;
    const double moved = std::max({moved_sq(t[0]), moved_sq(t[1]), moved_sq(t[2])});
    return moved == 0 ? 0 : moved / height_sq;  // infinite for corners at one place that move
  };
  return std::sqrt(joined_over(mesh.triangles.size(), 0.0, move_sq, kLarger));
}

int64_t intersecting_in_single(const TriangleMesh& mesh, const WorldPoint& offset) {
  TriangleMesh in_file;
  for (const WorldPoint& p : mesh.vertices) in_file.vertices.push_back(point_in_single(p - offset));
  in_file.triangles = mesh.triangles;
  Context context;
  return count_intersecting_pairs(in_file, context);
}

}  // namespace

bool needs_double(const TriangleMesh& mesh, const WorldPoint& offset) {
  constexpr double kSurely = 1e-3, kPerhaps = 1e-4;
  const double move = largest_move_of_heights(mesh, offset);
  return move > kSurely || count_lost_triangles(mesh, {NumberType::f32, offset}) > 0 ||
         (move > kPerhaps && intersecting_in_single(mesh, offset) > 0);
}

Placement place_in_doubles(const TriangleMesh&, const WorldPoint& offset) { return {NumberType::f64, offset}; }
Placement place_in_floats(const TriangleMesh&, const WorldPoint& offset) { return {NumberType::f32, offset}; }

}  // namespace isoshell
