// WallLinks (see wall_links.h).
#include "implicit/labels/wall_links.h"

#include <algorithm>

#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

/// A vertex at the other end of an edge, as one of its faces has it, and on which side of the volume that face lies.
struct EndOfFace {
  uint32_t vertex;
  uint8_t side;
};

/// Calls visit(link) for all edges at a vertex. `ends`: room for their ends, once a face.
template <class Visit>
void each_link(const LabelWalls& walls, View<const uint32_t> faces, uint32_t vertex, std::vector<EndOfFace>& ends,
               Visit visit) {
  ends.clear();
  for (const uint32_t f : faces) {
    const auto& face = walls.faces[f];
    const size_t corners = face[3] == kNone ? 3 : 4;
    const uint8_t side = walls.side_of(f);
    for (size_t i = 0; i < corners; ++i)
      if (face[i] == vertex) {
        ends.push_back({face[(i + 1) % corners], side});
        ends.push_back({face[(i + corners - 1) % corners], side});
      }
  }
  std::sort(ends.begin(), ends.end(), [](const EndOfFace& a, const EndOfFace& b) {
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.side < b.side;
  });
  for (size_t i = 0, j = 0; i < ends.size(); i = j) {
    while (j < ends.size() && ends[j].vertex == ends[i].vertex) ++j;
    visit(WallLink(ends[i].vertex, j - i != 2 || ends[i].side != ends[j - 1].side));
  }
}

Buckets<WallLink> find_links(const LabelWalls& walls, const Buckets<uint32_t>& faces_at) {
  const int64_t vertices = faces_at.count();
  Buckets<WallLink> out;
  out.first = Buffer<int64_t>(vertices + 1);
  out.first[vertices] = 0;
  const auto for_each_vertex = [&](auto step) {
    for_ranges(vertices, 1024, [&](int64_t begin, int64_t end) {
      std::vector<EndOfFace> ends;
      for (int64_t v = begin; v < end; ++v)
        step(v, [&](auto visit) { each_link(walls, faces_at.in(v), uint32_t(v), ends, visit); });
    });
  };
  for_each_vertex([&](int64_t v, auto each) {
    int64_t count = 0;
    each([&](WallLink) { ++count; });
    out.first[v] = count;
  });
  offsets_from_counts(out.first.view());
  out.items = Buffer<WallLink>(out.first[vertices]);
  for_each_vertex([&](int64_t v, auto each) {
    int64_t at = out.first[v];
    each([&](WallLink link) { out.items[at++] = link; });
  });
  return out;
}

}  // namespace

Buckets<uint32_t> faces_at_vertices(const LabelWalls& walls) {
  return sort_into_buckets<uint32_t>(int64_t(walls.rest_quarters.size()), int64_t(walls.faces.size()),
                                     [&](int64_t f, auto put) {
                                       for (const uint32_t v : walls.faces[size_t(f)])
                                         if (v != kNone) put(int64_t(v), uint32_t(f));
                                     });
}

WallLinks::WallLinks(const LabelWalls& walls, const Buckets<uint32_t>& faces_at)
    : links_(find_links(walls, faces_at)), kind_(walls.rest_quarters.size(), Kind::in_wall) {
  for_each_index(size_t(0), kind_.size(), [&](size_t v) {
    const View<const WallLink> links = at(v);
    const auto along = std::count_if(links.begin(), links.end(), [](WallLink l) { return l.is_along_curve(); });
    if (along > 0) kind_[v] = along == 2 ? Kind::on_curve : Kind::corner;
  });
  std::vector<uint8_t> is_beside(kind_.size(), 0);
  for_each_index(size_t(0), kind_.size(), [&](size_t v) {
    for (int64_t i = links_.first[int64_t(v)]; i < links_.first[int64_t(v) + 1]; ++i) {
      if (!is_on_curve(links_.items[i].vertex())) continue;
      links_.items[i].mark_to_curve();
      is_beside[v] = !is_on_curve(v);
    }
  });
  for_each_index(size_t(0), kind_.size(), [&](size_t v) {
    if (is_beside[v]) kind_[v] = Kind::beside_curve;
  });
}

bool WallLinks::is_along_curve(uint32_t a, uint32_t b) const {
  for (const WallLink link : at(a))
    if (link.vertex() == b) return link.is_along_curve();
  return false;
}

bool WallLinks::is_strip_between(uint32_t a, uint32_t b, const std::array<uint32_t, 4>& face) const {
  if (a == b || !is_on_curve(a) || !is_on_curve(b) || is_along_curve(a, b)) return false;
  for (const uint32_t v : face)
    if (v != kNone && kind_[v] == Kind::on_curve && is_along_curve(a, v) && is_along_curve(v, b)) return false;
  return true;
}

}  // namespace isoshell
