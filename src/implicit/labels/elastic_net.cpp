// ElasticNet (see elastic_net.h).
#include "implicit/labels/elastic_net.h"

#include "core/watched.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

/// Sheets of one voxel stay so thick that edges longer than that follow both of their sides.
constexpr int32_t kReach = kOneVoxelFine / 2, kThinReach = kOneVoxelFine * 3 / 8;

int32_t rest_of(int32_t halves) { return halves * (kOneVoxelFine / 2); }

/// Calls visit(neighbour) for those that a vertex follows, ascending. `ends`: room for its neighbours, once a face.
template <class Visit>
void each_followed(const LabelWalls& walls, View<const uint32_t> faces, uint32_t vertex, std::vector<uint32_t>& ends,
                   Visit visit) {
  ends.clear();
  for (const uint32_t f : faces) {
    const auto& face = walls.faces[f];
    const size_t corners = face[3] == kNone ? 3 : 4;
    for (size_t i = 0; i < corners; ++i)
      if (face[i] == vertex) {
        ends.push_back(face[(i + 1) % corners]);
        ends.push_back(face[(i + corners - 1) % corners]);
      }
  }
  std::sort(ends.begin(), ends.end());
  const auto each_run = [&](auto see) {
    for (size_t i = 0, j = 0; i < ends.size(); i = j) {
      while (j < ends.size() && ends[j] == ends[i]) ++j;
      see(ends[i], j - i);
    }
  };
  bool is_on_curve = false;
  each_run([&](uint32_t, size_t count) { is_on_curve |= count != 2; });
  each_run([&](uint32_t w, size_t count) {
    if (!is_on_curve || count != 2) visit(w);
  });
}

/// Which vertices each one follows.
Buckets<uint32_t> followed_by(const LabelWalls& walls, const Buckets<uint32_t>& faces_at) {
  const int64_t vertices = faces_at.count();
  Buckets<uint32_t> out;
  out.first = Buffer<int64_t>(vertices + 1);
  out.first[vertices] = 0;
  const auto for_each_vertex = [&](auto step) {
    for_ranges(vertices, 1024, [&](int64_t begin, int64_t end) {
      std::vector<uint32_t> ends;
      for (int64_t v = begin; v < end; ++v)
        step(v, [&](auto visit) { each_followed(walls, faces_at.in(v), uint32_t(v), ends, visit); });
    });
  };
  for_each_vertex([&](int64_t v, auto each) {
    int64_t count = 0;
    each([&](uint32_t) { ++count; });
    out.first[v] = count;
  });
  offsets_from_counts(out.first.view());
  out.items = Buffer<uint32_t>(out.first[vertices]);
  for_each_vertex([&](int64_t v, auto each) {
    int64_t at = out.first[v];
    each([&](uint32_t w) { out.items[at++] = w; });
  });
  return out;
}

}  // namespace

Buckets<uint32_t> faces_at_vertices(const LabelWalls& walls) {
  return sort_into_buckets<uint32_t>(int64_t(walls.rest_halves.size()), int64_t(walls.faces.size()),
                                     [&](int64_t f, auto put) {
                                       for (const uint32_t v : walls.faces[size_t(f)])
                                         if (v != kNone) put(int64_t(v), uint32_t(f));
                                     });
}

ElasticNet::ElasticNet(const LabelWalls& walls, const Buckets<uint32_t>& faces_at)
    : walls_(walls), followed_(followed_by(walls, faces_at)), at_(walls.rest_halves.size()), next_(at_.size()) {
  for_each_index(size_t(0), at_.size(), [&](size_t v) {
    const Voxel& h = walls.rest_halves[v];
    at_[v] = {rest_of(h.x), rest_of(h.y), rest_of(h.z)};
  });
}

FinePoint ElasticNet::pulled(const std::vector<FinePoint>& field, size_t vertex, double share) const {
  const View<const uint32_t> of = followed_.in(int64_t(vertex));
  const FinePoint& p = field[vertex];
  if (of.size == 0) return p;
  int32_t x = 0, y = 0, z = 0;  // of neighbours within a few voxels
  for (const uint32_t w : of) {
    x += field[w].x - p.x;
    y += field[w].y - p.y;
    z += field[w].z - p.z;
  }
  const double part = share / double(of.size);
  const auto moved = [&](int32_t at, int32_t sum) { return at + int32_t(std::floor(part * sum + 0.5)); };
  return {moved(p.x, x), moved(p.y, y), moved(p.z, z)};
}

FinePoint ElasticNet::within_reach(size_t vertex, const FinePoint& p) const {
  const int32_t reach = walls_.is_thin[vertex] ? kThinReach : kReach;
  const auto held = [&](int32_t at, int32_t halves) {
    return std::clamp(at, rest_of(halves) - reach, rest_of(halves) + reach);
  };
  const Voxel& h = walls_.rest_halves[vertex];
  return {held(p.x, h.x), held(p.y, h.y), held(p.z, h.z)};
}

void ElasticNet::step(double share) {
  for_each_index(size_t(0), at_.size(), [&](size_t v) { next_[v] = within_reach(v, pulled(at_, v, share)); });
  at_.swap(next_);
}

void ElasticNet::twice(int steps, double share, const Context& context) {
  std::vector<FinePoint> way(at_.size());
  for_each_index(size_t(0), at_.size(), [&](size_t v) {
    const Voxel& h = walls_.rest_halves[v];
    way[v] = {rest_of(h.x) - at_[v].x, rest_of(h.y) - at_[v].y, rest_of(h.z) - at_[v].z};
  });
  for (int step = 0; step < steps; ++step) {
    check_cancel(context, "read");
    for_each_index(size_t(0), way.size(), [&](size_t v) { next_[v] = pulled(way, v, share); });
    way.swap(next_);
  }
  for_each_index(size_t(0), at_.size(), [&](size_t v) {
    const FinePoint &p = at_[v], &by = way[v];
    at_[v] = within_reach(v, {p.x + by.x, p.y + by.y, p.z + by.z});
  });
}

std::vector<PointQ8> ElasticNet::rounded() const {
  constexpr int32_t kShare = kOneVoxelFine / kOneVoxelQ8;
  static_assert(kShare == 1 << 8);
  const auto nearest = [](int32_t fine) { return (fine + kShare / 2) >> 8; };
  std::vector<PointQ8> out(at_.size());
  for_each_index(size_t(0), out.size(), [&](size_t v) {
    out[v] = {nearest(at_[v].x), nearest(at_[v].y), nearest(at_[v].z)};
  });
  return out;
}

}  // namespace isoshell
