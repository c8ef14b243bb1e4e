// See cut_solids.h.
#include "repair/solids/cut_solids.h"

#include <algorithm>
#include <cmath>
#include <tuple>

#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "repair/holes/plane_triangulation.h"
#include "repair/holes/repair_mesh.h"
#include "repair/solids/winding.h"
#include "voxel/exact_int.h"

namespace isoshell::repair {
namespace {

using EdgeEnds = std::array<uint32_t, 2>;

/// Six times the volume of a tetrahedron.
Int128 volume(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c, const WorldPoint& d) {
  const auto to = [&](const WorldPoint& p) {
    return Vec64{int64_t(p.x - a.x), int64_t(p.y - a.y), int64_t(p.z - a.z)};
  };
  const Vec64 u = to(b), w = to(d), n = cross(u, to(c));
  return Int128(n.x) * w.x + Int128(n.y) * w.y + Int128(n.z) * w.z;
}
int sign(Int128 v) { return v > 0 ? 1 : v < 0 ? -1 : 0; }

/// Where an edge passes through a face.
struct Pass {
  EdgeEnds edge;  ///< smaller end first
  uint32_t face;
  double along;  ///< from the smaller end, of the edge's length

  std::tuple<EdgeEnds, uint32_t> key() const { return {edge, face}; }
};
/// Two faces that pass through each other, and the ends of the line where they do.
struct Meeting {
  std::array<uint32_t, 2> face;
  std::array<Pass, 2> end;
};
struct Meetings {
  std::vector<Meeting> found;
  bool is_generic = true;  ///< no point in a face, and no edges that meet
};

class Cutter {
 public:
  Cutter(const Solid& a, const Solid& b, WorldPoint& failed_at) : failed_at_(failed_at) {
    cut_.both = a;
    Solid& both = cut_.both;
    const uint32_t shift = uint32_t(a.point.size());
    both.point.insert(both.point.end(), b.point.begin(), b.point.end());
    both.origin.insert(both.origin.end(), b.origin.begin(), b.origin.end());
    both.source.insert(both.source.end(), b.source.begin(), b.source.end());
    for (const auto& f : b.face) both.face.push_back({f[0] + shift, f[1] + shift, f[2] + shift});
    cut_.faces_of_first = int64_t(a.face.size());
  }

  std::optional<CutSolids> cut(const Solid& b, const Context& context) {
    if (!find_meetings(b, context)) return {};
    if (meetings_.empty()) return std::move(cut_);
    place_points();
    if (!cut_faces()) return {};
    return std::move(cut_);
  }

 private:
  const WorldPoint& at(uint32_t v) const { return cut_.both.point[v]; }

  bool find_meetings(const Solid& b, const Context& context) {
    const RayColumns columns(b.point, b.face);
    const uint32_t shift = uint32_t(cut_.faces_of_first);
    std::vector<Meetings> found(shift);
    for_each_index(uint32_t(0), shift, [&](uint32_t f) {
      check_cancel(context, "unite");
      const WorldBox box = box_around(f);
      std::vector<uint32_t> near;
      columns.for_each_near(box, [&](uint32_t g) {
        if (boxes_meet(box_around(g + shift), box)) near.push_back(g + shift);
      });
      std::sort(near.begin(), near.end());
      near.erase(std::unique(near.begin(), near.end()), near.end());
      for (const uint32_t g : near) meet(f, g, found[f]);
    });
    for (uint32_t f = 0; f < shift; ++f) {
      const Meetings& m = found[f];
      if (!m.is_generic) return fail(f);
      meetings_.insert(meetings_.end(), m.found.begin(), m.found.end());
    }
    return true;
  }

  bool fail(uint32_t f) {
    failed_at_ = at(cut_.both.face[f][0]);
    return false;
  }

  WorldBox box_around(uint32_t f) const {
    const auto& [a, b, c] = cut_.both.face[f];
    return box_of(at(a), at(b), at(c));
  }

  void meet(uint32_t f, uint32_t g, Meetings& to) const {
    std::vector<Pass> passes;
    add_passes(f, g, passes, to.is_generic);
    add_passes(g, f, passes, to.is_generic);
    if (passes.empty()) return;
    if (passes.size() == 2)
      to.found.push_back({{f, g}, {passes[0], passes[1]}});
    else
      to.is_generic = false;
  }

