#include "isoshell/boolean_union.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "core/watched.h"
#include "geometry/box.h"
#include "geometry/world_vector.h"
#include "repair/holes/repair_mesh.h"
#include "repair/solids/winding.h"

namespace isoshell {
namespace {

using repair::Corners;
using repair::RepairMesh;

constexpr int kMostSplits = 12;            // halvings of an edge
constexpr int64_t kFacesAtOnce = 1 << 16;  // whose pieces are kept until they are told

struct Component {
  WorldBox box = box_of_none();
  uint32_t largest_face = 0;  ///< the first of the largest
  double largest_area = -1, six_volume = 0;
  bool turned = false, inner = false;  ///< inner: lies in another component
  int64_t kept = 0;

  bool looks_inward() const { return (six_volume < 0) != turned; }
  bool is_within_box_of(const Component& o) const {
    const WorldPoint &lo = box.min, &hi = box.max, &low = o.box.min, &high = o.box.max;
    return lo.x > low.x && lo.y > low.y && lo.z > low.z && hi.x < high.x && hi.y < high.y && hi.z < high.z;
  }
};

/// A face, or a piece of one.
struct Piece {
  WorldPoint a, b, c;
  WorldPoint at(double u, double v, double w) const {
    return {u * a.x + v * b.x + w * c.x, u * a.y + v * b.y + w * c.y, u * a.z + v * b.z + w * c.z};
  }
  /// The middle, and near the corners.
  std::array<WorldPoint, 4> samples() const {
    constexpr double kNear = .95, kFar = (1 - kNear) / 2;
    return {at(1. / 3, 1. / 3, 1. / 3), at(kNear, kFar, kFar), at(kFar, kNear, kFar), at(kFar, kFar, kNear)};
  }
  WorldBox box() const { return box_of(a, b, c); }
  double longest_edge() const { return std::sqrt(std::max({distance_sq(a, b), distance_sq(b, c), distance_sq(c, a)})); }
};

/// Whether a piece has points on both sides of another one's plane.
bool passes_through_plane(const Piece& p, const Piece& of) {
  const WorldPoint n = doubled_area(of.a, of.b, of.c);
  const auto height = [&](const WorldPoint& q) { return dot(n, q - of.a); };
  const double a = height(p.a), b = height(p.b), c = height(p.c);
  return std::min({a, b, c}) < 0 && std::max({a, b, c}) > 0;
}

/// False only when they surely have no point in common, or touch.
bool may_cut(const Piece& p, const Piece& q) {
  return boxes_meet(p.box(), q.box()) && passes_through_plane(p, q) && passes_through_plane(q, p);
}

class Union {
 public:
  Union(const RepairMesh& mesh, const UnionOptions& options, UnionReport& report, const Context& context)
      : mesh_(mesh), options_(options), report_(report), context_(context), rays_(mesh.position, mesh.face) {
    find_components();
    turn_outward();
    for (const Component& c : components_) {
      report_.turned_components += c.turned;
      report_.dropped_inner += is_dropped(c);
    }
  }

  /// Every face of the boundary, or piece of one that is cut.
  template <class Keep, class KeepPiece>
  void for_each_kept(Keep keep, KeepPiece keep_piece) {
    joined_ = IndexSets(int64_t(components_.size()));
    std::vector<Parts> parts;
    for (uint32_t begin = 0, end; begin < mesh_.face_count(); begin = end) {
      end = uint32_t(std::min(mesh_.face_count(), int64_t(begin) + kFacesAtOnce));
      parts.assign(end - begin, {});
      for_each_index(begin, end, [&](uint32_t f) {
        if (!is_dropped(components_[component_[f]])) split(f, piece_of(f), 0, cutters_of(f), parts[f - begin]);
      });
      for (uint32_t f = begin; f < end; ++f) take(f, parts[f - begin], keep, keep_piece);
    }
    count_components();
  }

 private:
  struct Parts {
    std::vector<Piece> kept;
    std::vector<uint32_t> joins;  ///< components that a piece which is kept lies partly in
    int64_t dropped = 0;
  };

  template <class Keep, class KeepPiece>
  void take(uint32_t f, const Parts& parts, Keep& keep, KeepPiece& keep_piece) {
    Component& own = components_[component_[f]];
    for (const uint32_t other : parts.joins) joined_.unite(component_[f], other);
    if (parts.kept.empty()) return;
    ++own.kept;
    if (parts.dropped == 0) return keep(f, own.turned);
    ++report_.cut_faces;
    for (const Piece& part : parts.kept) keep_piece(f, part, own.turned);
  }

  void find_components() {
    IndexSets sets(int64_t(mesh_.position.size()));
    for (const Corners& t : mesh_.face)
      for (const uint32_t v : t) sets.unite(t[0], v);
    std::vector<uint32_t> number(mesh_.position.size(), repair::kNoFace);
    component_.resize(mesh_.face.size());
    for (uint32_t f = 0; f < mesh_.face.size(); ++f) {
      uint32_t& at = number[sets.root(mesh_.face[f][0])];
      if (at == repair::kNoFace) {
        at = uint32_t(components_.size());
        components_.emplace_back();
      }
      component_[f] = at;
      add(components_[at], f);
    }
  }

  void add(Component& c, uint32_t f) {
    c.box = joined(c.box, piece_of(f).box());
    if (const double area = mesh_.area(f); area > c.largest_area) {
      c.largest_area = area;
      c.largest_face = f;
    }
    c.six_volume += dot(mesh_.position[mesh_.face[f][0]] - mesh_.position[0], mesh_.doubled_area(f));
  }

