// with_given_lines (see given_lines.h).
#include "pipeline/patches/given_lines.h"

#include <algorithm>
#include <cmath>
#include <sstream>

#include "geometry/triangle_grid.h"
#include "geometry/triangle_list.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "isoshell/readable.h"

namespace isoshell {
namespace {

constexpr double kFarthest = .5;         ///< of an edge length, from the surface
constexpr double kSameVertex = 1. / 32;  ///< of a voxel: what is nearer becomes one vertex

/// Throws: usage for lines that no reader made.
void check(const Polylines& lines) {
  for (size_t s = 0; s < lines.segments.size(); ++s)
    for (const uint32_t p : lines.segments[s]) {
      const std::string name = "the lines to keep: " + lines.name_of(s);
      if (p >= lines.points.size())
        throw Error(ErrorCode::usage, "features",
                    name + " names point " + std::to_string(p) + "; there are " + std::to_string(lines.points.size()));
      if (!is_finite(lines.points[p]))
        throw Error(ErrorCode::usage, "features", name + " has a point that is not finite");
    }
}

/// The points on the mesh, and how far they are from where they were.
struct SnappedPoints {
  std::vector<PointOnMesh> points;
  std::vector<double> distance_world;
};
SnappedPoints snapped(const FeatureMesh& mesh, const Polylines& lines) {
  const TriangleGrid grid(mesh.vertices, mesh.triangles);
  SnappedPoints out;
  for (const WorldPoint& p : lines.points) {
    const MeshPoint found = grid.nearest(p);
    out.points.push_back({found.triangle, grid.at(found)});
    out.distance_world.push_back(std::sqrt(found.distance_sq));
  }
  return out;
}

LostCurve lost_segment(const Polylines& lines, size_t segment, const std::string& reason) {
  const auto [from, to] = lines.segments[segment];
  return {int64_t(segment), "line", length(lines.points[to] - lines.points[from]), lines.points[from], reason};
}

std::string distance_reason(double distance_world, double limit_world) {
  std::ostringstream text;
  text << "it is " << distance_world << " from the surface, more than half an edge length, " << limit_world;
  return text.str();
}

void tell(const Polylines& lines, std::vector<LostCurve>& lost, Run& run) {
  if (lost.empty()) return;
  std::sort(lost.begin(), lost.end(), [](const LostCurve& a, const LostCurve& b) { return a.index < b.index; });
  const std::string first = lines.name_of(size_t(lost.front().index)) + ": " + lost.front().reason;
  if (lost.size() == lines.segments.size())
    throw Error(ErrorCode::usage, "features",
                "no line to keep is on the surface; " + first + "; give lines in the units and the place of the input");
  run.warn(counted(int64_t(lost.size()), "segment") + " of " + counted(int64_t(lines.segments.size()), "segment") +
           " of lines to keep " + (lost.size() == 1 ? "is" : "are") + " left out; " + first);
}

}  // namespace

MeshWithLines with_given_lines(FeatureMesh mesh, const Polylines& lines, const std::vector<EdgeList>& followed,
                               double edge_length_world, double voxel_size, std::vector<LostCurve>& lost, Run& run) {
  check(lines);
  const double limit = kFarthest * edge_length_world;
  const SnappedPoints on = snapped(mesh, lines);
  LinesOnMesh near{{}, {}};
  std::vector<size_t> number;  // per segment of these
  std::vector<uint32_t> point(lines.points.size(), UINT32_MAX);
  for (size_t s = 0; s < lines.segments.size(); ++s) {
    const auto [from, to] = lines.segments[s];
    const double farther = std::max(on.distance_world[from], on.distance_world[to]);
    if (farther > limit) {
      lost.push_back(lost_segment(lines, s, distance_reason(farther, limit)));
      continue;
    }
    for (const uint32_t p : {from, to})
      if (point[p] == UINT32_MAX) {
        point[p] = uint32_t(near.points.size());
        near.points.push_back(on.points[p]);
      }
    near.segments.push_back({point[from], point[to]});
    number.push_back(s);
  }
  MeshWithLines embedded = embed_lines(std::move(mesh), near, followed, kSameVertex * voxel_size);
  for (const size_t s : embedded.lost_segments)
    lost.push_back(lost_segment(lines, number[s], "the surface leads no way from one end to the other"));
  tell(lines, lost, run);
  return embedded;
}

}  // namespace isoshell
