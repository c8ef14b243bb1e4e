// See cut_face.h.
#include "repair/arrangement/cut_face.h"

#include <algorithm>
#include <cmath>

#include "repair/holes/plane_triangulation.h"
#include "voxel/exact_int.h"
#include "voxel/random.h"

namespace isoshell::repair {
namespace {

/// Along the largest component of the normal; the first of those that are nearly as large, so that faces on each other
/// are seen alike.
int axis_of(const Vec128& n) {
  const double x = std::abs(double(n.x)), y = std::abs(double(n.y)), z = std::abs(double(n.z));
  const double least = .9 * std::max({x, y, z});
  return x >= least ? 0 : y >= least ? 1 : 2;
}

/// Moved by a little that depends on the point alone: no four are on a circle then, but by chance.
PlanePoint seen(const std::vector<StepPoint>& point, uint32_t v, int axis, int by_steps) {
  const StepPoint& p = point[v];
  const uint64_t bits = random_bits(0, v);
  const auto jitter = [&](int shift) { return int64_t((bits >> shift) & 0xffff) % (2 * by_steps + 1) - by_steps; };
  const int64_t x = p.x + jitter(0), y = p.y + jitter(16), z = p.z + jitter(32);
  return axis == 0 ? PlanePoint{y, z} : axis == 1 ? PlanePoint{z, x} : PlanePoint{x, y};
}

class Cut {
 public:
  Cut(const std::vector<StepPoint>& point, const FaceCut& cut) : point_(point), cut_(cut) {
    for (size_t i = 0; i < 3; ++i) {
      loop_.push_back(cut.corner[i]);
      loop_.insert(loop_.end(), cut.border[i].begin(), cut.border[i].end());
    }
    used_ = loop_;
    std::sort(used_.begin(), used_.end());
    is_simple_ = std::adjacent_find(used_.begin(), used_.end()) == used_.end();
    used_.insert(used_.end(), cut.inside.begin(), cut.inside.end());
    std::sort(used_.begin(), used_.end());
    used_.erase(std::unique(used_.begin(), used_.end()), used_.end());
  }

  std::vector<Corners> triangles() {
    if (is_simple_ && triangulate()) return std::move(made_);
    made_.clear();
    if (!is_simple_)
      fill_loops();
    else if (loop_.size() > 3)
      halve(cut_.corner, cut_.border);
    else
      split_at(cut_.inside.front());
    return std::move(made_);
  }

 private:
  uint32_t place_of(uint32_t v) const {
    return uint32_t(std::lower_bound(used_.begin(), used_.end(), v) - used_.begin());
  }

  bool triangulate() {
    const StepPoint &a = point_[cut_.corner[0]], &b = point_[cut_.corner[1]], &c = point_[cut_.corner[2]];
    const Vec128 n = cross(difference(b, a), difference(c, a));
    const int axis = axis_of(n);
    const bool is_turned = (axis == 0 ? n.x : axis == 1 ? n.y : n.z) < 0;
    std::vector<PlanePoint> plane;
    for (const uint32_t v : used_) {
      plane.push_back(seen(point_, v, axis, cut_.jitter_steps));
      if (is_turned) std::swap(plane.back().x, plane.back().y);
    }
    std::vector<Ends> border, lines;
    for (size_t i = 0; i < loop_.size(); ++i)
      border.push_back({place_of(loop_[i]), place_of(loop_[(i + 1) % loop_.size()])});
    for (const Ends& l : cut_.lines) lines.push_back({place_of(l[0]), place_of(l[1])});
    const auto found = triangulate_plane(plane, border, lines);
    if (!found) return false;
    std::vector<uint8_t> is_there(used_.size(), 0);
    for (const Corners& t : *found)
      for (const uint32_t v : t) is_there[v] = 1;
    if (std::count(is_there.begin(), is_there.end(), 1) != int64_t(is_there.size())) return false;
    made_ = *found;
    const bool is_made = turn_flat() && has_border(border);
    for (Corners& t : made_) t = {used_[t[0]], used_[t[1]], used_[t[2]]};
    return is_made;
  }