  void turn_outward() {
    double all = 0;
    for (const Component& c : components_) all += c.six_volume;
    for (uint32_t i = 0; i < components_.size(); ++i) {
      check_cancel(context_, "unite");
      Component& c = components_[i];
      c.turned = all < 0;
      std::map<uint32_t, int> winding;
      rays_.for_each_crossing(piece_of(c.largest_face).at(1. / 3, 1. / 3, 1. / 3), c.largest_face,
                              [&](uint32_t f, int sign) { winding[component_[f]] += sign; });
      for (const auto& [other, number] : winding)
        c.inner |= other != i && number != 0 && c.is_within_box_of(components_[other]);
      if (!c.inner && c.looks_inward()) c.turned = !c.turned;
    }
  }

  bool is_dropped(const Component& c) const { return options_.outer_only && c.inner; }

  Piece piece_of(uint32_t f) const {
    const Corners& t = mesh_.face[f];
    return {mesh_.position[t[0]], mesh_.position[t[1]], mesh_.position[t[2]]};
  }

  /// Faces of other components that may pass through a face, ascending.
  std::vector<uint32_t> cutters_of(uint32_t f) const {
    const Piece piece = piece_of(f);
    std::vector<uint32_t> found;
    rays_.for_each_near(piece.box(), [&](uint32_t g) {
      const Component& other = components_[component_[g]];
      if (component_[g] != component_[f] && !is_dropped(other) && may_cut(piece, piece_of(g))) found.push_back(g);
    });
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  /// Pieces that nothing cuts lie on one side; of the others that are small those are kept that lie outside in part.
  void split(uint32_t f, const Piece& piece, int splits, const std::vector<uint32_t>& cutters, Parts& parts) const {
    check_cancel(context_, "unite");
    const bool is_last = cutters.empty() || splits == kMostSplits || piece.longest_edge() <= options_.finest_edge_world;
    if (!is_last) {
      const WorldPoint ab = piece.at(.5, .5, 0), bc = piece.at(0, .5, .5), ca = piece.at(.5, 0, .5);
      for (const Piece& part :
           {Piece{piece.a, ab, ca}, Piece{ab, piece.b, bc}, Piece{ca, bc, piece.c}, Piece{ab, bc, ca}}) {
        std::vector<uint32_t> near;
        for (const uint32_t g : cutters)
          if (may_cut(part, piece_of(g))) near.push_back(g);
        split(f, part, splits + 1, near, parts);
      }
      return;
    }
    int outside = 0;
    for (const WorldPoint& p : piece.samples()) outside += is_on_boundary(f, p);
    if (outside > 0)
      parts.kept.push_back(piece);
    else
      ++parts.dropped;
    if (outside > 0 && outside < 4)
      for (const uint32_t g : cutters) parts.joins.push_back(component_[g]);
  }

  /// Whether the outer side of a face of the union is free at p, which lies on face f.
  bool is_on_boundary(uint32_t f, const WorldPoint& p) const {
    const uint32_t own = component_[f];
    int number = components_[own].looks_inward() ? -1 : 0;
    const auto is_of_another = [&](uint32_t g) {
      return component_[g] != own && !is_dropped(components_[component_[g]]);
    };
    rays_.for_each_crossing(p, f, is_of_another,
                            [&](uint32_t g, int sign) { number += components_[component_[g]].turned ? -sign : sign; });
    return number == 0;
  }

  void count_components() {
    std::vector<uint8_t> counted(components_.size());  // by root, which may itself have been swallowed
    for (uint32_t c = 0; c < components_.size(); ++c) {
      const Component& here = components_[c];
      uint8_t& set_counted = counted[joined_.root(c)];
      report_.joined_components += here.kept > 0 && !set_counted;
      set_counted |= here.kept > 0;
      report_.swallowed_components += here.kept == 0 && !is_dropped(here);
      report_.inner_surfaces += here.kept > 0 && here.inner && here.looks_inward();
    }
  }

  const RepairMesh& mesh_;
  const UnionOptions& options_;
  UnionReport& report_;
  const Context& context_;
  const RayColumns rays_;
  std::vector<Component> components_;
  std::vector<uint32_t> component_;  ///< per face
  IndexSets joined_{0};              ///< components that cut one another
};

}  // namespace

TriangleSoup boolean_union(const TriangleSoup& soup, const UnionOptions& options, UnionReport& report,
                           const Context& context) {
  report = {};
  const RepairMesh mesh(soup);
  TriangleSoup united;
  united.vertices = mesh.position;
  united.faces_in_file = soup.faces_in_file;
  united.dirt = soup.dirt;
  std::vector<Corners> caps;
  const auto add = [&](uint32_t f, Corners corner, bool turned) {
    if (turned) std::swap(corner[1], corner[2]);
    (mesh.source[f] < soup.first_cap ? united.triangles : caps).push_back(corner);
  };
  const auto keep = [&](uint32_t f, bool turned) { add(f, mesh.face[f], turned); };
  const auto keep_piece = [&](uint32_t f, const Piece& piece, bool turned) {
    const uint32_t first = uint32_t(united.vertices.size());
    united.vertices.insert(united.vertices.end(), {piece.a, piece.b, piece.c});
    add(f, {first, first + 1, first + 2}, turned);
  };
  run_with_threads(context, [&] { Union(mesh, options, report, context).for_each_kept(keep, keep_piece); });
  if (!caps.empty()) united.first_cap = uint32_t(united.triangles.size());
  united.triangles.insert(united.triangles.end(), caps.begin(), caps.end());
  return report.changed_anything() && !united.triangles.empty() ? united : soup;
}

}  // namespace isoshell
