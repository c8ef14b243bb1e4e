// fair_walls and cut_faces (see fair_walls.h).
#include "implicit/labels/fair_walls.h"

#include <algorithm>
#include <atomic>

#include "isoshell/advanced/voxel_set.h"
#include "measure/crossings.h"

namespace isoshell {
namespace {

constexpr int kSteps = 20;          ///< more make walls no smoother than they make regions smaller
constexpr int64_t kFirstParts = 4;  ///< of the first step: at a quarter of the way walls are parted and do not cross
constexpr int kHalvings = 4;
constexpr int kMostRounds = 24;

/// Which vertices each one follows.
Buckets<uint32_t> followed_by(const LabelWalls& walls) {
  const auto vertices = int64_t(walls.rest_halves.size());
  const auto list = [&](int64_t f, auto put) {
    const auto& face = walls.faces[size_t(f)];
    const size_t corners = face[3] == kNone ? 3 : 4;
    for (size_t i = 0; i < corners; ++i) {
      const uint32_t a = face[i], b = face[(i + 1) % corners];
      put(int64_t(a), b);
      put(int64_t(b), a);
    }
  };
  const Buckets<uint32_t> all = sort_into_buckets<uint32_t>(vertices, int64_t(walls.faces.size()), list);
  Buckets<uint32_t> out;
  out.first = Buffer<int64_t>(vertices + 1);
  out.first[vertices] = 0;
  // Calls visit(neighbour) for those that a vertex follows.
  const auto each_followed = [&](int64_t v, auto visit) {
    const View<const uint32_t> in = all.in(v);
    bool is_on_curve = false;
    const auto each_run = [&](auto see) {
      for (int64_t i = 0, j = 0; i < in.size; i = j) {
        while (j < in.size && in[j] == in[i]) ++j;
        see(in[i], j - i);
      }
    };
    each_run([&](uint32_t, int64_t faces) { is_on_curve |= faces != 2; });
    each_run([&](uint32_t w, int64_t faces) {
      if (!is_on_curve || faces != 2) visit(w);
    });
  };
  for_each_index(int64_t(0), vertices, [&](int64_t v) {
    int64_t count = 0;
    each_followed(v, [&](uint32_t) { ++count; });
    out.first[v] = count;
  });
  offsets_from_counts(out.first.view());
  out.items = Buffer<uint32_t>(out.first[vertices]);
  for_each_index(int64_t(0), vertices, [&](int64_t v) {
    int64_t at = out.first[v];
    each_followed(v, [&](uint32_t w) { out.items[at++] = w; });
  });
  return out;
}

constexpr int32_t kOne = 1 << 16;  ///< steps a voxel, until positions are rounded to 1/256 voxel
constexpr int32_t kReach = kOne / 2, kThinReach = kOne / 4;

/// In 1/65536 voxel.
struct FinePoint {
  int32_t x, y, z;
};

int32_t rest_of(int32_t halves) { return halves * (kOne / 2); }

/// One part in so many of the way to the mean, rounded down, within reach of the rest.
int32_t stepped(int32_t at, int64_t sum, int64_t count, int64_t parts, int32_t halves, int32_t reach) {
  const int64_t weighted = sum + (parts - 1) * int64_t(at) * count, of = parts * count;
  const int64_t down = weighted / of - (weighted % of < 0 ? 1 : 0);
  const int32_t rest = rest_of(halves);
  return int32_t(std::clamp<int64_t>(down, rest - reach, rest + reach));
}

class ElasticNet {
 public:
  explicit ElasticNet(const LabelWalls& walls)
      : walls_(walls), followed_(followed_by(walls)), at_(walls.rest_halves.size()), next_(at_.size()) {
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const Voxel& h = walls.rest_halves[v];
      at_[v] = {rest_of(h.x), rest_of(h.y), rest_of(h.z)};
    });
  }

