#include "core/mend_holes.h"

#include <algorithm>
#include <cmath>
#include <unordered_map>
#include <unordered_set>

#include "core/cap_loop.h"
#include "voxel/union_find.h"

namespace isoshell::mending {
namespace {

using Loop = std::vector<uint32_t>;
constexpr double kSameTurn = 1e-6;  // of four for a whole turn

WorldPoint minus(const WorldPoint& p, const WorldPoint& q) { return {p.x - q.x, p.y - q.y, p.z - q.z}; }
double dot(const WorldPoint& p, const WorldPoint& q) { return p.x * q.x + p.y * q.y + p.z * q.z; }
WorldPoint cross(const WorldPoint& p, const WorldPoint& q) {
  return {p.y * q.z - p.z * q.y, p.z * q.x - p.x * q.z, p.x * q.y - p.y * q.x};
}

struct Box {
  WorldPoint lo, hi;
  explicit Box(const WorldPoint& p) : lo(p), hi(p) {}
  void add(const WorldPoint& p) {
    lo = {std::min(lo.x, p.x), std::min(lo.y, p.y), std::min(lo.z, p.z)};
    hi = {std::max(hi.x, p.x), std::max(hi.y, p.y), std::max(hi.z, p.z)};
  }
  double diagonal_sq() const { return dot(minus(hi, lo), minus(hi, lo)); }
};

/// Follows boundaries. Where several meet in a vertex, a hole goes on across the gap, to the boundary that comes next
/// around the vertex: its pieces of surface are seen in the plane across their mean normal.
class LoopFinder {
 public:
  explicit LoopFinder(const MendMesh& mesh) : mesh_(mesh), next_(size_t(mesh.face_count()) * 3, kNoFace) {
    for (uint32_t h = 0; h < next_.size(); ++h)
      if (is_boundary(h)) boundary_.push_back(h);
    link();
  }

  /// Closed loops in the order of their smallest half-edges, which come first.
  std::vector<Loop> closed_loops() const {
    std::vector<Loop> loops;
    std::vector<uint8_t> seen(next_.size(), 0);
    std::vector<uint8_t> has_previous(next_.size(), 0);
    for (uint32_t h : boundary_)
      if (next_[h] != kNoFace) has_previous[next_[h]] = 1;
    for (uint32_t h : boundary_)  // open chains first: what starts nowhere is no loop
      if (!has_previous[h])
        for (uint32_t g = h; g != kNoFace && !seen[g]; g = next_[g]) seen[g] = 1;
    for (uint32_t h : boundary_) {
      if (seen[h]) continue;
      loops.emplace_back();
      for (uint32_t g = h; !seen[g]; g = next_[g]) {
        seen[g] = 1;
        loops.back().push_back(g);
      }
    }
    return loops;
  }

  bool has_boundary() const { return !boundary_.empty(); }

 private:
  /// A piece of surface around a vertex between two boundary edges: `out` leaves the vertex, `in` ends there.
  struct Fan {
    uint32_t in, out;
    WorldPoint normal;
  };

  bool is_boundary(uint32_t h) const { return mesh_.is_live(h / 3) && mesh_.faces_at(mesh_.edge_of(h)) == 1; }

  void link() {
    std::vector<uint32_t> in = boundary_;
    std::sort(in.begin(), in.end(),
              [&](uint32_t g, uint32_t h) { return mesh_.to(g) != mesh_.to(h) ? mesh_.to(g) < mesh_.to(h) : g < h; });
    std::vector<Fan> fans;
    for (size_t i = 0, stop; i < in.size(); i = stop) {
      fans.clear();
      for (stop = i; stop < in.size() && mesh_.to(in[stop]) == mesh_.to(in[i]); ++stop) {
        const Fan fan = fan_from(in[stop]);
        if (fan.out != kNoFace) fans.push_back(fan);
      }
      if (fans.size() < 2 || !link_across_gaps(mesh_.to(in[i]), fans))
        for (const Fan& fan : fans) next_[fan.in] = fan.out;
    }
  }

  /// Walks around the end of a boundary half-edge through its faces. out: kNoFace when they do not agree or an edge of
  /// more faces is in the way.
  Fan fan_from(uint32_t in) const {
    Fan fan = {in, kNoFace, {0, 0, 0}};
    for (uint32_t h = in;;) {
      const WorldPoint n = mesh_.doubled_area(h / 3);
      fan.normal = {fan.normal.x + n.x, fan.normal.y + n.y, fan.normal.z + n.z};
      const uint32_t g = next_half_edge(h);
      const uint32_t faces = mesh_.faces_at(mesh_.edge_of(g));
      if (faces == 1) fan.out = g;
      if (faces != 2 || !mesh_.agrees(g)) return fan;
      h = mesh_.twin(g);
    }
  }