  /// Of the edges of one face through another.
  void add_passes(uint32_t f, uint32_t through, std::vector<Pass>& passes, bool& is_generic) const {
    const auto& face = cut_.both.face[f];
    const auto& [a, b, c] = cut_.both.face[through];
    std::array<Int128, 3> height;
    for (size_t i = 0; i < 3; ++i) height[i] = volume(at(a), at(b), at(c), at(face[i]));
    for (size_t i = 0; i < 3; ++i) {
      const size_t j = (i + 1) % 3;
      if (sign(height[i]) * sign(height[j]) > 0) continue;
      const uint32_t u = std::min(face[i], face[j]), v = std::max(face[i], face[j]);
      std::array<int, 3> turn{sign(volume(at(u), at(v), at(a), at(b))), sign(volume(at(u), at(v), at(b), at(c))),
                              sign(volume(at(u), at(v), at(c), at(a)))};
      std::sort(turn.begin(), turn.end());
      if (turn[0] < 0 && turn[2] > 0) continue;
      if (turn[0] == 0 || turn[2] == 0 || height[i] == 0 || height[j] == 0) {
        is_generic = false;
        return;
      }
      const double from = double(face[i] == u ? height[i] : height[j]),
                   to = double(face[i] == u ? height[j] : height[i]);
      passes.push_back({{u, v}, through, from / (from - to)});
    }
  }

  /// Of all passes, each once, in the order of edges, then along them.
  void place_points() {
    for (const Meeting& m : meetings_) passes_.insert(passes_.end(), m.end.begin(), m.end.end());
    std::sort(passes_.begin(), passes_.end(), [](const Pass& a, const Pass& b) { return a.key() < b.key(); });
    passes_.erase(
        std::unique(passes_.begin(), passes_.end(), [](const Pass& a, const Pass& b) { return a.key() == b.key(); }),
        passes_.end());
    Solid& both = cut_.both;
    first_new_ = uint32_t(both.point.size());
    for (const Pass& p : passes_) {
      const WorldPoint from = at(p.edge[0]), to = at(p.edge[1]), on = from + p.along * (to - from);
      both.point.push_back({std::floor(on.x + .5), std::floor(on.y + .5), std::floor(on.z + .5)});
      both.origin.push_back(kNoFace);
    }
    weld_points();
    by_edge_.resize(passes_.size());
    for (uint32_t i = 0; i < by_edge_.size(); ++i) by_edge_[i] = i;
    std::sort(by_edge_.begin(), by_edge_.end(), [&](uint32_t a, uint32_t b) {
      const Pass &p = passes_[a], &q = passes_[b];
      return std::tie(p.edge, p.along, p.face) < std::tie(q.edge, q.along, q.face);
    });
  }
  /// Edges that meet in a sharp corner may pass through a face at one place, to rounding.
  void weld_points() {
    const auto position = [&](uint32_t i) {
      const WorldPoint& p = at(first_new_ + i);
      return std::tuple(p.x, p.y, p.z);
    };
    std::vector<uint32_t> order(passes_.size());
    for (uint32_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(),
              [&](uint32_t a, uint32_t b) { return std::tuple(position(a), a) < std::tuple(position(b), b); });
    welded_.resize(order.size());
    for (size_t i = 0; i < order.size(); ++i)
      welded_[order[i]] =
          i > 0 && position(order[i]) == position(order[i - 1]) ? welded_[order[i - 1]] : first_new_ + order[i];
  }
  uint32_t point_of(const Pass& p) const {
    const auto is_before = [](const Pass& a, const Pass& b) { return a.key() < b.key(); };
    return welded_[size_t(std::lower_bound(passes_.begin(), passes_.end(), p, is_before) - passes_.begin())];
  }

  /// New points on an edge, from one end to the other.
  std::vector<uint32_t> points_on(uint32_t from, uint32_t to) const {
    const EdgeEnds edge{std::min(from, to), std::max(from, to)};
    auto i = std::lower_bound(by_edge_.begin(), by_edge_.end(), edge,
                              [&](uint32_t p, const EdgeEnds& e) { return passes_[p].edge < e; });
    std::vector<uint32_t> found;
    for (; i != by_edge_.end() && passes_[*i].edge == edge; ++i) found.push_back(welded_[*i]);
    found.erase(std::unique(found.begin(), found.end()), found.end());
    if (from > to) std::reverse(found.begin(), found.end());
    return found;
  }

