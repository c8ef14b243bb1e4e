// See shared_lines.h.
#include "repair/arrangement/shared_lines.h"

#include <algorithm>
#include <unordered_map>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

struct PairPoint {
  std::array<uint32_t, 2> pair;
  uint32_t point;

  bool operator<(const PairPoint& o) const {
    return key_of(pair) != key_of(o.pair) ? key_of(pair) < key_of(o.pair) : point < o.point;
  }
  bool operator==(const PairPoint& o) const { return pair == o.pair && point == o.point; }
};

class LineFinder {
 public:
  LineFinder(const LatticeFaces& faces, ContactPoints& points) : faces_(faces), points_(points) {}

  /// `common`: the points of both, ascending.
  void add_pair(const std::array<uint32_t, 2>& pair, const std::vector<uint32_t>& common) {
    const std::array<const Sides*, 2> sides = {&sides_of(pair[0]), &sides_of(pair[1])};
    for (size_t s = 0; s < 2; ++s)
      for (const std::vector<uint32_t>& side : *sides[s]) add_edge(side, pair[1 - s], *sides[1 - s], common);
    const std::vector<uint32_t> line = as_line(common);
    for (size_t s = 0; s < 2; ++s) add_chain(pair[s], *sides[s], line);
  }

  std::vector<FaceLine> take() {
    points_.add_inside(std::move(inside_));
    std::sort(lines_.begin(), lines_.end());
    lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
    return std::move(lines_);
  }

 private:
  /// The points of a face's edges, from end to end.
  using Sides = std::array<std::vector<uint32_t>, 3>;

  const Sides& sides_of(uint32_t f) {
    const auto [found, is_new] = sides_.try_emplace(f);
    if (!is_new) return found->second;
    const Corners& c = faces_.face[f];
    for (size_t i = 0; i < 3; ++i) {
      std::vector<uint32_t>& side = found->second[i];
      side = points_.on_edge(c[i], c[(i + 1) % 3]);
      side.insert(side.begin(), c[i]);
      side.push_back(c[(i + 1) % 3]);
    }
    return found->second;
  }

  /// What lies in the other between the first and the last common point of an edge.
  void add_edge(const std::vector<uint32_t>& side, uint32_t other, const Sides& of_other,
                const std::vector<uint32_t>& common) {
    const auto is_common = [&](uint32_t v) { return std::binary_search(common.begin(), common.end(), v); };
    const auto first = std::find_if(side.begin(), side.end(), is_common);
    const auto last = std::find_if(side.rbegin(), side.rend(), is_common).base();
    if (first == side.end() || last - first < 2) return;
    add_chain(other, of_other, {first, last});
  }

  void add_chain(uint32_t f, const Sides& sides, const std::vector<uint32_t>& chain) {
    const auto are_on_side = [&](uint32_t u, uint32_t v) {
      return std::any_of(sides.begin(), sides.end(), [&](const std::vector<uint32_t>& side) {
        return std::find(side.begin(), side.end(), u) != side.end() &&
               std::find(side.begin(), side.end(), v) != side.end();
      });
    };
    if (chain.size() < 2 || are_on_side(chain.front(), chain.back())) return;
    for (size_t k = 0; k + 1 < chain.size(); ++k)
      if (!are_on_side(chain[k], chain[k + 1])) lines_.push_back({f, ends_of(chain[k], chain[k + 1])});
    for (const uint32_t v : chain) inside_.push_back({f, v});
  }

  /// From end to end, if they lie on a line.
  std::vector<uint32_t> as_line(const std::vector<uint32_t>& common) const {
    if (common.size() < 2) return {};
    const auto at = [&](uint32_t v) { return as_world(faces_.point[v]); };
    const auto farthest = [&](uint32_t from) {
      uint32_t far = from;
      for (const uint32_t v : common)
        if (distance_sq(at(from), at(v)) > distance_sq(at(from), at(far))) far = v;
      return far;
    };
    const uint32_t end = farthest(common.front()), other = farthest(end);
    const WorldPoint a = at(end), along = at(other) - a;
    std::vector<std::pair<double, uint32_t>> line;
    for (const uint32_t v : common) {
      const WorldPoint off = cross(along, at(v) - a);
      if (length_sq(off) > faces_.weld_steps() * faces_.weld_steps() * length_sq(along)) return {};
      line.push_back({dot(along, at(v) - a), v});
    }
    std::sort(line.begin(), line.end());
    std::vector<uint32_t> points;
    for (const auto& p : line) points.push_back(p.second);
    return points;
  }

  const LatticeFaces& faces_;
  ContactPoints& points_;
  std::unordered_map<uint32_t, Sides> sides_;  ///< of the faces that were asked for
  std::vector<FaceLine> lines_;
  std::vector<std::array<uint32_t, 2>> inside_;
};

}  // namespace

std::vector<FaceLine> shared_lines(const LatticeFaces& faces, const std::vector<Contact>& contacts,
                                   ContactPoints& points) {
  std::vector<PairPoint> all;
  for (const Contact& c : contacts) {
    if (c.pair[0] == c.pair[1]) continue;
    all.push_back({c.pair, c.point});
    for (const uint32_t v : faces.face[c.pair[0]])
      if (has_corner(faces.face[c.pair[1]], v)) all.push_back({c.pair, v});
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  LineFinder finder(faces, points);
  for (auto begin = all.begin(); begin != all.end();) {
    const auto end = std::find_if(begin, all.end(), [&](const PairPoint& p) { return p.pair != begin->pair; });
    std::vector<uint32_t> common;
    for (auto p = begin; p != end; ++p) common.push_back(p->point);
    finder.add_pair(begin->pair, common);
    begin = end;
  }
  return finder.take();
}

}  // namespace isoshell::repair
