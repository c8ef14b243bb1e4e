// See join_solids.h.
#include "repair/solids/join_solids.h"

#include <algorithm>
#include <map>

#include "core/index_sets.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "repair/holes/repair_mesh.h"
#include "repair/solids/cut_solids.h"
#include "repair/solids/drop_slivers.h"
#include "repair/solids/swell_solids.h"
#include "repair/solids/winding.h"
#include "voxel/random.h"

namespace isoshell::repair {
namespace {

constexpr uint32_t kMostTries = 8;
constexpr double kRoundedSteps = 6;  // triangles lower than that come from rounding where edges were cut
constexpr double kSliverSteps = 2048;

/// Components of faces that share edges with one other face, each on points of its own.
std::vector<Solid> components_of(const RepairMesh& mesh) {
  IndexSets sets(mesh.face_count());
  for (uint32_t h = 0; h < 3 * mesh.face_count(); ++h)
    if (mesh.faces_at(mesh.edge_of(h)) == 2) sets.unite(h / 3, mesh.twin(h) / 3);
  std::vector<uint32_t> number(mesh.face.size(), kNoFace);
  std::vector<Solid> solids;
  std::vector<std::map<uint32_t, uint32_t>> copy;
  for (uint32_t f = 0; f < mesh.face.size(); ++f) {
    uint32_t& at = number[sets.root(f)];
    if (at == kNoFace) {
      at = uint32_t(solids.size());
      solids.emplace_back();
      copy.emplace_back();
    }
    Solid& solid = solids[at];
    Corners corner = mesh.face[f];
    for (uint32_t& v : corner) {
      const auto [found, is_new] = copy[at].emplace(v, uint32_t(solid.origin.size()));
      if (is_new) solid.origin.push_back(v);
      v = found->second;
    }
    solid.face.push_back(corner);
    solid.source.push_back(mesh.source[f]);
  }
  return solids;
}

/// An end of an edge that has not two faces which pass it in opposite directions.
std::optional<uint32_t> find_open_end(const std::vector<Corners>& faces) {
  std::vector<uint64_t> edges;
  for (const Corners& f : faces)
    for (size_t i = 0; i < 3; ++i) edges.push_back(uint64_t(f[i]) << 32 | f[(i + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  auto open = std::adjacent_find(edges.begin(), edges.end());
  if (open == edges.end())
    open = std::find_if_not(edges.begin(), edges.end(), [&](uint64_t e) {
      return std::binary_search(edges.begin(), edges.end(), e << 32 | e >> 32);
    });
  if (open == edges.end()) return {};
  return uint32_t(*open);
}

double six_volume(const std::vector<WorldPoint>& point, const std::vector<Corners>& faces) {
  double sum = 0;
  const WorldPoint& o = point[faces[0][0]];
  for (const Corners& f : faces) sum += dot(point[f[0]] - o, cross(point[f[1]] - o, point[f[2]] - o));
  return sum;
}

bool bounds_solid(const Solid& s, const std::vector<WorldPoint>& position) {
  std::vector<WorldPoint> point;
  for (const uint32_t v : s.origin) point.push_back(position[v]);
  return !find_open_end(s.face) && six_volume(point, s.face) > 0;
}

int winding_at(const RayColumns& of, const WorldPoint& p) {
  int number = 0;
  of.for_each_crossing(p, kNoFace, [&](uint32_t, int sign) { number += sign; });
  return number;
}

/// Joins solids one with another, in halves, so that few faces are looked at often.
class Joiner {
 public:
  explicit Joiner(const Context& context) : context_(context) {}

  bool is_failed = false;
  std::string reason;  ///< why, and where
  WorldPoint failed_at{0, 0, 0};
  int64_t joins = 0, cut_faces = 0;

  std::vector<Solid> join_all(std::vector<Solid>& solids, size_t begin, size_t end) {
    if (is_failed) return {};
    std::vector<Solid> joined;
    if (end - begin == 1) {
      joined.push_back(std::move(solids[begin]));
      return joined;
    }
    const size_t middle = begin + (end - begin) / 2;
    joined = join_all(solids, begin, middle);
    for (Solid& s : join_all(solids, middle, end)) add(joined, std::move(s));
    return joined;
  }

 private:
  /// To solids that lie apart.
  void add(std::vector<Solid>& apart, Solid solid) {
    WorldBox box = box_of(solid.point, solid.face);
    for (size_t i = 0; i < apart.size() && !is_failed;) {
      std::optional<Solid> both;
      if (boxes_meet(box_of(apart[i].point, apart[i].face), box)) both = join_two(apart[i], solid);
      if (!both) {
        ++i;
        continue;
      }
      solid = std::move(*both);
      box = box_of(solid.point, solid.face);
      apart.erase(apart.begin() + int64_t(i));
    }
    apart.push_back(std::move(solid));
  }

  /// None where they lie apart, or one in the other.
  std::optional<Solid> join_two(const Solid& a, const Solid& b) {
    check_cancel(context_, "unite");
    std::optional<CutSolids> cut = cut_solids(a, b, failed_at, context_);
    if (!cut) return fail("lines where they cross are too close to be told apart");
    if (cut->crossing.empty()) return {};
    Solid joined = outer_faces(std::move(*cut), a, b);
    const std::optional<uint32_t> open = joined.face.empty() ? 0 : find_open_end(joined.face);
    if (open) {
      failed_at = joined.point[*open];
      return fail("what bounds both is not closed, as where a component crosses itself");
    }
    ++joins;
    drop_slivers(joined.point, joined.face, joined.source, kRoundedSteps);
    return joined;
  }

  std::optional<Solid> fail(const char* why) {
    is_failed = true;
    reason = why;
    return {};
  }

  /// Parts between lines where surfaces cross lie in or out as a whole; their largest faces tell.
  Solid outer_faces(CutSolids cut, const Solid& a, const Solid& b) {
    cut_faces += cut.cut_faces;
    Solid& both = cut.both;
    const std::vector<uint32_t> part = parts_of(cut);
    std::vector<double> largest(both.face.size(), -1);
    std::vector<uint32_t> face(both.face.size(), kNoFace);
    for (uint32_t f = 0; f < both.face.size(); ++f) {
      const auto& [p, q, r] = both.face[f];
      const double area = triangle_area(both.point[p], both.point[q], both.point[r]);
      if (area <= largest[part[f]]) continue;
      largest[part[f]] = area;
      face[part[f]] = f;
    }
    const RayColumns of_a(a.point, a.face), of_b(b.point, b.face);
    std::vector<uint8_t> is_outside(both.face.size(), 0);
    for (uint32_t p = 0; p < both.face.size(); ++p) {
      if (face[p] == kNoFace) continue;
      const Corners& f = both.face[face[p]];
      const WorldPoint middle = (1. / 3) * (both.point[f[0]] + both.point[f[1]] + both.point[f[2]]);
      is_outside[p] = winding_at(int64_t(face[p]) < cut.faces_of_first ? of_b : of_a, middle) == 0;
    }
    Solid outer{std::move(both.point), std::move(both.origin), {}, {}};
    for (size_t f = 0; f < both.face.size(); ++f) {
      if (!is_outside[part[f]]) continue;
      outer.face.push_back(both.face[f]);
      outer.source.push_back(both.source[f]);
    }
    return outer;
  }

  static std::vector<uint32_t> parts_of(const CutSolids& cut) {
    const EdgeSides sides = find_edge_sides(cut.both.face, cut.both.point.size());
    IndexSets sets(int64_t(cut.both.face.size()));
    for_each_edge(sides, [&](uint32_t u, uint32_t v, View<const EdgeSide> on_edge) {
      if (std::binary_search(cut.crossing.begin(), cut.crossing.end(), std::array<uint32_t, 2>{u, v})) return;
      for (const EdgeSide& side : on_edge) sets.unite(on_edge[0].half_edge / 3, side.half_edge / 3);
    });
    std::vector<uint32_t> part(cut.both.face.size());
    for (uint32_t f = 0; f < part.size(); ++f) part[f] = sets.root(f);
    return part;
  }

  const Context& context_;
};

/// Those that stay follow as they were; caps come last, as they did.
TriangleSoup soup_of(const std::vector<Solid>& solids, const std::vector<Solid>& left, const RepairMesh& mesh,
                     const Steps& steps, const TriangleSoup& from) {
  TriangleSoup soup;
  soup.faces_in_file = from.faces_in_file;
  soup.dirt = from.dirt;
  std::vector<Corners> caps;
  const auto add = [&](const Solid& solid, bool is_joined) {
    std::vector<WorldPoint> point;
    for (size_t v = 0; v < solid.origin.size(); ++v)
      point.push_back(solid.origin[v] == kNoFace ? steps.to_world(solid.point[v]) : mesh.position[solid.origin[v]]);
    std::vector<Corners> face = solid.face;
    std::vector<uint32_t> source = solid.source;
    if (is_joined) drop_slivers(point, face, source, kSliverSteps * steps.a_step);
    const uint32_t shift = uint32_t(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), point.begin(), point.end());
    for (size_t f = 0; f < face.size(); ++f)
      (source[f] < from.first_cap ? soup.triangles : caps)
          .push_back({face[f][0] + shift, face[f][1] + shift, face[f][2] + shift});
  };
  for (const Solid& solid : solids) add(solid, true);
  for (const Solid& solid : left) add(solid, false);
  if (!caps.empty()) soup.first_cap = uint32_t(soup.triangles.size());
  soup.triangles.insert(soup.triangles.end(), caps.begin(), caps.end());
  return soup;
}

Solid as_one(const std::vector<Solid>& solids) {
  Solid all;
  for (const Solid& s : solids) {
    const uint32_t shift = uint32_t(all.point.size());
    all.point.insert(all.point.end(), s.point.begin(), s.point.end());
    all.origin.insert(all.origin.end(), s.origin.begin(), s.origin.end());
    all.source.insert(all.source.end(), s.source.begin(), s.source.end());
    for (const Corners& f : s.face) all.face.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
  }
  return all;
}

/// Why solids cannot be joined without the others, and where; in steps. What lies in one of them, as hollows do, does
/// so in their union, too.
std::optional<std::pair<const char*, WorldPoint>> find_obstacle(const std::vector<Solid>& solids,
                                                                const std::vector<Solid>& others,
                                                                const Context& context) {
  const Solid all = as_one(solids);
  WorldPoint at{0, 0, 0};
  const std::optional<CutSolids> cut = cut_solids(all, as_one(others), at, context);
  if (cut && !cut->crossing.empty()) at = cut->both.point[cut->crossing.front()[0]];
  if (!cut || !cut->crossing.empty()) return std::pair("a component that is open or looks inward meets them", at);
  const RayColumns of_all(all.point, all.face);
  for (const Solid& s : others)
    if (winding_at(of_all, s.point[0]) > 1)
      return std::pair("a component that is open or looks inward lies in several of them", s.point[0]);
  return {};
}

class Attempt {
 public:
  Attempt(const TriangleSoup& soup, JoinReport& report, const Context& context)
      : soup_(soup), report_(report), context_(context), mesh_(soup) {
    if (mesh_.face.empty()) return;
    for (Solid& s : components_of(mesh_)) (bounds_solid(s, mesh_.position) ? solids_ : others_).push_back(std::move(s));
  }

  std::optional<JoinedSolids> run() {
    if (solids_.size() < 2) return {};
    const Steps steps(mesh_);
    const auto give_up = [&](const std::string& why, const WorldPoint& at) {
      report_.given_up = why;
      report_.at = steps.to_world(at);
    };
    for (uint32_t tries = 0; tries < kMostTries; ++tries) {
      std::vector<Solid> solids = swollen(solids_, steps, tries, 0);
      Joiner joiner(context_);
      const std::vector<Solid> joined = joiner.join_all(solids, 0, solids.size());
      if (joiner.is_failed) {
        give_up(joiner.reason, joiner.failed_at);
        continue;
      }
      report_ = {};
      if (joiner.joins == 0) return {};
      if (!others_.empty()) {
        const auto obstacle = find_obstacle(swollen(solids_, steps, tries, 0),
                                            swollen(others_, steps, tries, uint32_t(solids_.size())), context_);
        if (obstacle) give_up(obstacle->first, obstacle->second);
        if (obstacle) return {};
      }
      report_.left_components = int64_t(others_.size());
      return JoinedSolids{soup_of(joined, others_, mesh_, steps, soup_), joiner.cut_faces};
    }
    return {};
  }

 private:
  std::vector<Solid> swollen(std::vector<Solid> solids, const Steps& steps, uint32_t tries, uint32_t first) const {
    for (uint32_t i = 0; i < solids.size(); ++i)
      swell(solids[i], mesh_.position, steps, uint64_t(tries) << 32 | (first + i));
    return solids;
  }

  const TriangleSoup& soup_;
  JoinReport& report_;
  const Context& context_;
  const RepairMesh mesh_;
  std::vector<Solid> solids_, others_;  ///< what bounds solid, and what does not
};

}  // namespace

std::optional<JoinedSolids> join_solids(const TriangleSoup& soup, JoinReport& report, const Context& context) {
  return run_with_threads(context, [&] { return Attempt(soup, report, context).run(); });
}

}  // namespace isoshell::repair
