// ElasticNet (see elastic_net.h).
#include "implicit/labels/elastic_net.h"

#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"

namespace isoshell {
namespace {

using Kind = WallLinks::Kind;

/// Sheets of one voxel stay so thick that edges longer than that follow both of their sides. Where regions meet in
/// curves, the thin end of a wedge is no sheet. Voxels cut such ends off, and the curve itself may lie beyond them.
constexpr double kThinPart = 3. / 4, kCurvePart = 5. / 4;  ///< of the reach of other vertices
constexpr int32_t kMostOfThin = kOneVoxelFine * 3 / 8;
/// Curves on both sides of a face go no farther towards each other where they are a voxel apart: of the strip of wall
/// between them is left as much as triangles without small angles need.
constexpr int32_t kStripReach = kOneVoxelFine * 5 / 16;
constexpr int32_t kOffSides = kOneVoxelFine / 4;
constexpr double kSlopeShare = 0.25;  ///< of the slope, in a step: over what bends of regular walls grow by at most

int32_t rest_of(int32_t quarters) { return quarters * (kOneVoxelFine / 4); }

FinePoint all_along(int32_t part) { return FinePoint{part, part, part, 0}; }

/// In 1/32768, so that a share of a whole number is one again.
constexpr int kShareBits = 15;
int32_t whole_share(double share) { return int32_t(std::floor(share * (1 << kShareBits) + 0.5)); }
/// Rounded, of a share of at most 1. No product here is longer than 32 bits, which lanes of processors have.
FinePoint share_of(int32_t share, const FinePoint& p) {
  const FinePoint high = p >> kShareBits, low = p & ((1 << kShareBits) - 1);
  return share * high + ((share * low + (1 << (kShareBits - 1))) >> kShareBits);
}

}  // namespace

ElasticNet::ElasticNet(const LabelWalls& walls, const Buckets<uint32_t>& faces_at, double farthest_vox)
    : walls_(walls), links_(walls, faces_at), at_(walls.rest_quarters.size()), bend_(at_.size()), box_(at_.size()) {
  for_each_index(size_t(0), at_.size(), [&](size_t v) {
    at_[v] = rest(v);
    box_[v] = box_of(v, farthest_vox, faces_at);
  });
  tie_boxes();
}

FinePoint ElasticNet::rest(size_t vertex) const {
  const Voxel& q = walls_.rest_quarters[vertex];
  return FinePoint{rest_of(q.x), rest_of(q.y), rest_of(q.z), 0};
}

int32_t ElasticNet::reach_of(size_t vertex, double farthest_vox) const {
  const bool is_thin = walls_.is_thin[vertex];
  const double part = is_thin ? kThinPart : links_.is_on_curve(vertex) ? kCurvePart : 1;
  const auto reach = int32_t(part * farthest_vox * kOneVoxelFine);
  return is_thin ? std::min(reach, kMostOfThin) : reach;
}

ElasticNet::Box ElasticNet::box_of(size_t vertex, double farthest_vox, const Buckets<uint32_t>& faces_at) const {
  const bool is_on_curve = links_.is_on_curve(vertex);
  const int32_t reach = reach_of(vertex, farthest_vox);
  const FinePoint& rest = at_[vertex];
  Box box{rest - all_along(reach), rest + all_along(reach)};
  keep_on_sides(vertex, box);
  if (!is_on_curve) return box;
  for (const uint32_t f : faces_at.in(int64_t(vertex)))
    for (const uint32_t v : walls_.faces[f]) {
      if (v == kNone || !links_.is_strip_between(uint32_t(vertex), v, walls_.faces[f])) continue;
      const Voxel &own = walls_.rest_quarters[vertex], &other = walls_.rest_quarters[v];
      const int32_t way[3] = {other.x - own.x, other.y - own.y, other.z - own.z};
      for (int axis = 0; axis < 3; ++axis) {
        const int32_t reach_of_strip = std::min(reach, kStripReach) * std::abs(way[axis]) / 4;
        if (way[axis] < 0) box.low[axis] = std::max(box.low[axis], rest[axis] - reach_of_strip);
        if (way[axis] > 0) box.high[axis] = std::min(box.high[axis], rest[axis] + reach_of_strip);
      }
    }
  return box;
}

/// Where a volume ends what it shows goes on: it is cut there, and the cut is flat. Other vertices keep off
/// periodic sides, half of a voxel from which the next ones are.
void ElasticNet::keep_on_sides(size_t vertex, Box& box) const {
  const auto fine = [](const Voxel& quarters) {
    return FinePoint{rest_of(quarters.x), rest_of(quarters.y), rest_of(quarters.z), 0};
  };
  const FinePoint low = fine(walls_.low_quarters), high = fine(walls_.high_quarters), &at = at_[vertex];
  for (int axis = 0; axis < 3; ++axis) {
    const bool is_on_side = at[axis] == low[axis] || at[axis] == high[axis];
    if (is_on_side) {
      box.low[axis] = box.high[axis] = at[axis];
    } else if (low[axis] > 0) {  // it is periodic
      box.low[axis] = std::max(box.low[axis], low[axis] + kOffSides);
      box.high[axis] = std::min(box.high[axis], high[axis] - kOffSides);
    }
  }
}

/// Vertices that are one go where each of them may.
void ElasticNet::tie_boxes() {
  for (const std::vector<uint32_t>& group : walls_.tied) {
    Box ways = box_[group[0]];
    ways.low -= at_[group[0]], ways.high -= at_[group[0]];
    for (const uint32_t v : group)
      for (int axis = 0; axis < 3; ++axis) {
        ways.low[axis] = std::max(ways.low[axis], box_[v].low[axis] - at_[v][axis]);
        ways.high[axis] = std::min(ways.high[axis], box_[v].high[axis] - at_[v][axis]);
      }
    for (const uint32_t v : group) box_[v] = {at_[v] + ways.low, at_[v] + ways.high};
  }
}

/// They are as far from their rest as they are in the mean.
void ElasticNet::tie(std::vector<FinePoint>& position) const {
  for (const std::vector<uint32_t>& group : walls_.tied) {
    int64_t sum[3] = {0, 0, 0};
    for (const uint32_t v : group) {
      const FinePoint way = position[v] - rest(v);
      for (int axis = 0; axis < 3; ++axis) sum[axis] += way[axis];
    }
    const auto mean = [&](int64_t of) { return int32_t(of / int64_t(group.size())); };
    for (const uint32_t v : group) position[v] = rest(v) + FinePoint{mean(sum[0]), mean(sum[1]), mean(sum[2]), 0};
  }
}

/// This share of the way to the mean of those that a vertex follows.
FinePoint ElasticNet::mean_way(size_t vertex, const std::vector<FinePoint>& field, int32_t share) const {
  const FinePoint own = field[vertex];
  FinePoint sum{0, 0, 0, 0};  // of neighbours within a few voxels
  if (!links_.is_on_curve(vertex)) {
    for (const WallLink link : links_.at(vertex)) sum += field[link.vertex()] - own;
    return share_of(share / links_.followed(vertex), sum);
  }
  int32_t count = 0;
  for (const WallLink link : links_.at(vertex)) {
    if (!link.is_along_curve()) continue;
    sum += field[link.vertex()] - own;
    ++count;
  }
  return share_of(share / std::max(count, 1), sum);
}

FinePoint ElasticNet::within_reach(size_t vertex, const FinePoint& p) const {
  const FinePoint &low = box_[vertex].low, &high = box_[vertex].high;
  const FinePoint above = p < low ? low : p;
  return above > high ? high : above;
}

void ElasticNet::step(double share) {
  const int32_t whole = whole_share(share);
  for_each_index(size_t(0), at_.size(),
                 [&](size_t v) { bend_[v] = within_reach(v, at_[v] + mean_way(v, at_, whole)); });
  at_.swap(bend_);
  tie(at_);
}

/// What the bend at a vertex of a wall is for a curve beside it.
FinePoint ElasticNet::pull_of(uint32_t beside) const {
  const FinePoint& bend = bend_[beside];
  if (normal_.empty()) return bend;
  const FinePoint& n = normal_[beside];
  const auto product = [&](int axis) { return int64_t(n[axis]) * bend[axis]; };
  const int64_t along = (product(0) + product(1) + product(2) + (1 << (kShareBits - 1))) >> kShareBits;
  return share_of(int32_t(along), n);
}

/// Of the energy, where `bend_` has every bend over the number of neighbours that it is from.
FinePoint ElasticNet::slope_at(size_t vertex) const {
  const FinePoint own = bend_[vertex];
  const Kind kind = links_.kind(vertex);
  FinePoint slope{0, 0, 0, 0};
  if (kind == Kind::in_wall) {
    for (const WallLink link : links_.at(vertex)) slope += own - bend_[link.vertex()];
  } else if (kind == Kind::beside_curve) {
    for (const WallLink link : links_.at(vertex)) slope += link.is_to_curve() ? own : own - bend_[link.vertex()];
  } else {
    for (const WallLink link : links_.at(vertex)) {
      if (link.is_along_curve()) slope += own - bend_[link.vertex()];
      if (!link.is_to_curve()) slope -= pull_of(link.vertex());
    }
  }
  return slope;
}

void ElasticNet::unbend(int steps, double stiffness_of_curves, const std::function<void(int)>& begin_step) {
  std::vector<FinePoint> ahead = at_;
  const int32_t of_walls = -whole_share(1), of_curves = -whole_share(stiffness_of_curves),
                slope_share = whole_share(kSlopeShare);
  double pace = 1;
  for (int i = 0; i < steps; ++i) {
    begin_step(i);
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const int32_t share = (links_.is_on_curve(v) ? of_curves : of_walls) / links_.followed(v);
      bend_[v] = links_.kind(v) == Kind::corner ? FinePoint{0, 0, 0, 0} : mean_way(v, ahead, share);
    });
    const double next_pace = (1 + std::sqrt(1 + 4 * pace * pace)) / 2;
    const int32_t momentum = whole_share((pace - 1) / next_pace);
    pace = next_pace;
    for_each_index(size_t(0), at_.size(), [&](size_t v) {
      const FinePoint to = within_reach(v, ahead[v] - share_of(slope_share, slope_at(v)));
      ahead[v] = to + share_of(momentum, to - at_[v]);
      at_[v] = to;
    });
    tie(ahead);
    tie(at_);
  }
}