  /// False when the fans do not lie around the vertex one after the other.
  bool link_across_gaps(uint32_t vertex, const std::vector<Fan>& fans) {
    WorldPoint n = {0, 0, 0};
    for (const Fan& fan : fans) n = {n.x + fan.normal.x, n.y + fan.normal.y, n.z + fan.normal.z};
    const WorldPoint& at = mesh_.position[vertex];
    const WorldPoint u = cross(n, minus(mesh_.position[mesh_.to(fans[0].out)], at)), v = cross(n, u);
    if (dot(u, u) == 0) return false;
    struct Ray {
      double turn;
      bool is_in;
      uint32_t half_edge;
    };
    // u and v are perpendicular, v longer by |n|: only their directions count.
    const double u_length = std::sqrt(dot(u, u)), v_length = std::sqrt(dot(v, v));
    std::vector<Ray> rays;
    for (const Fan& fan : fans) {
      const WorldPoint in = minus(mesh_.position[mesh_.from(fan.in)], at),
                       out = minus(mesh_.position[mesh_.to(fan.out)], at);
      rays.push_back({turn_of(dot(in, u) / u_length, dot(in, v) / v_length), true, fan.in});
      rays.push_back({turn_of(dot(out, u) / u_length, dot(out, v) / v_length), false, fan.out});
    }
    std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
      return a.turn != b.turn ? a.turn < b.turn : a.half_edge < b.half_edge;
    });
    // Gaps without width, as T-junctions have them: a boundary that ends lies before the one that begins.
    for (size_t i = 0; i + 1 < rays.size(); ++i)
      if (!rays[i].is_in && rays[i + 1].is_in && rays[i + 1].turn - rays[i].turn < kSameTurn)
        std::swap(rays[i], rays[i + 1]);
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays[i].is_in == rays[(i + 1) % rays.size()].is_in) return false;
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays[i].is_in) next_[rays[i].half_edge] = rays[(i + 1) % rays.size()].half_edge;
    return true;
  }

  /// Grows with the angle of (x, y), 0 to 4.
  static double turn_of(double x, double y) {
    const double length = std::abs(x) + std::abs(y);
    if (length == 0) return 0;
    const double t = y / length;
    return x < 0 ? 2 - t : t < 0 ? 4 + t : t;
  }

  const MendMesh& mesh_;
  std::vector<uint32_t> boundary_, next_;
};

/// Boxes and areas of what faces connect by their corners.
class Components {
 public:
  explicit Components(const MendMesh& mesh) : parent_(int64_t(mesh.position.size())) {
    for (int64_t v = 0; v < parent_.size(); ++v) parent_[v] = uint32_t(v);
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
      if (!mesh.is_live(f)) continue;
      join(parent_.view(), mesh.face[f][0], mesh.face[f][1]);
      join(parent_.view(), mesh.face[f][0], mesh.face[f][2]);
    }
    for (uint32_t v = 0; v < mesh.position.size(); ++v)
      size_.try_emplace(find_root(parent_.view(), v), Size{Box(mesh.position[v])})
          .first->second.box.add(mesh.position[v]);
    for (uint32_t f = 0; f < mesh.face_count(); ++f)
      if (mesh.is_live(f)) size_.at(find_root(parent_.view(), mesh.face[f][0])).area += mesh.area(f);
  }
  struct Size {
    Box box;
    double area = 0;
  };
  const Size& of(uint32_t vertex) { return size_.at(find_root(parent_.view(), vertex)); }

 private:
  Buffer<uint32_t> parent_;
  std::unordered_map<uint32_t, Size> size_;
};

class Capper {
 public:
  Capper(const MendMesh& mesh, MendReport& report) : mesh_(mesh), report_(report) {}

  std::vector<Cap> run(bool cap_loops) {
    const LoopFinder finder(mesh_);
    if (!finder.has_boundary()) return std::move(caps_);
    Components components(mesh_);
    for (const Loop& loop : finder.closed_loops())
      if (!cap_loops || !cap(loop, largest_cap(loop, components.of(mesh_.from(loop[0]))))) ++report_.open_loops;
    return std::move(caps_);
  }

 private:
  /// The area of caps that make the loop a hole.
  double largest_cap(const Loop& loop, const Components::Size& component) const {
    Box box(mesh_.position[mesh_.from(loop[0])]);
    for (uint32_t h : loop) box.add(mesh_.position[mesh_.from(h)]);
    const bool is_short = box.diagonal_sq() <= kLargestHole * kLargestHole * component.box.diagonal_sq();
    return is_short ? component.area : kLargestCrack * component.area;
  }