  bool cut_faces() {
    std::vector<std::pair<uint32_t, EdgeEnds>> lines;  // by face
    for (const Meeting& m : meetings_) {
      const uint32_t a = point_of(m.end[0]), b = point_of(m.end[1]);
      if (a == b) continue;
      const EdgeEnds line{std::min(a, b), std::max(a, b)};
      for (const uint32_t f : m.face) lines.push_back({f, line});
      cut_.crossing.push_back(line);
    }
    std::sort(lines.begin(), lines.end());
    lines.erase(std::unique(lines.begin(), lines.end()), lines.end());
    std::sort(cut_.crossing.begin(), cut_.crossing.end());
    cut_.crossing.erase(std::unique(cut_.crossing.begin(), cut_.crossing.end()), cut_.crossing.end());
    std::vector<std::array<uint32_t, 3>> faces;
    std::vector<uint32_t> sources;
    int64_t of_first = 0;
    size_t begin = 0;
    for (uint32_t f = 0; f < cut_.both.face.size(); ++f) {
      std::vector<EdgeEnds> own;
      for (; begin < lines.size() && lines[begin].first == f; ++begin) own.push_back(lines[begin].second);
      if (!cut_face(f, own, faces)) return false;
      sources.resize(faces.size(), cut_.both.source[f]);
      if (f + 1 == uint32_t(cut_.faces_of_first)) of_first = int64_t(faces.size());
    }
    cut_.both.face = std::move(faces);
    cut_.both.source = std::move(sources);
    cut_.faces_of_first = of_first;
    return true;
  }

  bool cut_face(uint32_t f, std::vector<EdgeEnds>& lines, std::vector<std::array<uint32_t, 3>>& faces) {
    const auto& corner = cut_.both.face[f];
    const bool is_whole = lines.empty() && points_on(corner[0], corner[1]).empty() &&
                          points_on(corner[1], corner[2]).empty() && points_on(corner[2], corner[0]).empty();
    if (is_whole) {
      faces.push_back(corner);
      return true;
    }
    ++cut_.cut_faces;
    std::vector<uint32_t> points;
    for (const EdgeEnds& l : lines) points.insert(points.end(), l.begin(), l.end());
    for (size_t i = 0; i < 3; ++i) {
      uint32_t from = corner[i];
      std::vector<uint32_t> border = points_on(corner[i], corner[(i + 1) % 3]);
      border.push_back(corner[(i + 1) % 3]);
      for (const uint32_t to : border) {
        lines.push_back({from, to});
        points.push_back(from = to);
      }
    }
    std::sort(points.begin(), points.end());
    points.erase(std::unique(points.begin(), points.end()), points.end());
    for (EdgeEnds& l : lines)
      for (uint32_t& v : l) v = uint32_t(std::lower_bound(points.begin(), points.end(), v) - points.begin());
    const auto triangles = triangulate_plane(seen_from_outside(corner, points), lines);
    if (!triangles) return fail(f);
    for (const auto& t : *triangles) faces.push_back({points[t[0]], points[t[1]], points[t[2]]});
    return true;
  }

  /// In the plane of two axes in which the face is largest.
  std::vector<PlanePoint> seen_from_outside(const std::array<uint32_t, 3>& corner,
                                            const std::vector<uint32_t>& points) const {
    const WorldPoint n = doubled_area(at(corner[0]), at(corner[1]), at(corner[2]));
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    std::vector<PlanePoint> seen;
    for (const uint32_t v : points) {
      const WorldPoint& p = at(v);
      const int axis = x >= y && x >= z ? 0 : y >= z ? 1 : 2;
      PlanePoint q = axis == 0   ? PlanePoint{int64_t(p.y), int64_t(p.z)}
                     : axis == 1 ? PlanePoint{int64_t(p.z), int64_t(p.x)}
                                 : PlanePoint{int64_t(p.x), int64_t(p.y)};
      if ((axis == 0 ? n.x : axis == 1 ? n.y : n.z) < 0) std::swap(q.x, q.y);
      seen.push_back(q);
    }
    return seen;
  }

  CutSolids cut_;
  WorldPoint& failed_at_;
  std::vector<Meeting> meetings_;
  std::vector<Pass> passes_;                ///< by edge, then by face
  std::vector<uint32_t> by_edge_, welded_;  ///< passes by edge, then along it; per pass its point
  uint32_t first_new_ = 0;
};

}  // namespace

std::optional<CutSolids> cut_solids(const Solid& a, const Solid& b, WorldPoint& failed_at, const Context& context) {
  return Cutter(a, b, failed_at).cut(b, context);
}

}  // namespace isoshell::repair
