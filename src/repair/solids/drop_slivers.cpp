// See drop_slivers.h.
#include "repair/solids/drop_slivers.h"

#include <algorithm>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

constexpr int kMostRounds = 32;
constexpr uint32_t kGone = 0xffffffffu;

/// Faces around vertices, kept while faces change.
class SliverMesh {
 public:
  SliverMesh(const std::vector<WorldPoint>& point, std::vector<std::array<uint32_t, 3>>& face, double thinnest)
      : point_(point), face_(face), thinnest_(thinnest), faces_at_(point.size()) {
    for (uint32_t f = 0; f < face_.size(); ++f)
      for (const uint32_t v : face_[f]) faces_at_[v].push_back(f);
  }

  /// Result: whether anything changed.
  bool pass() {
    bool is_changed = false;
    for (uint32_t f = 0; f < face_.size(); ++f) {
      if (is_gone(f)) continue;
      const size_t shortest = extreme_edge(f, true), longest = extreme_edge(f, false);
      if (edge_length(f, shortest) < thinnest_)
        is_changed |= collapse(face_[f][shortest], face_[f][(shortest + 1) % 3]);
      else if (height(face_[f]) < thinnest_)
        is_changed |= flip(f, longest);
    }
    return is_changed;
  }

  bool is_gone(uint32_t f) const { return face_[f][0] == kGone; }

 private:
  double edge_length(uint32_t f, size_t i) const { return length(point_[face_[f][i]] - point_[face_[f][(i + 1) % 3]]); }
  size_t extreme_edge(uint32_t f, bool is_shortest) const {
    size_t best = 0;
    for (size_t i = 1; i < 3; ++i)
      if (is_shortest ? edge_length(f, i) < edge_length(f, best) : edge_length(f, i) > edge_length(f, best)) best = i;
    return best;
  }
  double height(const std::array<uint32_t, 3>& t) const {
    const WorldPoint &a = point_[t[0]], &b = point_[t[1]], &c = point_[t[2]];
    const double longest = std::max({length(b - a), length(c - b), length(a - c)});
    return longest > 0 ? 2 * triangle_area(a, b, c) / longest : 0;
  }

  std::vector<uint32_t> neighbours(uint32_t v) const {
    std::vector<uint32_t> found;
    for (const uint32_t f : faces_at_[v])
      for (const uint32_t u : face_[f])
        if (u != v) found.push_back(u);
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }
  void remove(uint32_t v, uint32_t f) {
    auto& at = faces_at_[v];
    at.erase(std::remove(at.begin(), at.end(), f), at.end());
  }

  /// The larger end becomes the smaller one: vertices of the input come first.
  bool collapse(uint32_t a, uint32_t b) {
    const uint32_t keep = std::min(a, b), drop = std::max(a, b);
    const std::vector<uint32_t> p = neighbours(keep), q = neighbours(drop);
    std::vector<uint32_t> common;
    std::set_intersection(p.begin(), p.end(), q.begin(), q.end(), std::back_inserter(common));
    if (common.size() != 2 || p.size() + q.size() < 8) return false;
    const std::vector<uint32_t> faces = faces_at_[drop];
    for (const uint32_t f : faces) {
      auto& t = face_[f];
      if (std::find(t.begin(), t.end(), keep) != t.end()) {
        for (const uint32_t v : t) remove(v, f);
        t = {kGone, kGone, kGone};
        continue;
      }
      std::replace(t.begin(), t.end(), drop, keep);
      faces_at_[keep].push_back(f);
    }
    faces_at_[drop].clear();
    return true;
  }

  bool flip(uint32_t f, size_t i) {
    const uint32_t a = face_[f][i], b = face_[f][(i + 1) % 3], c = face_[f][(i + 2) % 3];
    uint32_t g = kGone, d = kGone;
    for (const uint32_t other : faces_at_[b])
      for (size_t j = 0; j < 3; ++j)
        if (face_[other][j] == b && face_[other][(j + 1) % 3] == a) {
          g = other;
          d = face_[other][(j + 2) % 3];
        }
    if (g == kGone || c == d) return false;
    const std::vector<uint32_t> around = neighbours(c);
    if (std::binary_search(around.begin(), around.end(), d)) return false;
    const std::array<uint32_t, 3> first{a, d, c}, second{d, b, c};
    if (std::min(height(first), height(second)) <= std::min(height(face_[f]), height(face_[g]))) return false;
    remove(b, f);
    remove(a, g);
    face_[f] = first;
    face_[g] = second;
    faces_at_[d].push_back(f);
    faces_at_[c].push_back(g);
    return true;
  }

  const std::vector<WorldPoint>& point_;
  std::vector<std::array<uint32_t, 3>>& face_;
  double thinnest_;
  std::vector<std::vector<uint32_t>> faces_at_;
};

}  // namespace

void drop_slivers(const std::vector<WorldPoint>& point, std::vector<std::array<uint32_t, 3>>& face,
                  std::vector<uint32_t>& source, double thinnest) {
  SliverMesh mesh(point, face, thinnest);
  for (int round = 0; round < kMostRounds && mesh.pass(); ++round) {
  }
  size_t kept = 0;
  for (uint32_t f = 0; f < face.size(); ++f) {
    if (mesh.is_gone(f)) continue;
    face[kept] = face[f];
    source[kept++] = source[f];
  }
  face.resize(kept);
  source.resize(kept);
}

}  // namespace isoshell::repair
