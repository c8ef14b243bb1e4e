// Normals of points: found from neighbours where the file has none, and turned to agree.
#include "implicit/points/point_normals.h"

#include <cmath>
#include <queue>

#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "implicit/points/plane_fit.h"

namespace isoshell {
namespace {

constexpr size_t kFitNeighbours = 16;    // of the plane that gives a normal
constexpr size_t kGraphNeighbours = 10;  // of the spanning tree
constexpr double kFlatPart = 0.05;       // of the volume of points that look straight away from their middle
constexpr size_t kSpacingNeighbour = 6;  // of random points on a plane the sixth is 1.4 mean spacings away
constexpr double kSpacingFactor = 0.7071067811865476;
constexpr double kAreaFactor = 0.5235987755982988;  // pi / 6: a disk of that radius holds six
constexpr double kLayerCell = 2;                    // spacings: side of a cell that is seen along a direction
constexpr double kLayerGap = 4;       // spacings without points between two layers; those of a slope follow one another
constexpr double kMostLayered = 0.1;  // of the cells of a scan from one side, at its steps; of a closed surface, most
constexpr size_t kTried = 20000;      // given normals, at most, that are held against planes of neighbours
// Mean cosine with those: .5 for any directions, .65 where noise is two spacings, else .8 and more.
constexpr double kLeastCosine = 0.55;
constexpr double kFlat = 0.02;  // part of the scatter of neighbours that is off their plane; a ball's sixteen have .003
constexpr double kLeastFlatCosine = 0.9;   // mean over flat planes
constexpr double kMostDisagreeing = 0.05;  // of all pairs of neighbours; beyond it normals are not trusted

/// Whether given normals stand on the planes of their neighbours, as far as those tell: on all planes better than any
/// directions would, on flat ones well. Thin walls and wires have no flat ones, whatever their normals.
bool fit_planes(const std::vector<WorldPoint>& position, const std::vector<WorldPoint>& normal, const PointTree& tree) {
  const size_t stride = (position.size() + kTried - 1) / kTried;
  std::vector<double> cosine((position.size() + stride - 1) / stride), off(cosine.size());
  for_each_index(size_t(0), cosine.size(), [&](size_t i) {
    std::vector<PointTree::Near> near;
    tree.nearest(position[i * stride], std::min(kFitNeighbours + 1, position.size()), near);
    const PlaneFit plane = fit_plane(position, near);
    cosine[i] = std::abs(dot(normalised(normal[i * stride]), plane.normal));
    off[i] = plane.off;
  });
  double sum = 0, flat_sum = 0, flat = 0;
  for (size_t i = 0; i < cosine.size(); ++i) {
    sum += cosine[i];
    if (off[i] < kFlat) flat_sum += cosine[i], ++flat;
  }
  return sum >= kLeastCosine * double(cosine.size()) && flat_sum >= kLeastFlatCosine * flat;
}

/// A pair of neighbours that the tree may join: flattest first.
struct Step {
  double bend;
  uint32_t to, from;
  bool operator<(const Step& b) const {  // for a queue that gives its largest
    return bend != b.bend ? bend > b.bend : to != b.to ? to > b.to : from > b.from;
  }
};

class Orientation {
 public:
  Orientation(OrientedPoints& points, const std::vector<uint32_t>& neighbours, size_t degree)
      : p_(points), neighbours_(neighbours), degree_(degree), part_(points.position.size(), 0) {}

  void run(bool given) {
    p_.turned = given && disagreeing() > kMostDisagreeing;
    if ((!given || p_.turned) && !turn_to_viewer()) turn_along_trees();
    point_outward();
  }

 private:
  uint32_t neighbour(uint32_t i, size_t k) const { return neighbours_[i * degree_ + k]; }

  /// Part of all pairs of neighbours whose normals disagree.
  double disagreeing() const {
    int64_t pairs = 0, against = 0;
    for (uint32_t i = 0; i < p_.position.size(); ++i)
      for (size_t k = 0; k < degree_; ++k) {
        const double along = dot(p_.normal[i], p_.normal[neighbour(i, k)]);
        pairs += along != 0;
        against += along < 0;
      }
    return pairs ? double(against) / double(pairs) : 1;
  }

