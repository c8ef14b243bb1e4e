#include "repair/holes/repair_loops.h"

#include <algorithm>
#include <cmath>

#include "geometry/world_vector.h"

namespace isoshell::repair {
namespace {

constexpr double kSameTurn = 1e-6;  // of four for a whole turn

/// Follows boundaries. Where several meet in a vertex, a hole goes on across the gap, to the boundary that comes next
/// around the vertex: its pieces of surface are seen in the plane across their mean normal.
class LoopFinder {
 public:
  explicit LoopFinder(const RepairMesh& mesh) : mesh_(mesh), next_(size_t(mesh.face_count()) * 3, kNoFace) {
    for (uint32_t h = 0; h < next_.size(); ++h)
      if (is_boundary(h)) boundary_.push_back(h);
    link();
  }

  /// Closed loops in the order of their smallest half-edges, which come first.
  std::vector<Loop> closed_loops() const {
    std::vector<Loop> loops;
    std::vector<uint8_t> seen(next_.size(), 0);
    std::vector<uint8_t> has_previous(next_.size(), 0);
    for (uint32_t h : boundary_)
      if (next_[h] != kNoFace) has_previous[next_[h]] = 1;
    for (uint32_t h : boundary_)  // open chains first: what starts nowhere is no loop
      if (!has_previous[h])
        for (uint32_t g = h; g != kNoFace && !seen[g]; g = next_[g]) seen[g] = 1;
    for (uint32_t h : boundary_) {
      if (seen[h]) continue;
      loops.emplace_back();
      for (uint32_t g = h; !seen[g]; g = next_[g]) {
        seen[g] = 1;
        loops.back().push_back(g);
      }
    }
    return loops;
  }

 private:
  /// A piece of surface around a vertex between two boundary edges: `out` leaves the vertex, `in` ends there.
  struct Fan {
    uint32_t in, out;
    WorldPoint normal;
  };

  bool is_boundary(uint32_t h) const { return mesh_.is_live(h / 3) && mesh_.faces_at(mesh_.edge_of(h)) == 1; }

  void link() {
    std::vector<uint32_t> in = boundary_;
    std::sort(in.begin(), in.end(),
              [&](uint32_t g, uint32_t h) { return mesh_.to(g) != mesh_.to(h) ? mesh_.to(g) < mesh_.to(h) : g < h; });
    std::vector<Fan> fans;
    for (size_t i = 0, stop; i < in.size(); i = stop) {
      fans.clear();
      for (stop = i; stop < in.size() && mesh_.to(in[stop]) == mesh_.to(in[i]); ++stop) {
        const Fan fan = fan_from(in[stop]);
        if (fan.out != kNoFace) fans.push_back(fan);
      }
      if (fans.size() < 2 || !link_across_gaps(mesh_.to(in[i]), fans))
        for (const Fan& fan : fans) next_[fan.in] = fan.out;
    }
  }

  /// Walks around the end of a boundary half-edge through its faces. out: kNoFace when they do not agree or an edge of
  /// more faces is in the way.
  Fan fan_from(uint32_t in) const {
    Fan fan = {in, kNoFace, {0, 0, 0}};
    for (uint32_t h = in;;) {
      const WorldPoint n = mesh_.doubled_area(h / 3);
      fan.normal = fan.normal + n;
      const uint32_t g = next_in_triangle(h);
      const uint32_t faces = mesh_.faces_at(mesh_.edge_of(g));
      if (faces == 1) fan.out = g;
      if (faces != 2 || !mesh_.agrees(g)) return fan;
      h = mesh_.twin(g);
    }
  }

  /// False when the fans do not lie around the vertex one after the other.
  bool link_across_gaps(uint32_t vertex, const std::vector<Fan>& fans) {
    WorldPoint n = {0, 0, 0};
    for (const Fan& fan : fans) n = n + fan.normal;
    const WorldPoint& at = mesh_.position[vertex];
    const WorldPoint u = cross(n, mesh_.position[mesh_.to(fans[0].out)] - at), v = cross(n, u);
    if (dot(u, u) == 0) return false;
    struct Ray {
      double turn;
      bool is_in;
      uint32_t half_edge;
    };
    // u and v are perpendicular, v longer by |n|: only their directions count.
    const double u_length = length(u), v_length = length(v);
    std::vector<Ray> rays;
    for (const Fan& fan : fans) {
      const WorldPoint in = mesh_.position[mesh_.from(fan.in)] - at, out = mesh_.position[mesh_.to(fan.out)] - at;
      rays.push_back({turn_of(dot(in, u) / u_length, dot(in, v) / v_length), true, fan.in});
      rays.push_back({turn_of(dot(out, u) / u_length, dot(out, v) / v_length), false, fan.out});
    }
    std::sort(rays.begin(), rays.end(), [](const Ray& a, const Ray& b) {
      return a.turn != b.turn ? a.turn < b.turn : a.half_edge < b.half_edge;
    });
    // Gaps without width, as T-junctions have them: a boundary that ends lies before the one that begins.
    for (size_t i = 0; i + 1 < rays.size(); ++i)
      if (!rays[i].is_in && rays[i + 1].is_in && rays[i + 1].turn - rays[i].turn < kSameTurn)
        std::swap(rays[i], rays[i + 1]);
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays[i].is_in == rays[(i + 1) % rays.size()].is_in) return false;
    for (size_t i = 0; i < rays.size(); ++i)
      if (rays[i].is_in) next_[rays[i].half_edge] = rays[(i + 1) % rays.size()].half_edge;
    return true;
  }

  /// Grows with the angle of (x, y), 0 to 4.
  static double turn_of(double x, double y) {
    const double size = std::abs(x) + std::abs(y);
    if (size == 0) return 0;
    const double t = y / size;
    return x < 0 ? 2 - t : t < 0 ? 4 + t : t;
  }

  const RepairMesh& mesh_;
  std::vector<uint32_t> boundary_, next_;
};

}  // namespace

std::vector<Loop> closed_loops(const RepairMesh& mesh) { return LoopFinder(mesh).closed_loops(); }

}  // namespace isoshell::repair
