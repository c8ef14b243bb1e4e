// See new_points.h.
#include "repair/arrangement/new_points.h"

#include <algorithm>
#include <tuple>

#include "geometry/point_cells.h"
#include "geometry/world_vector.h"
#include "isoshell/advanced/buffer.h"

namespace isoshell::repair {
namespace {

auto order_of(const Contact& c) {
  return std::tuple(key_of(c.edge[0]), key_of(c.edge[1]), key_of({c.face, c.point}), key_of(c.pair));
}
bool is_same_place(const Contact& a, const Contact& b) {
  return a.edge == b.edge && a.face == b.face && a.point == b.point;
}

/// The corners of faces with new points, and these points themselves: nearest ones that stay.
class NearCorners {
 public:
  NearCorners(const LatticeFaces& faces, std::vector<uint32_t> numbers)
      : reach_(faces.weld_steps()),
        number_(std::move(numbers)),
        position_(positions(faces)),
        cells_(position_, reach_) {}

  /// Of those that `is_kept` takes the nearest to p within reach, the smallest number of several; kNoFace if none.
  template <class IsKept>
  uint32_t nearest(StepPoint at, IsKept is_kept) const {
    const WorldPoint p = as_world(at);
    uint32_t best = kNoFace;
    double best_sq = reach_ * reach_;
    cells_.for_each_in(widened(WorldBox{p, p}, reach_), [&](size_t i) {
      const double sq = distance_sq(p, position_[i]);
      if (sq > best_sq || (sq == best_sq && number_[i] >= best) || !is_kept(number_[i])) return;
      best = number_[i];
      best_sq = sq;
    });
    return best;
  }

