// See change_paths.h.
#include "features/cutting/change_paths.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "geometry/near_points.h"
#include "geometry/point_cells.h"
#include "geometry/world_vector.h"

namespace isoshell {
namespace {

/// The vertices from one seed of a path to the next, `end` being the one after the last of a loop.
struct Segment {
  size_t begin, end;
  double end_at;
  bool is_near;
};

template <class IsNear>
std::vector<Segment> segments_of(const CurvePath& path, IsNear is_near) {
  std::vector<Segment> segments;
  for (size_t s = 0; s < path.seeds.size(); ++s) {
    const bool is_last = s + 1 == path.seeds.size();
    if (is_last && !path.is_loop) break;
    Segment segment{path.seeds[s].edge, is_last ? path.vertex.size() : path.seeds[s + 1].edge, 0, false};
    segment.end_at = is_last ? path.length : path.at[segment.end];
    for (size_t i = segment.begin; i <= segment.end && !segment.is_near; ++i)
      segment.is_near = is_near(path.vertex[i % path.vertex.size()]);
    segments.push_back(segment);
  }
  return segments;
}

/// Whether a vertex is within about `reach_q8` of points.
auto nearness(const FineMesh& mesh, const std::vector<PointQ8>& points, double reach_q8) {
  return [&mesh, near = NearPoints(points, reach_q8)](uint32_t v) { return near.holds(rounded(mesh.position[v])); };
}

/// Puts a seed at the vertex nearest to the middle of every segment that is near. Result: whether there is one.
bool halve(const std::vector<Segment>& segments, CurvePath& path) {
  std::vector<PathPoint> seeds;
  for (const Segment& segment : segments) {
    seeds.push_back({segment.begin, 0});
    if (!segment.is_near) continue;
    const double middle = (path.at[segment.begin] + segment.end_at) / 2;
    size_t nearest = segment.begin;
    for (size_t i = segment.begin; i < segment.end; ++i)
      if (std::abs(path.at[i] - middle) < std::abs(path.at[nearest] - middle)) nearest = i;
    if (nearest > segment.begin) seeds.push_back({nearest, 0});
  }
  if (!path.is_loop) seeds.push_back(path.seeds.back());
  const bool has_more = seeds.size() > path.seeds.size();
  path.seeds = std::move(seeds);
  return has_more;
}

/// The vertices of creases around points: those within an edge length of each.
class CreasesAround {
 public:
  explicit CreasesAround(const FineMesh& mesh)
      : mesh_(mesh),
        farthest_(std::max(1., *std::max_element(mesh.edge_length.begin(), mesh.edge_length.end()))),
        places_(places_on_creases(mesh)),
        cells_(points_at(places_), farthest_) {}

  /// Calls use(path, index along it).
  template <class Use>
  void for_each(PointQ8 point, Use use) const {
    const WorldPoint at{double(point.x), double(point.y), double(point.z)};
    cells_.for_each_in(widened(WorldBox{at, at}, farthest_), [&](size_t i) {
      const auto& [path, index] = places_[i];
      const uint32_t v = mesh_.paths[path].vertex[index];
      if (length(mesh_.position[v] - at) <= mesh_.edge_length[v]) use(path, index);
    });
  }

 private:
  using Place = std::pair<uint32_t, size_t>;  ///< path, index along it

  static std::vector<Place> places_on_creases(const FineMesh& mesh) {
    std::vector<Place> places;
    for (uint32_t p = 0; p < mesh.paths.size(); ++p)
      for (size_t i = 0; mesh.paths[p].kind == CurveKind::crease && i < mesh.paths[p].vertex.size(); ++i)
        places.push_back({p, i});
    return places;
  }
  std::vector<WorldPoint> points_at(const std::vector<Place>& places) const {
    std::vector<WorldPoint> points;
    for (const auto& [path, index] : places) points.push_back(mesh_.position[mesh_.paths[path].vertex[index]]);
    return points;
  }