  void step(int64_t parts) {
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      int64_t x = 0, y = 0, z = 0;
      const View<const uint32_t> of = followed_.in(int64_t(v));
      for (const uint32_t w : of) {
        x += at_[w].x;
        y += at_[w].y;
        z += at_[w].z;
      }
      const FinePoint& p = at_[v];
      const Voxel& h = walls_.rest_halves[v];
      const int32_t reach = walls_.is_thin[v] ? kThinReach : kReach;
      next_[v] = of.size == 0 ? p
                              : FinePoint{stepped(p.x, x, of.size, parts, h.x, reach),
                                          stepped(p.y, y, of.size, parts, h.y, reach),
                                          stepped(p.z, z, of.size, parts, h.z, reach)};
    });
    at_.swap(next_);
  }

  std::vector<PointQ8> rounded() const {
    constexpr int32_t kShare = kOne / kOneVoxelQ8;
    const auto nearest = [](int32_t steps) { return (steps + kShare / 2) >> 8; };
    static_assert(kShare == 1 << 8);
    std::vector<PointQ8> out(at_.size());
    for_each_index(size_t(0), out.size(), [&](size_t v) {
      out[v] = {nearest(at_[v].x), nearest(at_[v].y), nearest(at_[v].z)};
    });
    return out;
  }

 private:
  const LabelWalls& walls_;
  Buckets<uint32_t> followed_;
  std::vector<FinePoint> at_, next_;
};

/// Lets vertices go back, as far as that takes, to where no triangles intersect: half of the way, and at last all of
/// it.
void part_crossing(const LabelWalls& walls, const std::vector<PointQ8>& parted, std::vector<PointQ8>& position) {
  const std::atomic<bool> never{false};
  std::vector<uint8_t> rounds(position.size(), 0);
  for (int round = 0; round < kMostRounds; ++round) {
    const CutFaces cut = cut_faces(walls, position);
    const auto pairs = crossing_pairs({position.data(), int64_t(position.size())},
                                      {cut.triangles.data(), int64_t(cut.triangles.size())}, {}, never);
    if (pairs.empty()) return;
    std::vector<uint32_t> back;
    for (const auto& pair : pairs)
      for (const uint32_t t : pair)
        back.insert(back.end(), {cut.triangles[t].a, cut.triangles[t].b, cut.triangles[t].c});
    std::sort(back.begin(), back.end());
    back.erase(std::unique(back.begin(), back.end()), back.end());
    for (const uint32_t v : back) {
      const bool is_last = ++rounds[v] > kHalvings;
      const auto between = [&](int32_t at, int32_t to) { return is_last ? to : to + (at - to) / 2; };
      const PointQ8 &at = position[v], &to = parted[v];
      position[v] = {between(at.x, to.x), between(at.y, to.y), between(at.z, to.z)};
    }
  }
  position = parted;
}

int64_t distance_sq(const PointQ8& a, const PointQ8& b) {
  const int64_t x = a.x - b.x, y = a.y - b.y, z = a.z - b.z;
  return x * x + y * y + z * z;
}

}  // namespace

std::vector<PointQ8> fair_walls(const LabelWalls& walls) {
  ElasticNet net(walls);
  net.step(kFirstParts);
  const std::vector<PointQ8> parted = net.rounded();
  for (int step = 1; step < kSteps; ++step) net.step(2);
  std::vector<PointQ8> position = net.rounded();
  part_crossing(walls, parted, position);
  return position;
}

CutFaces cut_faces(const LabelWalls& walls, const std::vector<PointQ8>& position) {
  CutFaces cut;
  cut.triangles.reserve(2 * walls.faces.size());
  cut.face.reserve(2 * walls.faces.size());
  for (uint32_t f = 0; f < walls.faces.size(); ++f) {
    const auto& [a, b, c, d] = walls.faces[f];
    if (d == kNone) {
      cut.triangles.push_back({a, b, c});
      cut.face.push_back(f);
      continue;
    }
    if (distance_sq(position[a], position[c]) <= distance_sq(position[b], position[d])) {
      cut.triangles.push_back({a, b, c});
      cut.triangles.push_back({a, c, d});
    } else {
      cut.triangles.push_back({a, b, d});
      cut.triangles.push_back({b, c, d});
    }
    cut.face.insert(cut.face.end(), {f, f});
  }
  return cut;
}

}  // namespace isoshell
