// triangulate_flat (see flat_patches.h).
#include "pipeline/defects/flat_patches.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "features/cutting/cut_piece.h"
#include "geometry/segment.h"
#include "repair/holes/plane_triangulation.h"

namespace isoshell {
namespace {

constexpr double kMostOffPlane = 2;   ///< 1/256 voxel: vertices are rounded to whole steps
constexpr double kLeastCosine = 0.3;  ///< of triangles to the plane that a patch of walls is seen on
constexpr double kScale = 32;         ///< of coordinates in the plane, in which points are rounded once more
constexpr double kNearBorder = 0.5;   ///< edge lengths, below which a free seed is left out

WorldPoint point(PointQ8 p) { return {double(p.x), double(p.y), double(p.z)}; }

/// Coordinates in a plane, as seen from outside.
struct Plane {
  WorldPoint origin, normal, u, v;

  Plane(const WorldPoint& o, const WorldPoint& n) : origin(o), normal((1 / length(n)) * n) {
    const WorldPoint axis = std::abs(normal.x) < 0.6 ? WorldPoint{1, 0, 0} : WorldPoint{0, 1, 0};
    u = cross(axis, normal);
    u = (1 / length(u)) * u;
    v = cross(normal, u);
  }
  double off(const WorldPoint& p) const { return std::abs(dot(p - origin, normal)); }
  PlanePoint at(const WorldPoint& p) const {
    const auto whole = [](double x) { return std::llround(x * kScale) + kLargestInPlane / 2; };
    return {whole(dot(p - origin, u)), whole(dot(p - origin, v))};
  }
};

/// What the patches of a surface consist of.
struct PatchParts {
  std::vector<WorldPoint> area;                             ///< sum of the doubled area vectors
  std::vector<double> least_cosine;                         ///< of triangles to that
  std::vector<std::vector<std::vector<uint32_t>>> borders;  ///< per border the fixed seeds along it
  std::vector<std::vector<uint32_t>> free_seeds;

  PatchParts(const CutSurface& cut, const SeedSet& seeds)
      : area(patch_count(cut), {0, 0, 0}), least_cosine(area.size(), 1), borders(area.size()), free_seeds(area.size()) {
    const SurfaceMesh& surface = cut.surface;
    const auto area_of = [&](const TriangleIndices& t) {
      return doubled_area(point(surface.position[t.a]), point(surface.position[t.b]), point(surface.position[t.c]));
    };
    for (const TriangleIndices& t : surface.triangles) area[surface.patch[t.a]] = area[surface.patch[t.a]] + area_of(t);
    for (const TriangleIndices& t : surface.triangles) {
      const WorldPoint own = area_of(t), &all = area[surface.patch[t.a]];
      double& least = least_cosine[surface.patch[t.a]];
      if (const double size = length(own) * length(all); size > 0) least = std::min(least, dot(own, all) / size);
    }
    for (int64_t c = 0; c < surface.chains.count(); ++c) {
      std::vector<uint32_t> along;
      for (int64_t i = surface.chains.first[c]; i < surface.chains.first[c + 1]; ++i) {
        const uint32_t v = surface.chains.vertex[i], seed = seeds.fixed.of_vertex[v];
        if (seeds.home[seed] == v) along.push_back(seed);
      }
      borders[surface.patch[surface.chains.vertex[surface.chains.first[c]]]].push_back(std::move(along));
    }
    for (int64_t s = seeds.fixed.count; s < seeds.size(); ++s)
      free_seeds[surface.patch[seeds.home[s]]].push_back(uint32_t(s));
  }
};

using Triangles = std::vector<std::array<uint32_t, 3>>;

class FlatPatch {
 public:
  FlatPatch(const CutSurface& cut, const SeededMesh& made, const PatchParts& parts, uint32_t patch)
      : cut_(cut), made_(made), parts_(parts), patch_(patch) {}

  /// Triangles of seeds; none where the patch is not flat, or its border meets itself.
  std::optional<Triangles> triangulate() {
    if (parts_.borders[patch_].empty() || !(length(parts_.area[patch_]) > 0)) return {};
    const Plane plane(position(parts_.borders[patch_][0][0]), parts_.area[patch_]);
    if (!is_flat(plane) && !is_seen_once()) return {};
    list_borders();
    for (const uint32_t seed : parts_.free_seeds[patch_])
      if (!is_near_border(seed)) seeds_.push_back(seed);
    std::vector<PlanePoint> points;
    for (const uint32_t seed : seeds_) points.push_back(plane.at(position(seed)));
    auto triangles = triangulate_plane(points, lines_);
    if (!triangles) return {};
    *triangles = left_of(lines_, *triangles);
    for (auto& t : *triangles)
      for (uint32_t& corner : t) corner = seeds_[corner];
    return triangles;
  }

 private:
  WorldPoint position(uint32_t seed) const { return point(made_.mesh.position[seed]); }

  /// Whether no two parts of walls lie on top of each other, as seen along the normal of the plane.
  bool is_seen_once() const { return cut_.regions && parts_.least_cosine[patch_] > kLeastCosine; }

  bool is_flat(const Plane& plane) const {
    const auto& patch = cut_.surface.patch;
    const auto [begin, end] = std::equal_range(patch.begin(), patch.end(), patch_);
    for (auto v = begin; v != end; ++v)
      if (plane.off(point(cut_.surface.position[v - patch.begin()])) > kMostOffPlane) return false;
    return true;
  }

  void list_borders() {
    for (const std::vector<uint32_t>& border : parts_.borders[patch_])
      for (size_t i = 0; i < border.size(); ++i) {
        const auto first = uint32_t(seeds_.size() - i);
        lines_.push_back({uint32_t(seeds_.size()), i + 1 < border.size() ? uint32_t(seeds_.size()) + 1 : first});
        seeds_.push_back(border[i]);
      }
  }

  bool is_near_border(uint32_t seed) const {
    const EdgeLengths& lengths = cut_.surface.lengths;
    const uint32_t home = made_.seeds.home[seed];
    const double near = kNearBorder * (lengths.at.empty() ? cut_.longest_edge_q8 : double(lengths.at[home]));
    return std::any_of(lines_.begin(), lines_.end(), [&](const std::array<uint32_t, 2>& line) {
      return distance_to_segment(position(seed), position(seeds_[line[0]]), position(seeds_[line[1]])) < near;
    });
  }

  const CutSurface& cut_;
  const SeededMesh& made_;
  const PatchParts& parts_;
  uint32_t patch_;
  std::vector<uint32_t> seeds_;                 ///< per point
  std::vector<std::array<uint32_t, 2>> lines_;  ///< between points
};

}  // namespace

std::vector<char> triangulate_flat(const CutSurface& cut, const std::vector<char>& is_chosen, SeededMesh& made) {
  const PatchParts parts(cut, made.seeds);
  std::vector<char> is_done(is_chosen.size(), 0);
  std::vector<TriangleIndices> triangles;
  for (uint32_t patch = 0; patch < is_chosen.size(); ++patch) {
    if (!is_chosen[patch]) continue;
    const auto flat = FlatPatch(cut, made, parts, patch).triangulate();
    if (!flat) continue;
    is_done[patch] = 1;
    for (const auto& [a, b, c] : *flat) triangles.push_back({a, b, c});
  }
  if (triangles.empty()) return is_done;
  for (const TriangleIndices& t : made.mesh.triangles)
    if (!is_done[cut.surface.patch[made.seeds.home[t.a]]]) triangles.push_back(t);
  made.mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  std::copy(triangles.begin(), triangles.end(), made.mesh.triangles.begin());
  return is_done;
}

}  // namespace isoshell
