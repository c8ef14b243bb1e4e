#include "features/curves/corners.h"

#include <algorithm>

#include "geometry/world_vector.h"

namespace isoshell {
namespace {

constexpr double kChord = .7;          // of h
constexpr double kTurn = .2928932188;  // 1 - cos 45 degrees
constexpr double kSudden = .5;         // of the turn, that half the chord must see: about .7 of its angle
constexpr double kLeastChord = .25;    // of h, where a chain ends before
constexpr double kMostSmoothed = 2;    // of h: longer edges are no noise
constexpr int kSmoothing = 4;          // rounds
constexpr double kLongestTooth = 4;    // of h: the sides of longer ones are curves
constexpr double kEvenTeeth = .1;      // part of the squared bend of a tip that the tips beside it have at least

/// Positions along a chain; a ring goes on behind its last.
class Polyline {
 public:
  Polyline(const FeatureMesh& mesh, const EdgeChain& chain) : is_ring_(chain.is_ring) {
    for (const uint32_t v : chain.vertex) points_.push_back(mesh.vertices[v] - mesh.vertices[chain.vertex[0]]);
  }

  /// Whether a vertex and the two on either side of it turn to and fro, with edges up to this length: a tooth of a saw,
  /// as the rims of scans and of deleted triangles are.
  std::vector<uint8_t> find_teeth(double longest_world) const {
    std::vector<uint8_t> is_tooth(points_.size(), 0);
    const auto last = int64_t(points_.size()) - 1;
    const int64_t margin = is_ring_ ? 0 : 3;
    for (int64_t i = margin; last >= 5 && i + margin <= last; ++i) {
      bool is_saw = true;
      for (int64_t k = i - 2; k < i + 2 && is_saw; ++k) {
        const WorldPoint a = bend(k), b = bend(k + 1);
        const double aa = length_sq(a), bb = length_sq(b);
        is_saw = dot(a, b) < 0 && aa > kEvenTeeth * bb && bb > kEvenTeeth * aa &&
                 length(at(points_, k + 1) - at(points_, k)) <= longest_world;
      }
      is_tooth[size_t(i)] = is_saw;
    }
    return is_tooth;
  }

  /// Takes zigzags away, which alternate from vertex to vertex, and leaves what turns evenly: a vertex makes a quarter
  /// of the step by which its second difference differs from its neighbours'.
  void smooth(double longest_world) {
    for (int round = 0; round < kSmoothing; ++round) {
      const std::vector<WorldPoint> old = points_;
      const auto bend = [&](int64_t i) { return .5 * (at(old, i - 1) + at(old, i + 1)) - at(old, i); };
      for (int64_t i = 0; i < int64_t(points_.size()); ++i) {
        if (!is_ring_ && (i < 1 || i + 1 >= int64_t(points_.size()))) continue;
        if (length(at(old, i + 1) - at(old, i)) > longest_world || length(at(old, i - 1) - at(old, i)) > longest_world)
          continue;
        const WorldPoint around = .5 * (inner_bend(bend, i - 1) + inner_bend(bend, i + 1));
        points_[size_t(i)] = points_[size_t(i)] + .25 * (bend(i) - around);
      }
    }
  }

  /// Sums that mean positions come from.
  void integrate() {
    along_ = {0};
    integral_ = {{0, 0, 0}};
    for (size_t i = 0; i + 1 < points_.size(); ++i) {
      const double step = length(points_[i + 1] - points_[i]);
      along_.push_back(along_.back() + step);
      integral_.push_back(integral_.back() + (step / 2) * (points_[i] + points_[i + 1]));
    }
  }

  bool is_ring() const { return is_ring_; }
  size_t size() const { return points_.size(); }
  double along(size_t i) const { return along_[i]; }
  double length_world() const { return along_.back(); }

  /// From the mean position of the first half of a piece to that of its second half.
  WorldPoint direction(double begin, double end) const {
    const double middle = (begin + end) / 2;
    return mean(middle, end) - mean(begin, middle);
  }

