// See join_solids.h.
#include "repair/join_solids.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "core/half_edge_list.h"
#include "core/watched.h"
#include "core/world_vector.h"
#include "isoshell/buffer.h"
#include "repair/cut_solids.h"
#include "repair/drop_slivers.h"
#include "repair/plane_triangulation.h"
#include "repair/repair_mesh.h"
#include "repair/winding.h"
#include "voxel/random.h"
#include "voxel/union_find.h"

namespace isoshell::repair {
namespace {

constexpr int kMostTries = 8;
constexpr double kMarginSteps = 1 << 12;
constexpr uint64_t kSwellSteps = 192, kSwellMoreSteps = 256;  // at least, and less than that more
constexpr int kJitterSteps = 3;
constexpr double kRoundedSteps = 6;  // triangles lower than that come from rounding where edges were cut
constexpr double kSliverSteps = 2048;

struct Box {
  WorldPoint lo, hi;
  bool meets(const Box& o) const {
    return lo.x <= o.hi.x && o.lo.x <= hi.x && lo.y <= o.hi.y && o.lo.y <= hi.y && lo.z <= o.hi.z && o.lo.z <= hi.z;
  }
};
Box box_of(const Solid& s) {
  Box box{s.point[s.face[0][0]], s.point[s.face[0][0]]};
  for (const auto& f : s.face)
    for (const uint32_t v : f) {
      const WorldPoint& p = s.point[v];
      box.lo = {std::min(box.lo.x, p.x), std::min(box.lo.y, p.y), std::min(box.lo.z, p.z)};
      box.hi = {std::max(box.hi.x, p.x), std::max(box.hi.y, p.y), std::max(box.hi.z, p.z)};
    }
  return box;
}

/// From the corners of faces to whole steps from 0 on.
struct Steps {
  WorldPoint least;
  double a_step;

