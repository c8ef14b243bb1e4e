// See shared_lines.h.
#include "repair/arrangement/shared_lines.h"

#include <algorithm>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

struct PairPoint {
  std::array<uint32_t, 2> pair;
  uint32_t point;

  bool operator<(const PairPoint& o) const { return pair != o.pair ? pair < o.pair : point < o.point; }
  bool operator==(const PairPoint& o) const { return pair == o.pair && point == o.point; }
};

class LineFinder {
 public:
  LineFinder(const LatticeFaces& faces, ContactPoints& points) : faces_(faces), points_(points) {}

  /// `common`: the points of both, ascending.
  void add_pair(const std::array<uint32_t, 2>& pair, const std::vector<uint32_t>& common) {
    for (size_t s = 0; s < 2; ++s)
      for (size_t i = 0; i < 3; ++i) add_edge(pair[s], i, pair[1 - s], common);
    const std::vector<uint32_t> line = as_line(common);
    for (const uint32_t f : pair) add_chain(f, line);
  }

  std::vector<FaceLine> take() {
    points_.add_inside(std::move(inside_));
    std::sort(lines_.begin(), lines_.end());
    lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
    return std::move(lines_);
  }

 private:
  /// What lies in the other between the first and the last common point of an edge.
  void add_edge(uint32_t f, size_t i, uint32_t other, const std::vector<uint32_t>& common) {
    std::vector<uint32_t> chain = side_of(f, i);
    const auto is_common = [&](uint32_t v) { return std::binary_search(common.begin(), common.end(), v); };
    const auto first = std::find_if(chain.begin(), chain.end(), is_common);
    const auto last = std::find_if(chain.rbegin(), chain.rend(), is_common).base();
    if (first == chain.end() || last - first < 2) return;
    add_chain(other, {first, last});
  }
  std::vector<uint32_t> side_of(uint32_t f, size_t i) const {
    const Corners& c = faces_.face[f];
    std::vector<uint32_t> chain = points_.on_edge(c[i], c[(i + 1) % 3]);
    chain.insert(chain.begin(), c[i]);
    chain.push_back(c[(i + 1) % 3]);
    return chain;
  }

  void add_chain(uint32_t f, const std::vector<uint32_t>& chain) {
    std::array<std::vector<uint32_t>, 3> sides;
    for (size_t i = 0; i < 3; ++i) {
      sides[i] = side_of(f, i);
      std::sort(sides[i].begin(), sides[i].end());
    }
    const auto are_on_side = [&](uint32_t u, uint32_t v) {
      return std::any_of(sides.begin(), sides.end(), [&](const std::vector<uint32_t>& side) {
        return std::binary_search(side.begin(), side.end(), u) && std::binary_search(side.begin(), side.end(), v);
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