  /// What was scanned from one direction has one height along it almost everywhere, and every normal faces it. Tries
  /// the axes and the direction that most normals have.
  bool turn_to_viewer() {
    double m[6] = {};
    for (size_t i = 0; i < p_.normal.size(); ++i) {
      const WorldPoint& n = p_.normal[i];
      const double a = -p_.area[i];
      m[0] += a * n.x * n.x, m[1] += a * n.x * n.y, m[2] += a * n.x * n.z;
      m[3] += a * n.y * n.y, m[4] += a * n.y * n.z, m[5] += a * n.z * n.z;
    }
    double least = kMostLayered;
    WorldPoint viewer{0, 0, 0};
    for (const WorldPoint& from : {WorldPoint{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, smallest_direction(m)}) {
      const double layered = layered_part(from);
      if (layered < least) least = layered, viewer = from;
    }
    if (!(least < kMostLayered)) return false;
    for (WorldPoint& n : p_.normal)
      if (dot(n, viewer) < 0) n = -1 * n;
    return true;
  }

  /// Of the cells that the points fill as seen along a direction, the part with points behind a gap behind others.
  double layered_part(const WorldPoint& along) const {
    const WorldPoint other = std::abs(along.x) < 0.7 ? WorldPoint{1, 0, 0} : WorldPoint{0, 1, 0};
    const WorldPoint u = normalised(cross(along, other)), v = cross(along, u);
    struct Seen {
      double u, v, height;
    };
    std::vector<Seen> seen;
    const double cell = kLayerCell * p_.spacing;
    for (const WorldPoint& p : p_.position)
      seen.push_back({std::floor(dot(p, u) / cell), std::floor(dot(p, v) / cell), dot(p, along)});
    std::sort(seen.begin(), seen.end(), [](const Seen& a, const Seen& b) {
      return a.u != b.u ? a.u < b.u : a.v != b.v ? a.v < b.v : a.height < b.height;
    });
    int64_t cells = 0, layered = 0;
    for (size_t i = 0, end; i < seen.size(); i = end, ++cells) {
      double gap = 0;
      for (end = i + 1; end < seen.size() && seen[end].u == seen[i].u && seen[end].v == seen[i].v; ++end)
        gap = std::max(gap, seen[end].height - seen[end - 1].height);
      layered += gap > kLayerGap * p_.spacing;
    }
    return double(layered) / double(cells);
  }

  void turn_along_trees() {
    uint32_t parts = 0;
    for (uint32_t start = 0; start < p_.position.size(); ++start) {
      if (part_[start]) continue;
      part_[start] = ++parts;
      std::priority_queue<Step> steps;
      add_steps(start, steps);
      while (!steps.empty()) {
        const Step step = steps.top();
        steps.pop();
        if (part_[step.to]) continue;
        part_[step.to] = parts;
        if (dot(p_.normal[step.to], p_.normal[step.from]) < 0) p_.normal[step.to] = -1 * p_.normal[step.to];
        add_steps(step.to, steps);
      }
    }
  }
  void add_steps(uint32_t from, std::priority_queue<Step>& steps) const {
    for (size_t k = 0; k < degree_; ++k) {
      const uint32_t to = neighbour(from, k);
      if (!part_[to]) steps.push({1 - std::abs(dot(p_.normal[from], p_.normal[to])), to, from});
    }
  }

  /// The volume that points of a part bound, closed by a cone to a middle.
  struct Cone {
    double volume = 0, most_volume = 0;  ///< most: of points that look straight away from the middle

    void add(double area, const WorldPoint& normal, const WorldPoint& away) {
      volume += area * dot(normal, away);
      most_volume += area * length(away);
    }
    bool is_flat() const { return std::abs(volume) < kFlatPart * most_volume; }
  };
  /// The mean of some points, each by its area.
  struct Middle {
    double area = 0;
    WorldPoint sum{0, 0, 0};

    void add(double a, const WorldPoint& p) { area += a, sum = sum + a * p; }
    WorldPoint place() const { return (area > 0 ? 1 / area : 0) * sum; }
  };

  /// Turns each part as a whole so that the volume it bounds, closed by a cone to its middle, is positive. A flat one
  /// bounds none: it looks away from the middle of all points, as a side of a box does, or up where they are flat, too.
  void point_outward() {
    uint32_t parts = 0;
    for (const uint32_t part : part_) parts = std::max(parts, part + 1);
    std::vector<Middle> middle(parts);
    Middle of_all;
    for (size_t i = 0; i < part_.size(); ++i)
      for (Middle* m : {&middle[part_[i]], &of_all}) m->add(p_.area[i], p_.position[i]);
    std::vector<Cone> own(parts), whole(parts);
    std::vector<double> up(parts, 0);
    for (size_t i = 0; i < part_.size(); ++i) {
      const uint32_t k = part_[i];
      own[k].add(p_.area[i], p_.normal[i], p_.position[i] - middle[k].place());
      whole[k].add(p_.area[i], p_.normal[i], p_.position[i] - of_all.place());
      up[k] += p_.area[i] * p_.normal[i].z;
    }
    for (size_t i = 0; i < part_.size(); ++i) {
      const uint32_t k = part_[i];
      const double outward = !own[k].is_flat() ? own[k].volume : !whole[k].is_flat() ? whole[k].volume : up[k];
      if (outward < 0) p_.normal[i] = -1 * p_.normal[i];
    }
  }

  OrientedPoints& p_;
  const std::vector<uint32_t>& neighbours_;
  const size_t degree_;
  std::vector<uint32_t> part_;  // of the spanning forest, from 1; all 0 where there is none
};

}  // namespace

OrientedPoints orient_points(std::vector<WorldPoint> position, std::vector<WorldPoint> normal, const PointTree& tree) {
  const size_t count = position.size();
  OrientedPoints points;
  points.ignored = !normal.empty() && !fit_planes(position, normal, tree);
  const bool given = !normal.empty() && !points.ignored;
  points.normal = given ? std::move(normal) : std::vector<WorldPoint>(count);
  points.area.resize(count);
  const size_t degree = std::min(kGraphNeighbours, count - 1);
  std::vector<uint32_t> neighbours(count * degree);
  std::vector<double> spacing(count);
  for_each_index(size_t(0), count, [&](size_t i) {
    std::vector<PointTree::Near> near;
    tree.nearest(position[i], std::min(kFitNeighbours + 1, count), near);
    points.normal[i] = given ? normalised(points.normal[i]) : fit_plane(position, near).normal;
    const double reach_sq = near[std::min(kSpacingNeighbour, count - 1)].first;
    spacing[i] = std::sqrt(reach_sq) * kSpacingFactor;
    points.area[i] = reach_sq * kAreaFactor;
    size_t k = 0;
    for (const auto& [d, n] : near)
      if (n != i && k < degree) neighbours[i * degree + k++] = n;
  });
  std::nth_element(spacing.begin(), spacing.begin() + int64_t(count / 2), spacing.end());
  points.spacing = spacing[count / 2];
  points.position = std::move(position);
  Orientation(points, neighbours, degree).run(given);
  points.as_given = given && !points.turned;
  return points;
}

}  // namespace isoshell