 private:
  const WorldPoint& at(const std::vector<WorldPoint>& p, int64_t i) const {
    const int64_t last = int64_t(p.size()) - 1;  // of a ring the same as the first
    return p[size_t(is_ring_ ? (i + last) % last : i)];
  }

  WorldPoint bend(int64_t i) const { return .5 * (at(points_, i - 1) + at(points_, i + 1)) - at(points_, i); }

  template <class Bend>
  WorldPoint inner_bend(const Bend& bend, int64_t i) const {
    return is_ring_ || (i > 0 && i + 1 < int64_t(points_.size())) ? bend(i) : WorldPoint{0, 0, 0};
  }

  WorldPoint mean(double begin, double end) const { return (1 / (end - begin)) * (integral(end) - integral(begin)); }

  WorldPoint integral(double to) const {
    if (to < 0) return integral(to + length_world()) - integral_.back();
    if (to > length_world()) return integral(to - length_world()) + integral_.back();
    const size_t i =
        std::min(size_t(std::upper_bound(along_.begin(), along_.end(), to) - along_.begin()), size() - 1) - 1;
    const double step = along_[i + 1] - along_[i], t = to - along_[i];
    const WorldPoint part = step > 0 ? (t / step) * (points_[i + 1] - points_[i]) : WorldPoint{0, 0, 0};
    return integral_[i] + t * (points_[i] + .5 * part);
  }

  bool is_ring_;
  std::vector<WorldPoint> points_;
  std::vector<double> along_;
  std::vector<WorldPoint> integral_;
};

/// 1 - the cosine of the angle between what lies before a place and what lies behind it.
double turn_at(const Polyline& line, double place, double chord) {
  const double before = line.is_ring() ? chord : std::min(chord, place);
  const double behind = line.is_ring() ? chord : std::min(chord, line.length_world() - place);
  const WorldPoint a = line.direction(place - before, place), b = line.direction(place, place + behind);
  const double sizes = std::sqrt(length_sq(a) * length_sq(b));
  return sizes > 0 ? 1 - dot(a, b) / sizes : 0;
}

struct Candidate {
  double turn;
  size_t place;
};

std::vector<Candidate> candidates_on(const Polyline& line, const std::vector<uint8_t>& is_tooth,
                                     double edge_length_world) {
  const double chord = kChord * edge_length_world, least = kLeastChord * edge_length_world;
  std::vector<Candidate> found;
  for (size_t i = 0; i + 1 < line.size(); ++i) {
    const double place = line.along(i);
    if (!line.is_ring() && (place < least || line.length_world() - place < least)) continue;
    const double turn = turn_at(line, place, chord);
    if (!is_tooth[i] && turn > kTurn && turn_at(line, place, chord / 2) > kSudden * turn) found.push_back({turn, i});
  }
  return found;
}

}  // namespace

std::vector<size_t> corners_inside(const FeatureMesh& mesh, const EdgeChain& chain, double edge_length_world) {
  Polyline line(mesh, chain);
  const std::vector<uint8_t> is_tooth = chain.kind == CurveKind::border
                                            ? line.find_teeth(kLongestTooth * edge_length_world)
                                            : std::vector<uint8_t>(chain.vertex.size(), 0);
  line.smooth(kMostSmoothed * edge_length_world);
  line.integrate();
  std::vector<Candidate> candidates = candidates_on(line, is_tooth, edge_length_world);
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    return a.turn != b.turn ? a.turn > b.turn : a.place < b.place;
  });
  std::vector<size_t> corners;  // ascending
  const double apart = kChord * edge_length_world;
  const auto is_near = [&](size_t a, size_t b) {
    const double along = std::abs(line.along(a) - line.along(b));
    return (line.is_ring() ? std::min(along, line.length_world() - along) : along) < apart;
  };
  for (const Candidate& c : candidates) {
    const auto next = std::lower_bound(corners.begin(), corners.end(), c.place);
    if (!corners.empty()) {
      const size_t after = next == corners.end() ? corners.front() : *next;
      const size_t before = next == corners.begin() ? corners.back() : *(next - 1);
      if (is_near(after, c.place) || is_near(before, c.place)) continue;
    }
    corners.insert(next, c.place);
  }
  return corners;
}

}  // namespace isoshell
