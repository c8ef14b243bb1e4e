#include "repair/holes/repair_holes.h"

#include <algorithm>
#include <unordered_map>
#include <unordered_set>

#include "core/index_sets.h"
#include "geometry/box.h"
#include "geometry/half_edges.h"
#include "geometry/world_vector.h"
#include "repair/holes/cap_loop.h"
#include "repair/holes/fill_plane.h"

namespace isoshell::repair {
namespace {

double diagonal_sq(const WorldBox& box) { return distance_sq(box.min, box.max); }

/// Boxes and areas of what faces connect by their corners.
class Components {
 public:
  explicit Components(const RepairMesh& mesh) : sets_(int64_t(mesh.position.size())) {
    for (uint32_t f = 0; f < mesh.face_count(); ++f) {
      if (!mesh.is_live(f)) continue;
      for (const uint32_t v : mesh.face[f]) sets_.unite(mesh.face[f][0], v);
    }
    for (uint32_t v = 0; v < mesh.position.size(); ++v) stretch(size_[sets_.root(v)].box, mesh.position[v]);
    for (uint32_t f = 0; f < mesh.face_count(); ++f)
      if (mesh.is_live(f)) size_.at(sets_.root(mesh.face[f][0])).area += mesh.area(f);
  }
  struct Size {
    WorldBox box = box_of_none();
    double area = 0;
  };
  const Size& of(uint32_t vertex) { return size_.at(sets_.root(vertex)); }

 private:
  IndexSets sets_;
  std::unordered_map<uint32_t, Size> size_;
};

class Capper {
 public:
  Capper(const RepairMesh& mesh, const Closing& closing, RepairReport& report)
      : mesh_(mesh), closing_(closing), report_(report) {}

  std::vector<Cap> run(Joins joins, const std::vector<Loop>& loops) {
    for (Cap& face : joins.faces) add_flat(std::move(face));
    for (Cap& tube : joins.tubes) add_tube(std::move(tube));
    if (loops.empty()) return std::move(caps_);
    Components components(mesh_);
    for (const Loop& loop : loops) {
      const Components::Size& component = components.of(mesh_.from(loop[0]));
      if (!cap(loop, largest_cap(loop, component)) && !fill(loop)) ++report_.open_loops;
    }
    return std::move(caps_);
  }

 private:
  /// The area of caps that make the loop a hole.
  double largest_cap(const Loop& loop, const Components::Size& component) const {
    if (!closing_.holes) return closing_.widest_gap_world > 0 ? component.area : 0;
    WorldBox box = box_of_none();
    for (uint32_t h : loop) stretch(box, mesh_.position[mesh_.from(h)]);
    const bool is_short = diagonal_sq(box) <= kLargestHole * kLargestHole * diagonal_sq(component.box);
    return is_short ? component.area : kLargestCrack * component.area;
  }

  /// Closes a rim that a piece of a flat face left. Its faces are not those of least area, as in a plane all are: some
  /// would be without area, between corners on a line.
  bool fill(const Loop& loop) {
    const std::optional<FlatRim> rim = closing_.holes ? flat_rim(mesh_, loop) : std::nullopt;
    if (!rim || !is_piece_of_face(mesh_, loop, *rim)) return false;
    Cap cap = {loop, fill_plane(mesh_, *rim, loop)};
    if (cap.face.empty() || !brings_new_chords(cap)) return false;
    add_flat(std::move(cap));
    return true;
  }
  bool brings_new_chords(const Cap& cap) const {
    return std::all_of(cap.face.begin(), cap.face.end(), [&](const Corners& c) {
      return chords_.count(edge_key(c[0], c[1])) + chords_.count(edge_key(c[1], c[2])) +
                 chords_.count(edge_key(c[2], c[0])) ==
             0;
    });
  }

