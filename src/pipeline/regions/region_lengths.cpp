// See region_lengths.h.
#include "pipeline/regions/region_lengths.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>
#include <map>
#include <set>
#include <sstream>

#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "isoshell/error.h"
#include "pipeline/grid/sizing.h"

namespace isoshell {
namespace {

constexpr int32_t kFiner = 4;      ///< few walls come to intersect; on a much finer lattice cells take longer
constexpr int32_t kMostFiner = 8;  ///< where the corners of walls are points of the lattice
constexpr size_t kMostNamed = 20;  ///< regions that a message lists

[[noreturn]] void refuse(const std::string& what) {
  throw Error(ErrorCode::usage, "regions", "--region-edge-length " + what);
}

std::set<int32_t> labels_of(const FaceRegions& regions) {
  std::set<int32_t> labels;
  for (const auto& pair : regions.labels) labels.insert(pair.begin(), pair.end());
  labels.erase(regions.background);
  return labels;
}

std::string listed(const std::set<int32_t>& labels, const std::vector<RegionName>& names) {
  std::string list;
  size_t count = 0;
  for (const int32_t label : labels) {
    if (++count > kMostNamed) return list + " and " + std::to_string(labels.size() - kMostNamed) + " more";
    list += (count > 1 ? ", " : "") + std::to_string(label);
    for (const RegionName& name : names)
      if (name.label == label) list += " (" + name.name + ")";
  }
  return list;
}

/// The region of that label, or else those of that name.
std::vector<int32_t> labels_called(const std::string& region, const std::set<int32_t>& labels,
                                   const std::vector<RegionName>& names) {
  int32_t label = 0;
  const char* const end = region.data() + region.size();
  const auto [stop, failed] = std::from_chars(region.data(), end, label);
  const bool is_label = failed == std::errc() && stop == end && labels.count(label) > 0;
  std::vector<int32_t> called;
  for (const RegionName& name : names)
    if (name.name == region && labels.count(name.label) > 0) called.push_back(name.label);
  if (is_label && !called.empty() && called != std::vector<int32_t>{label})
    refuse("gives '" + region + "', which is a label and the name of region " + std::to_string(called[0]) +
           "; give labels: " + listed(labels, names));
  if (is_label) return {label};
  if (called.empty()) refuse("names region '" + region + "', which is not there; regions are " + listed(labels, names));
  return called;
}

double shorter(double a, double b) { return a > 0 && b > 0 ? std::min(a, b) : std::max(a, b); }

/// What the field says at a triangle, the shortest of it, or 0.
double shortest_at(const std::vector<double>& field, const std::array<uint32_t, 3>& triangle) {
  double shortest = 0;
  for (const uint32_t v : triangle) shortest = shorter(shortest, field[v]);
  return shortest;
}

/// Voxels along the longest side that carry the shortest edges asked for, where the run chooses them.
int32_t resolution_for_walls(const TriangleSoup& soup, const Plan& plan, const std::vector<double>& of_face_world) {
  const int32_t usual = plan.first_resolution();
  if (!plan.chooses_grid() || !wants_lengths(plan.options)) return usual;
  const double least = LengthsOnWalls(soup, plan, of_face_world).least_world();
  return std::max(usual, resolution_for_cell(longest_side(plan.box), kCellOfEdge * least, plan.target.vertices));
}

}  // namespace

std::vector<double> lengths_of_faces_world(const FaceRegions& regions, const std::vector<RegionEdgeLength>& lengths) {
  if (lengths.empty()) return {};
  const std::set<int32_t> labels = labels_of(regions);
  std::map<int32_t, double> length_of;
  for (const RegionEdgeLength& l : lengths)
    for (const int32_t label : labels_called(l.region, labels, regions.names))
      if (!length_of.try_emplace(label, l.edge_length_world).second)
        refuse("gives region " + std::to_string(label) + " a length twice, the second time as '" + l.region +
               "'; give it once");
  std::vector<double> of_face;
  of_face.reserve(regions.labels.size());
  for (const auto& [behind, front] : regions.labels) {
    const auto a = length_of.find(behind), b = length_of.find(front);
    of_face.push_back(shorter(a != length_of.end() ? a->second : 0, b != length_of.end() ? b->second : 0));
  }
  return of_face;
}

LengthsOnWalls::LengthsOnWalls(const TriangleSoup& walls, const Plan& plan, const std::vector<double>& of_face_world)
    : walls_(walls),
      of_face_world_(of_face_world),
      usual_world_(plan.target.edge_length_world),
      least_world_(std::numeric_limits<double>::infinity()) {
  if (plan.options.sizing) field_world_ = plan.options.sizing->lengths_at(walls.vertices);
  for (size_t t = 0; t < walls.triangles.size(); ++t) {
    const double length = asked_world(t);
    least_world_ = std::min(least_world_, length);
    const auto& [a, b, c] = walls.triangles[t];
    vertices_ += triangle_area(walls.vertices[a], walls.vertices[b], walls.vertices[c]) /
                 (kCellOfEdge * kCellOfEdge * length * length);
  }
  if (field_decides(plan.options)) return;
  scale_ = std::sqrt(vertices_ / double(plan.target.vertices));
  vertices_ = double(plan.target.vertices);
}

double LengthsOnWalls::asked_world(size_t triangle) const {
  double length = of_face_world_.empty() ? 0 : of_face_world_[triangle];
  if (length <= 0 && !field_world_.empty()) length = shortest_at(field_world_, walls_.triangles[triangle]);
  return length > 0 ? length : usual_world_;
}

LatticeFrame frame_of_walls(const TriangleSoup& walls, const Plan& plan, const std::vector<double>& of_face_world) {
  const WorldPoint &low = plan.box.min, &high = plan.box.max;
  const int32_t resolution = resolution_for_walls(walls, plan, of_face_world);
  const bool is_periodic = walls.regions.is_periodic();  // a translation by a period must be one on the lattice
  if (!walls.regions.are_of_voxels || !(plan.chooses_grid() || is_periodic)) return plan.frame(resolution);
  const double step_world = walls.regions.voxel_size_world;
  const auto steps_along = [&](double side) { return std::max(std::ceil(side / step_world - 0.5 / kOneVoxelQ8), 1.); };
  const int32_t most = std::min(is_periodic ? kMaxResolution : kMostFiner * resolution, kMaxResolution - 1);
  if (is_periodic && (step_world <= 0 || steps_along(longest_side(plan.box)) > most))
    throw Error(ErrorCode::usage, "regions",
                "a periodic volume has at most " + std::to_string(most) +
                    " times the shortest side of its voxels along each axis; make it coarser");
  if (step_world <= 0 || steps_along(longest_side(plan.box)) > most)
    return LatticeFrame::around(low, high, std::min(kFiner * resolution, kMaxResolution));
  const auto steps = int32_t(steps_along(longest_side(plan.box)));
  const double parts_wanted = double(resolution - 1) / steps;  // the nearest number, or one that carries all lengths
  const auto parts = int32_t(wants_lengths(plan.options) ? std::ceil(parts_wanted) : std::floor(parts_wanted + 0.5));
  const auto end = [&](double from, double to) { return from + steps_along(to - from) * step_world; };
  return LatticeFrame::around(low, {end(low.x, high.x), end(low.y, high.y), end(low.z, high.z)},
                              steps * std::clamp(parts, 1, (kMaxResolution - 1) / steps) + 1);
}

std::vector<std::string> warnings_of_bounds(const RequestedLengths& requested) {
  std::vector<std::string> warnings;
  if (requested.of_face_world.empty()) return warnings;
  double least = std::numeric_limits<double>::infinity(), most = 0;
  for (const double length : requested.of_face_world) {
    const double here = length > 0 ? length : requested.usual_world;
    least = std::min(least, here);
    most = std::max(most, here);
  }
  const double shortest = std::max(least, requested.shortest_world);
  const auto warn = [&](double asked, const char* bound, double allowed, const std::string& why) {
    std::ostringstream text;
    text << "edges of " << asked << " are asked for; they are at " << bound << ' ' << allowed << ", " << why;
    warnings.push_back(text.str());
  };
  if (least < shortest) warn(least, "least", shortest, "the shortest that the grid carries: raise --resolution");
  if (most > kMostLengthRatio * shortest)
    warn(most, "most", kMostLengthRatio * shortest, std::to_string(int(kMostLengthRatio)) + " times the shortest");
  return warnings;
}

}  // namespace isoshell