  explicit Steps(const RepairMesh& mesh) {
    least = mesh.position[mesh.face[0][0]];
    WorldPoint most = least;
    for (const Corners& f : mesh.face)
      for (const uint32_t v : f) {
        const WorldPoint& p = mesh.position[v];
        least = {std::min(least.x, p.x), std::min(least.y, p.y), std::min(least.z, p.z)};
        most = {std::max(most.x, p.x), std::max(most.y, p.y), std::max(most.z, p.z)};
      }
    const WorldPoint size = most - least;
    a_step = std::max({size.x, size.y, size.z}) / (double(kLargestInPlane) - 2 * kMarginSteps);
  }
  WorldPoint from(const WorldPoint& p) const {
    const WorldPoint s = (1 / a_step) * (p - least);
    return {s.x + kMarginSteps, s.y + kMarginSteps, s.z + kMarginSteps};
  }
  WorldPoint to_world(const WorldPoint& s) const {
    return least + a_step * WorldPoint{s.x - kMarginSteps, s.y - kMarginSteps, s.z - kMarginSteps};
  }
};

/// Components of faces that share edges with one other face, each on points of its own.
std::vector<Solid> components_of(const RepairMesh& mesh) {
  Buffer<uint32_t> parent(mesh.face_count());
  for (int64_t f = 0; f < parent.size(); ++f) parent[f] = uint32_t(f);
  for (uint32_t h = 0; h < 3 * mesh.face_count(); ++h)
    if (mesh.faces_at(mesh.edge_of(h)) == 2) join(parent.view(), h / 3, mesh.twin(h) / 3);
  std::vector<uint32_t> number(mesh.face.size(), kNoFace);
  std::vector<Solid> solids;
  std::vector<std::map<uint32_t, uint32_t>> copy;
  for (uint32_t f = 0; f < mesh.face.size(); ++f) {
    uint32_t& at = number[find_root(parent.view(), f)];
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

/// Whether each edge has two faces, which pass it in opposite directions.
bool is_closed(const std::vector<Corners>& faces) {
  std::vector<uint64_t> edges;
  for (const Corners& f : faces)
    for (size_t i = 0; i < 3; ++i) edges.push_back(uint64_t(f[i]) << 32 | f[(i + 1) % 3]);
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return false;
  return std::all_of(edges.begin(), edges.end(),
                     [&](uint64_t e) { return std::binary_search(edges.begin(), edges.end(), e << 32 | e >> 32); });
}

double six_volume(const std::vector<WorldPoint>& point, const std::vector<Corners>& faces) {
  double sum = 0;
  const WorldPoint& o = point[faces[0][0]];
  for (const Corners& f : faces) sum += dot(point[f[0]] - o, cross(point[f[1]] - o, point[f[2]] - o));
  return sum;
}

/// By what a point is moved so that planes with these normals, of length 1, all move outward by 1, as far as they can.
/// The sums are of n n and of n.
WorldPoint outward(const std::array<double, 6>& nn, const WorldPoint& n) {
  constexpr double kKeep = 1e-3;  // of those along which no plane looks
  const double xx = nn[0] + kKeep, yy = nn[1] + kKeep, zz = nn[2] + kKeep, xy = nn[3], yz = nn[4], zx = nn[5];
  const WorldPoint a{xx, xy, zx}, b{xy, yy, yz}, c{zx, yz, zz};
  const double volume = dot(a, cross(b, c));
  WorldPoint d = (1 / volume) * WorldPoint{dot(n, cross(b, c)), dot(a, cross(n, c)), dot(a, cross(b, n))};
  const double farthest = 4, far = length(d);
  return far > farthest ? (farthest / far) * d : d;
}

/// Points in steps, swollen, and each a little off, in another way in each try.
void swell(Solid& solid, const std::vector<WorldPoint>& position, const Steps& steps, uint64_t by, uint64_t seed) {
  std::vector<std::array<double, 6>> nn(solid.origin.size());
  std::vector<WorldPoint> n(solid.origin.size(), WorldPoint{0, 0, 0});
  for (const Corners& f : solid.face) {
    const WorldPoint &a = position[solid.origin[f[0]]], &b = position[solid.origin[f[1]]],
                     &c = position[solid.origin[f[2]]];
    const WorldPoint doubled = doubled_area(a, b, c);
    const double area = length(doubled);
    if (!(area > 0)) continue;
    const WorldPoint u = (1 / area) * doubled;
    for (const uint32_t v : f) {
      nn[v] = {nn[v][0] + u.x * u.x, nn[v][1] + u.y * u.y, nn[v][2] + u.z * u.z,
               nn[v][3] + u.x * u.y, nn[v][4] + u.y * u.z, nn[v][5] + u.z * u.x};
      n[v] = n[v] + u;
    }
  }
  solid.point.resize(solid.origin.size());
  for (size_t v = 0; v < solid.point.size(); ++v) {
    const uint64_t bits = random_bits(seed, v);
    const auto jitter = [&](int shift) {
      return double(int((bits >> shift) & 0xffff) % (2 * kJitterSteps + 1) - kJitterSteps);
    };
    const WorldPoint p = steps.from(position[solid.origin[v]]) + double(by) * outward(nn[v], n[v]);
    solid.point[v] = {std::floor(p.x + .5) + jitter(0), std::floor(p.y + .5) + jitter(16),
                      std::floor(p.z + .5) + jitter(32)};
  }
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
    Box box = box_of(solid);
    for (size_t i = 0; i < apart.size() && !is_failed;) {
      std::optional<Solid> both;
      if (box_of(apart[i]).meets(box)) both = join_two(apart[i], solid);
      if (!both) {
        ++i;
        continue;
      }
      solid = std::move(*both);
      box = box_of(solid);
      apart.erase(apart.begin() + int64_t(i));
    }
    apart.push_back(std::move(solid));
  }

  /// None where they lie apart, or one in the other.
  std::optional<Solid> join_two(const Solid& a, const Solid& b) {
    check_cancel(context_, "unite");
    std::optional<CutSolids> cut = cut_solids(a, b, context_);
    if (!cut) is_failed = true;
    if (!cut || cut->crossing.empty()) return {};
    Solid joined = outer_faces(std::move(*cut), a, b);
    is_failed |= joined.face.empty() || !is_closed(joined.face);
    ++joins;
    if (is_failed) return {};
    drop_slivers(joined.point, joined.face, joined.source, kRoundedSteps);
    return joined;
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
    const std::vector<ListedHalfEdge> sides = sorted_half_edges(cut.both.face);
    Buffer<uint32_t> parent(int64_t(cut.both.face.size()));
    for (int64_t f = 0; f < parent.size(); ++f) parent[f] = uint32_t(f);
    for (size_t i = 1; i < sides.size(); ++i) {
      const std::array<uint32_t, 2> edge{sides[i].smaller_end(), sides[i].larger_end()};
      if (sides[i].edge == sides[i - 1].edge && !std::binary_search(cut.crossing.begin(), cut.crossing.end(), edge))
        join(parent.view(), sides[i - 1].number / 3, sides[i].number / 3);
    }
    std::vector<uint32_t> part(cut.both.face.size());
    for (uint32_t f = 0; f < part.size(); ++f) part[f] = find_root(parent.view(), f);
    return part;
  }

  const Context& context_;
};

/// Caps come last, as they did.
TriangleSoup soup_of(const std::vector<Solid>& solids, const RepairMesh& mesh, const Steps& steps,
                     const TriangleSoup& from) {
  TriangleSoup soup;
  soup.faces_in_file = from.faces_in_file;
  soup.dirt = from.dirt;
  std::vector<Corners> caps;
  for (const Solid& solid : solids) {
    std::vector<WorldPoint> point;
    for (size_t v = 0; v < solid.point.size(); ++v)
      point.push_back(solid.origin[v] == kNoFace ? steps.to_world(solid.point[v]) : mesh.position[solid.origin[v]]);
    std::vector<Corners> face = solid.face;
    std::vector<uint32_t> source = solid.source;
    drop_slivers(point, face, source, kSliverSteps * steps.a_step);
    const uint32_t shift = uint32_t(soup.vertices.size());
    soup.vertices.insert(soup.vertices.end(), point.begin(), point.end());
    for (size_t f = 0; f < face.size(); ++f)
      (source[f] < from.first_cap ? soup.triangles : caps)
          .push_back({face[f][0] + shift, face[f][1] + shift, face[f][2] + shift});
  }
  if (!caps.empty()) soup.first_cap = uint32_t(soup.triangles.size());
  soup.triangles.insert(soup.triangles.end(), caps.begin(), caps.end());
  return soup;
}

std::optional<JoinedSolids> try_to_join(const TriangleSoup& soup, const Context& context) {
  const RepairMesh mesh(soup);
  if (mesh.face.empty()) return {};
  const std::vector<Solid> components = components_of(mesh);
  if (components.size() < 2) return {};
  for (const Solid& s : components) {
    std::vector<WorldPoint> point;
    for (const uint32_t v : s.origin) point.push_back(mesh.position[v]);
    if (!is_closed(s.face) || six_volume(point, s.face) <= 0) return {};
  }
  const Steps steps(mesh);
  for (int tries = 0; tries < kMostTries; ++tries) {
    std::vector<Solid> solids = components;
    for (uint32_t i = 0; i < solids.size(); ++i) {
      const uint64_t seed = uint64_t(tries) << 32 | i;
      swell(solids[i], mesh.position, steps, kSwellSteps + random_bits(seed, kNoFace) % kSwellMoreSteps, seed);
    }
    Joiner joiner(context);
    const std::vector<Solid> joined = joiner.join_all(solids, 0, solids.size());
    if (!joiner.is_failed && joiner.joins == 0) return {};
    if (!joiner.is_failed) return JoinedSolids{soup_of(joined, mesh, steps, soup), joiner.cut_faces};
  }
  return {};
}

}  // namespace

std::optional<JoinedSolids> join_solids(const TriangleSoup& soup, const Context& context) {
  return run_with_threads(context, [&] { return try_to_join(soup, context); });
}

}  // namespace isoshell::repair