  /// The loop in one piece; where that fails because it passes vertices more than once, each simple cycle of it.
  bool cap(const Loop& loop, double largest) {
    if (!(largest > 0)) return false;
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
    Cap cap = {loop, {}};
    for (const LoopTriangle& t : triangles) cap.face.push_back({vertex[t[0]], vertex[t[1]], vertex[t[2]]});
    const double area = area_of(cap);
    if (area > largest || is_too_wide(area, length_of(corner))) return false;
    count_cap(area, length_of(corner));
    add(std::move(cap));
    return true;
  }

  /// A loop that passes two vertices twice can have two chords between them.
  static bool joins_each_pair_once(const std::vector<uint32_t>& vertex, const std::vector<LoopTriangle>& triangles) {
    std::vector<uint64_t> keys;
    for (const LoopTriangle& t : triangles)
      for (size_t i = 0; i < 3; ++i) keys.push_back(edge_key(vertex[t[i]], vertex[t[(i + 1) % 3]]));
    std::sort(keys.begin(), keys.end());
    for (size_t i = 2; i < keys.size(); ++i)
      if (keys[i] == keys[i - 2]) return false;
    return true;
  }

  bool may_join(uint32_t u, uint32_t v) const {
    return u != v && !mesh_.has_edge(u, v) && chords_.count(edge_key(u, v)) == 0;
  }

  void add_tube(Cap tube) {
    report_.cap_area_world += area_of(tube);
    ++report_.tubes;
    add(std::move(tube));
  }
  void add_flat(Cap face) {
    double around = 0;
    for (const uint32_t h : face.loop) around += length(mesh_.position[mesh_.to(h)] - mesh_.position[mesh_.from(h)]);
    count_cap(area_of(face), around);
    add(std::move(face));
  }

  static double width_of(double area, double length) { return 4 * area / length; }
  bool is_too_wide(double area, double length) const {
    return !closing_.holes && width_of(area, length) > closing_.widest_gap_world;
  }
  void count_cap(double area, double length) {
    report_.cap_area_world += area;
    report_.widest_cap_world = std::max(report_.widest_cap_world, width_of(area, length));
  }

  void add(Cap cap) {
    for (const Corners& c : cap.face)
      for (size_t i = 0; i < 3; ++i) chords_.insert(edge_key(c[i], c[(i + 1) % 3]));
    report_.capped_loops += cap.loops;
    report_.cap_faces += int64_t(cap.face.size());
    caps_.push_back(std::move(cap));
  }

  double area_of(const Cap& cap) const {
    double area = 0;
    for (const Corners& c : cap.face)
      area += triangle_area(mesh_.position[c[0]], mesh_.position[c[1]], mesh_.position[c[2]]);
    return area;
  }
  static double length_of(const std::vector<WorldPoint>& corner) {
    double sum = 0;
    for (size_t i = 0; i < corner.size(); ++i) sum += length(corner[(i + 1) % corner.size()] - corner[i]);
    return sum;
  }

  const RepairMesh& mesh_;
  const Closing& closing_;
  RepairReport& report_;
  std::vector<Cap> caps_;
  std::unordered_set<uint64_t> chords_;  ///< edges of cap faces
};

}  // namespace

std::vector<Loop> loops_but(const RepairMesh& mesh, const std::vector<Cap>& caps, std::vector<Loop> loops) {
  std::vector<uint8_t> is_closed(size_t(mesh.face_count()) * 3, 0);
  for (const Cap& cap : caps)
    for (uint32_t h : cap.loop) is_closed[h] = 1;
  loops.erase(std::remove_if(loops.begin(), loops.end(), [&](const Loop& loop) { return is_closed[loop[0]] != 0; }),
              loops.end());
  return loops;
}

std::vector<Cap> cap_holes(const RepairMesh& mesh, Joins joins, const Closing& closing, RepairReport& report) {
  const std::vector<Loop> loops = loops_but(mesh, joins.tubes, loops_but(mesh, joins.faces, closed_loops(mesh)));
  return Capper(mesh, closing, report).run(std::move(joins), loops);
}

}  // namespace isoshell::repair