  /// Whether the triangles made have this border. Points of edges may turn a low face over, or pass one another.
  bool has_border(const std::vector<Ends>& border) const {
    std::vector<Ends> edges, turned;  // the same where each edge is passed both ways
    for (const Corners& t : made_)
      for (size_t i = 0; i < 3; ++i) edges.push_back({t[i], t[(i + 1) % 3]});
    for (const Ends& e : border) edges.push_back({e[1], e[0]});
    for (const Ends& e : edges) turned.push_back({e[1], e[0]});
    std::sort(edges.begin(), edges.end());
    std::sort(turned.begin(), turned.end());
    return edges == turned;
  }

  /// Points of an edge are a little off it, so that three of them may be a triangle. Its longest edge is flipped: the
  /// next face would bring it back otherwise.
  bool turn_flat() {
    for (size_t side = 0; side < 3; ++side) {
      std::vector<uint32_t> rank(used_.size(), kNoFace);  // along the edge
      uint32_t last = 0;
      rank[place_of(cut_.corner[side])] = last++;
      for (const uint32_t v : cut_.border[side]) rank[place_of(v)] = last++;
      rank[place_of(cut_.corner[(side + 1) % 3])] = last;
      const auto is_flat = [&](const Corners& t) {
        return rank[t[0]] != kNoFace && rank[t[1]] != kNoFace && rank[t[2]] != kNoFace;
      };
      size_t flips = 0;
      for (auto t = made_.begin(); last > 1 && t != made_.end();) {
        if (!is_flat(*t)) {
          ++t;
          continue;
        }
        if (++flips > 8 * made_.size() || !flip_longest(*t, rank)) return false;
        t = made_.begin();
      }
    }
    return true;
  }
  bool flip_longest(Corners& flat, const std::vector<uint32_t>& rank) {
    Corners t = flat;
    std::sort(t.begin(), t.end(), [&](uint32_t a, uint32_t b) { return rank[a] < rank[b]; });
    for (Corners& other : made_) {
      if (&other == &flat || !has_corner(other, t[0]) || !has_corner(other, t[2])) continue;
      flat = other;
      std::replace(flat.begin(), flat.end(), t[0], t[1]);
      std::replace(other.begin(), other.end(), t[2], t[1]);
      return true;
    }
    return false;
  }

  /// Without looking: at a point of an edge and the corner across, and again. Points inside wait.
  void halve(const Corners& corner, const std::array<std::vector<uint32_t>, 3>& border) {
    for (size_t i = 0; i < 3; ++i) {
      if (border[i].empty()) continue;
      const size_t middle = border[i].size() / 2, j = (i + 1) % 3, k = (i + 2) % 3;
      const auto at = border[i].begin() + std::ptrdiff_t(middle);
      halve({corner[i], *at, corner[k]}, {std::vector<uint32_t>(border[i].begin(), at), {}, border[k]});
      halve({*at, corner[j], corner[k]}, {std::vector<uint32_t>(at + 1, border[i].end()), border[j], {}});
      return;
    }
    made_.push_back(corner);
  }
  /// A border that comes back to a point, as where the face is low, is several: what it goes there and back bounds
  /// nothing.
  void fill_loops() {
    std::vector<uint32_t> way;
    for (const uint32_t v : loop_) {
      const auto before = std::find(way.begin(), way.end(), v);
      if (before == way.end()) {
        way.push_back(v);
        continue;
      }
      fan({before, way.end()});
      way.erase(before + 1, way.end());
    }
    fan(way);
  }
  void fan(const std::vector<uint32_t>& loop) {
    for (size_t i = 1; i + 1 < loop.size(); ++i) made_.push_back({loop[0], loop[i], loop[i + 1]});
  }
  void split_at(uint32_t v) {
    for (size_t i = 0; i < 3; ++i) made_.push_back({cut_.corner[i], cut_.corner[(i + 1) % 3], v});
  }

  const std::vector<StepPoint>& point_;
  const FaceCut& cut_;
  std::vector<uint32_t> loop_, used_;  ///< around the face; all points, ascending
  bool is_simple_ = true;
  std::vector<Corners> made_;
};

}  // namespace

std::vector<Corners> cut_face(const std::vector<StepPoint>& point, const FaceCut& cut) {
  return Cut(point, cut).triangles();
}

}  // namespace isoshell::repair