  /// The loop in one piece; where that fails because it passes vertices more than once, each simple cycle of it.
  bool cap(const Loop& loop, double largest) {
    if (cap_in_one(loop, largest)) return true;
    const std::vector<Loop> cycles = simple_cycles(loop);
    bool all = cycles.size() > 1;
    if (all)
      for (const Loop& cycle : cycles) all &= cap_in_one(cycle, largest);
    return all;
  }

  std::vector<Loop> simple_cycles(const Loop& loop) const {
    std::vector<Loop> cycles;
    std::unordered_map<uint32_t, size_t> place;  // where the way so far leaves a vertex
    Loop way;
    for (uint32_t h : loop) {
      place[mesh_.from(h)] = way.size();
      way.push_back(h);
      const auto again = place.find(mesh_.to(h));
      if (again == place.end()) continue;
      const size_t begin = again->second;
      cycles.emplace_back(way.begin() + int64_t(begin), way.end());
      for (uint32_t g : cycles.back()) place.erase(mesh_.from(g));
      way.resize(begin);
    }
    return cycles;
  }

  bool cap_in_one(const Loop& loop, double largest) {
    // The cap passes the loop's edges the other way.
    const size_t n = loop.size();
    std::vector<uint32_t> vertex(n);
    std::vector<WorldPoint> corner(n);
    for (size_t i = 0; i < n; ++i) {
      vertex[i] = mesh_.from(loop[n - 1 - i]);
      corner[i] = mesh_.position[vertex[i]];
    }
    if (n == 3 && loop[0] / 3 == loop[1] / 3 && loop[1] / 3 == loop[2] / 3) return false;  // a face alone
    const std::vector<LoopTriangle> triangles =
        cap_loop(corner, [&](uint32_t i, uint32_t j) { return may_join(vertex[i], vertex[j]); });
    if (triangles.empty() || !joins_each_pair_once(vertex, triangles)) return false;
    const double area = area_of(corner, triangles);
    if (area > largest) return false;
    report_.cap_area_world += area;
    report_.widest_cap_world = std::max(report_.widest_cap_world, 4 * area / length_of(corner));
    add(loop, vertex, triangles);
    return true;
  }

  /// A loop that passes two vertices twice can have two chords between them.
  static bool joins_each_pair_once(const std::vector<uint32_t>& vertex, const std::vector<LoopTriangle>& triangles) {
    std::vector<uint64_t> keys;
    for (const LoopTriangle& t : triangles)
      for (size_t i = 0; i < 3; ++i) keys.push_back(key_of(vertex[t[i]], vertex[t[(i + 1) % 3]]));
    std::sort(keys.begin(), keys.end());
    for (size_t i = 2; i < keys.size(); ++i)
      if (keys[i] == keys[i - 2]) return false;
    return true;
  }

  bool may_join(uint32_t u, uint32_t v) const {
    return u != v && !mesh_.has_edge(u, v) && chords_.count(key_of(u, v)) == 0;
  }
  static uint64_t key_of(uint32_t u, uint32_t v) { return uint64_t(std::min(u, v)) << 32 | std::max(u, v); }

  void add(const Loop& loop, const std::vector<uint32_t>& vertex, const std::vector<LoopTriangle>& triangles) {
    Cap cap = {loop, {}};
    for (const LoopTriangle& t : triangles) {
      const Corners c = {vertex[t[0]], vertex[t[1]], vertex[t[2]]};
      cap.face.push_back(c);
      for (int i = 0; i < 3; ++i) chords_.insert(key_of(c[size_t(i)], c[size_t(i + 1) % 3]));
    }
    caps_.push_back(std::move(cap));
    ++report_.capped_loops;
    report_.cap_faces += int64_t(triangles.size());
  }

  static double area_of(const std::vector<WorldPoint>& corner, const std::vector<LoopTriangle>& triangles) {
    double area = 0;
    for (const LoopTriangle& t : triangles) {
      const WorldPoint n = cross(minus(corner[t[1]], corner[t[0]]), minus(corner[t[2]], corner[t[0]]));
      area += std::sqrt(dot(n, n)) / 2;
    }
    return area;
  }
  static double length_of(const std::vector<WorldPoint>& corner) {
    double length = 0;
    for (size_t i = 0; i < corner.size(); ++i) {
      const WorldPoint d = minus(corner[(i + 1) % corner.size()], corner[i]);
      length += std::sqrt(dot(d, d));
    }
    return length;
  }

  const MendMesh& mesh_;
  MendReport& report_;
  std::vector<Cap> caps_;
  std::unordered_set<uint64_t> chords_;  ///< edges of cap faces
};

}  // namespace

std::vector<Cap> cap_holes(const MendMesh& mesh, const MendOptions& options, MendReport& report) {
  return Capper(mesh, report).run(options.cap_loops);
}

}  // namespace isoshell::mending