void ElasticNet::find_normals(const Buckets<uint32_t>& faces_at) {
  normal_.assign(at_.size(), FinePoint{0, 0, 0, 0});
  for_each_index(size_t(0), at_.size(), [&](size_t v) {
    if (links_.kind(v) != Kind::beside_curve) return;
    WorldPoint sum{0, 0, 0};
    for (const uint32_t f : faces_at.in(int64_t(v))) {  // of one sheet, which all look the same way
      const auto& [a, b, c, d] = walls_.faces[f];
      const auto way = [&](uint32_t from, uint32_t to) {
        const FinePoint by = at_[to] - at_[from];
        return WorldPoint{double(by[0]), double(by[1]), double(by[2])};
      };
      sum = sum + cross(way(a, c), way(b, d == kNone ? a : d));
    }
    const WorldPoint n = normalised(sum);
    normal_[v] = FinePoint{whole_share(n.x), whole_share(n.y), whole_share(n.z), 0};
  });
}

std::vector<PointQ8> ElasticNet::rounded() const {
  constexpr int32_t kShare = kOneVoxelFine / kOneVoxelQ8;
  static_assert(kShare == 1 << 8);
  const auto nearest = [](int32_t fine) { return (fine + kShare / 2) >> 8; };
  std::vector<PointQ8> out(at_.size());
  for_each_index(size_t(0), out.size(), [&](size_t v) {
    out[v] = {nearest(at_[v][0]), nearest(at_[v][1]), nearest(at_[v][2])};
  });
  return out;
}

}  // namespace isoshell