 private:
  std::vector<WorldPoint> positions(const LatticeFaces& faces) const {
    std::vector<WorldPoint> found;
    for (const uint32_t v : number_) found.push_back(as_world(faces.point[v]));
    return found;
  }
  double reach_;
  std::vector<uint32_t> number_;
  std::vector<WorldPoint> position_;
  PointCells cells_;
};

}  // namespace

void number_new_points(LatticeFaces& faces, std::vector<Contact>& contacts) {
  std::sort(contacts.begin(), contacts.end(),
            [](const Contact& a, const Contact& b) { return order_of(a) < order_of(b); });
  const uint32_t first_new = uint32_t(faces.point.size());
  std::vector<uint32_t> near;
  const Contact* last = nullptr;
  std::vector<uint32_t> number(contacts.size(), kNoFace);
  for (size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (c.point != kNoFace) continue;
    if (!last || !is_same_place(*last, c)) {
      near.push_back(uint32_t(faces.point.size()));
      faces.point.push_back(c.at);
    }
    last = &c;
    number[i] = uint32_t(faces.point.size() - 1);
    for (const uint32_t f : c.pair) near.insert(near.end(), faces.face[f].begin(), faces.face[f].end());
  }
  if (near.empty()) return;
  std::sort(near.begin(), near.end());
  near.erase(std::unique(near.begin(), near.end()), near.end());
  const NearCorners corners(faces, near);
  std::vector<uint32_t> kept(faces.point.size() - first_new);
  for (uint32_t i = 0; i < kept.size(); ++i) {
    const uint32_t v = first_new + i;
    const uint32_t to = corners.nearest(
        faces.point[v], [&](uint32_t u) { return u < first_new || (u < v && kept[u - first_new] == u); });
    kept[i] = to == kNoFace ? v : to;
  }
  for (size_t i = 0; i < contacts.size(); ++i)
    if (number[i] != kNoFace) contacts[i].point = kept[number[i] - first_new];
}

namespace {

constexpr int kMostSpreads = 32;

/// Adds to an edge those of these points that it has not.
void add_missing(const ContactPoints& points, uint32_t face, const Ends& edge, View<const uint32_t> wanted,
                 std::vector<Contact>& to) {
  const std::vector<uint32_t> there = points.on_edge(edge[0], edge[1]);
  for (const uint32_t v : wanted) {
    if (v == edge[0] || v == edge[1] || std::find(there.begin(), there.end(), v) != there.end()) continue;
    Contact c;
    c.pair = {face, face};
    c.edge[0] = edge;
    c.point = v;
    to.push_back(c);
  }
}

}  // namespace

void spread_over_low_faces(const LatticeFaces& faces, std::vector<Contact>& contacts) {
  std::vector<Contact> low;
  for (const Contact& c : contacts)
    if (c.pair[0] == c.pair[1]) low.push_back(c);
  const auto view = [](const std::vector<uint32_t>& v, size_t begin, size_t end) {
    return View<const uint32_t>{v.data() + begin, int64_t(end - begin)};
  };
  for (int spread = 0; spread < kMostSpreads && !low.empty(); ++spread) {
    const ContactPoints points(faces, contacts);
    const size_t before = contacts.size();
    for (const Contact& c : low) {
      const Ends& e = c.edge[0];
      const uint32_t f = c.pair[0], apex = c.point;
      const std::vector<uint32_t> on_longest = points.on_edge(e[0], e[1]);
      const size_t at = size_t(std::find(on_longest.begin(), on_longest.end(), apex) - on_longest.begin());
      add_missing(points, f, ends_of(e[0], apex), view(on_longest, 0, at), contacts);
      add_missing(points, f, ends_of(apex, e[1]),
                  view(on_longest, std::min(at + 1, on_longest.size()), on_longest.size()), contacts);
      for (const uint32_t end : e) {
        const std::vector<uint32_t> on_side = points.on_edge(end, apex);
        add_missing(points, f, e, view(on_side, 0, on_side.size()), contacts);
      }
    }
    if (contacts.size() == before) return;
  }
}

ContactPoints::ContactPoints(const LatticeFaces& faces, const std::vector<Contact>& contacts) : faces_(faces) {
  const auto key = [](const OnEdge& o) { return std::tie(o.edge, o.along, o.point); };
  is_end_.assign(faces.point.size(), 0);
  for (const Contact& c : contacts)
    for (const Ends& e : c.edge) {
      if (e == kNoEnds || c.point == e[0] || c.point == e[1]) continue;
      const WorldPoint a = as_world(faces.point[e[0]]);
      on_edge_.push_back(
          {key_of(e), dot(as_world(faces.point[c.point]) - a, as_world(faces.point[e[1]]) - a), c.point});
      is_end_[e[0]] = is_end_[e[1]] = 1;
    }
  std::sort(on_edge_.begin(), on_edge_.end(), [&](const OnEdge& a, const OnEdge& b) { return key(a) < key(b); });
  const auto last = std::unique(on_edge_.begin(), on_edge_.end(), [](const OnEdge& a, const OnEdge& b) {
    return a.edge == b.edge && a.point == b.point;
  });
  on_edge_.erase(last, on_edge_.end());
  std::vector<std::array<uint32_t, 2>> inside;
  for (const Contact& c : contacts)
    if (c.face != kNoFace) inside.push_back({c.face, c.point});
  add_inside(std::move(inside));
}

std::vector<uint32_t> ContactPoints::on_edge(uint32_t from, uint32_t to) const {
  std::vector<uint32_t> found;
  if (!is_end_[from] || !is_end_[to]) return found;
  const uint64_t edge = key_of(ends_of(from, to));
  auto o =
      std::lower_bound(on_edge_.begin(), on_edge_.end(), edge, [](const OnEdge& a, uint64_t e) { return a.edge < e; });
  for (; o != on_edge_.end() && o->edge == edge; ++o) found.push_back(o->point);
  if (from > to) std::reverse(found.begin(), found.end());
  return found;
}

std::vector<uint32_t> ContactPoints::inside(uint32_t face) const {
  std::vector<uint32_t> found;
  auto i = std::lower_bound(inside_.begin(), inside_.end(), std::array<uint32_t, 2>{face, 0});
  for (; i != inside_.end() && (*i)[0] == face; ++i) found.push_back((*i)[1]);
  return found;
}

void ContactPoints::add_inside(std::vector<std::array<uint32_t, 2>> face_and_point) {
  std::sort(face_and_point.begin(), face_and_point.end());
  face_and_point.erase(std::unique(face_and_point.begin(), face_and_point.end()), face_and_point.end());
  uint32_t face = kNoFace;
  std::vector<uint32_t> border;  // of that face
  for (const auto& i : face_and_point) {
    if (i[0] != face) {
      face = i[0];
      const Corners& c = faces_.face[face];
      border.assign(c.begin(), c.end());
      for (size_t k = 0; k < 3; ++k) {
        const std::vector<uint32_t> there = on_edge(c[k], c[(k + 1) % 3]);
        border.insert(border.end(), there.begin(), there.end());
      }
    }
    if (std::find(border.begin(), border.end(), i[1]) == border.end()) inside_.push_back(i);
  }
  std::sort(inside_.begin(), inside_.end());
  inside_.erase(std::unique(inside_.begin(), inside_.end()), inside_.end());
}

std::vector<uint32_t> ContactPoints::touched_faces() const {
  std::vector<uint32_t> touched;
  for (uint32_t f = 0; f < faces_.face.size(); ++f) {
    const Corners& c = faces_.face[f];
    bool is_touched = std::binary_search(inside_.begin(), inside_.end(), std::array<uint32_t, 2>{f, 0},
                                         [](const auto& a, const auto& b) { return a[0] < b[0]; });
    for (size_t i = 0; i < 3 && !is_touched; ++i) is_touched = !on_edge(c[i], c[(i + 1) % 3]).empty();
    if (is_touched) touched.push_back(f);
  }
  return touched;
}

}  // namespace isoshell::repair