  const FineMesh& mesh_;
  double farthest_;
  std::vector<Place> places_;
  PointCells cells_;
};

/// Flags all edges between the seeds around a vertex of a path.
void flag_segments_at(const CurvePath& path, size_t index, std::vector<char>& goes) {
  const auto after = std::partition_point(path.seeds.begin(), path.seeds.end(),
                                          [&](const PathPoint& seed) { return seed.edge <= index; });
  const auto flag = [&](size_t begin, size_t end) {
    std::fill(goes.begin() + int64_t(begin), goes.begin() + int64_t(end), char(1));
  };
  const size_t end = after == path.seeds.end() ? goes.size() : after->edge;
  const auto at = after - 1;  // a path has a seed at its first vertex
  flag(at->edge, end);
  if (at->edge != index) return;
  if (index > 0) flag((at - 1)->edge, index);
  if (index == 0 && path.is_loop) flag(path.seeds.back().edge, goes.size());
}

/// A path by its beginning, and how it is divided.
std::array<size_t, 5> key_of(const CurvePath& path) {
  return {path.is_loop, path.vertex[0], path.vertex[1], path.vertex.size(), path.seeds.size()};
}

}  // namespace

std::optional<Paths> halve_segments(const FineMesh& mesh, const std::vector<PointQ8>& points, double reach_q8) {
  const auto is_near = nearness(mesh, points, reach_q8);
  Paths paths = mesh.paths;
  bool any = false;
  for (CurvePath& path : paths) any |= halve(segments_of(path, is_near), path);
  if (!any) return {};
  return paths;
}

std::optional<Paths> drop_creases(const FineMesh& mesh, const std::vector<PointQ8>& points) {
  const CreasesAround around(mesh);
  const std::vector<double> turns = turns_of(mesh);
  const auto is_weaker = [&](uint32_t p, uint32_t q) {
    return std::make_tuple(turns[p], mesh.paths[p].length, p) < std::make_tuple(turns[q], mesh.paths[q].length, q);
  };
  EdgesOfPaths goes = no_edges_of(mesh.paths);
  bool any = false;
  for (const PointQ8 point : points) {
    std::optional<uint32_t> weakest;
    around.for_each(point, [&](uint32_t path, size_t) {
      if (!weakest || is_weaker(path, *weakest)) weakest = path;
    });
    around.for_each(point, [&](uint32_t path, size_t index) {
      if (path == *weakest) flag_segments_at(mesh.paths[path], index, goes[path]);
    });
    any |= weakest.has_value();
  }
  if (!any) return {};
  return without_edges(mesh, goes);
}

std::optional<Paths> drop_creases_at_tight_borders(const CutSurface& cut) {
  std::vector<char> is_seed(cut.copies_first.size() - 1, 0), is_tight(is_seed);
  for (const CutCurve& curve : cut.curves)
    for (const size_t s : curve.seeds) is_seed[curve.place[s]] = 1;
  const Chains& chains = cut.surface.chains;
  for (int64_t c = 0; c < chains.count(); ++c) {
    const View<const uint32_t> loop = chains.vertex.view().part(chains.first[c], chains.first[c + 1] - chains.first[c]);
    const auto seeds = std::count_if(loop.begin(), loop.end(), [&](uint32_t v) { return is_seed[cut.place[v]]; });
    for (const uint32_t v : loop) is_tight[cut.place[v]] |= seeds < 3;
  }
  Paths paths;
  bool any = false;
  for (size_t c = 0; c < cut.curves.size(); ++c) {
    CurvePath path = cut.fine->paths[c];
    const std::vector<uint32_t>& place = cut.curves[c].place;
    const bool is_wrong = std::all_of(place.begin(), place.end(), [&](uint32_t p) { return is_tight[p]; });
    const bool goes = is_wrong && path.kind == CurveKind::crease;
    any |= goes || (is_wrong && halve(segments_of(path, [](uint32_t) { return true; }), path));
    if (!goes) paths.push_back(std::move(path));
  }
  if (!any) return {};
  return paths;
}

std::vector<char> which_changed(const Paths& before, const Paths& after) {
  std::vector<std::array<size_t, 5>> keys;
  for (const CurvePath& path : after) keys.push_back(key_of(path));
  std::sort(keys.begin(), keys.end());
  std::vector<char> changed;
  for (const CurvePath& path : before) changed.push_back(!std::binary_search(keys.begin(), keys.end(), key_of(path)));
  return changed;
}

}  // namespace isoshell
