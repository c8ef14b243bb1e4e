// The mesh that is changed edge by edge: what every split, collapse, flip and move must hold to.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "geometry/world_vector.h"
#include "isoshell/advanced/voxel_set.h"
#include "measure/triangle_space.h"

namespace isoshell {

/// A vertex, where it sits on a cut surface.
struct RegionVertex {
  enum class Kind : uint8_t { corner, on_curve, free };
  Kind kind = Kind::free;
  bool is_inner = true;     ///< all its triangles are in the mesh
  bool is_fixed = false;    ///< neither it nor edges between such change, and no triangles between such are made
  bool is_settled = false;  ///< relaxed: it is where it is to be, and is evened out no more
  WorldPoint position;      ///< steps of 1/256 voxel, whole ones in results: the guard leaves fractions out
  uint32_t home = 0;        ///< vertex of the surface; off the free ones a copy of their place
  uint32_t curve = 0;       ///< that a vertex is on, of CutSurface::curves
  size_t at = 0;            ///< its place on it
  uint32_t number = kNone;  ///< in the mesh that it is of; none of what was put in
};

struct RegionTriangle {
  std::array<uint32_t, 3> corner;
  std::array<uint32_t, 3> curve;  ///< that the edge from corner i to the next is on; kNone off curves
  uint32_t patch = 0;

  /// Its place stays, so that the others keep theirs.
  bool is_gone() const { return corner[0] == corner[1]; }
  /// The edge from one vertex to another; 3 where it has none.
  size_t edge_between(uint32_t u, uint32_t v) const {
    for (size_t i = 0; i < 3; ++i)
      if (corner[i] == u && corner[(i + 1) % 3] == v) return i;
    return 3;
  }
  bool has(uint32_t v) const { return corner[0] == v || corner[1] == v || corner[2] == v; }
};

/// The triangles that a change replaces, and those that it makes. It is kept from one change to the next, so that they
/// do not take memory each time.
struct MeshChange {
  std::vector<uint32_t> replaced;
  std::vector<RegionTriangle> made;
  std::vector<uint32_t> number;                ///< that each has; kNone: a new one
  std::vector<std::array<uint32_t, 3>> fused;  ///< ends of edges that come to be on a curve, and that
  std::vector<uint32_t> here, there;           ///< neighbours of the ends of an edge that is collapsed
  std::vector<CornersOfTriangle> corners;      ///< of those that are made

  void clear() { replaced.clear(), made.clear(), number.clear(), fused.clear(); }
};

/// The sine of the smallest angle of a triangle.
double smallest_sine(const WorldPoint& a, const WorldPoint& b, const WorldPoint& c);

/// Edges have two triangles or, on curves, any number. A change keeps the topology of every region, the patches, the
/// curves; no edge and no triangle comes to be there twice, and with `keep_apart` no triangle comes
/// to meet another one outside of corners that they share. Which of these changes are made is up to the caller: allow()
/// is asked once it is known what a change makes, and before all that is costly. A change that is not made leaves the
/// mesh as it was. Vertices and triangles keep their numbers; those that are gone have no triangles, and one corner
/// twice. Several threads may make changes at once, each with its own MeshChange, but for splits, where the triangles
/// around their vertices, before and after, lie in boxes that do not meet. Cost of each: the triangles around its
/// vertices, and, but for flips within a plane, a look at those whose boxes meet them.
class EditableMesh {
 public:
  /// Of few triangles, all are looked at where those of a vertex are asked for, and copies are cheap; of many, each
  /// vertex has a list.
  enum class Size { few, many };
  EditableMesh(std::vector<RegionVertex> vertices, std::vector<RegionTriangle> triangles, Size size);

  const std::vector<RegionVertex>& vertices() const { return vertices_; }
  const std::vector<RegionTriangle>& triangles() const { return triangles_; }
  const RegionVertex& vertex(uint32_t v) const { return vertices_[v]; }
  const WorldPoint& at(uint32_t v) const { return vertices_[v].position; }
  /// Those that have triangles, of a mesh of many; and these.
  int64_t vertex_count() const { return count_.value; }
  const std::vector<uint32_t>& around(uint32_t v) const { return around_[v]; }

  template <class Visit>
  void for_each_around(uint32_t v, Visit visit) const {
    if (around_.empty()) {
      for (uint32_t t = 0; t < triangles_.size(); ++t)
        if (triangles_[t].has(v)) visit(t);
      return;
    }
    for (const uint32_t t : around_[v]) visit(t);
  }
  /// The first triangle around a vertex that is so; kNone where none is. is(t) says no to those that do not have it.
  template <class Is>
  uint32_t find_around(uint32_t v, Is is) const {
    if (around_.empty()) {
      for (uint32_t t = 0; t < triangles_.size(); ++t)
        if (is(triangles_[t])) return t;
      return kNone;
    }
    for (const uint32_t t : around_[v])
      if (is(triangles_[t])) return t;
    return kNone;
  }
  void list_neighbours(uint32_t v, std::vector<uint32_t>& out) const;
  /// Those that a vertex may be taken into, as far as its curve tells: of a corner none.
  void list_targets(uint32_t v, std::vector<uint32_t>& out) const;
  bool is_edge(uint32_t u, uint32_t v) const {
    return find_around(with_fewer(u, v), [&](const RegionTriangle& t) { return t.has(u) && t.has(v); }) != kNone;
  }
  /// The curve of the edge between two vertices, kNone off curves; no value where there is no edge.
  std::optional<uint32_t> curve_between(uint32_t u, uint32_t v) const;
  WorldPoint normal(const RegionTriangle& t) const {
    return doubled_area(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]));
  }
  /// Of the smallest angle; 1 where it is gone.
  double sine(const RegionTriangle& t) const {
    return t.is_gone() ? 1 : smallest_sine(at(t.corner[0]), at(t.corner[1]), at(t.corner[2]));
  }
  CornersOfTriangle corners(const RegionTriangle& t) const;

  /// From now on no triangle comes to meet another one, but those that the triangles that it replaces met. They are in
  /// cells of that size.
  void keep_apart(double cell_q8);
  /// Calls use(number) for each other triangle that one meets outside of corners that they share. After keep_apart.
  template <class Use>
  void for_each_met(uint32_t triangle, Use use) const {
    space_->for_each_met(corners(triangles_[triangle]), [&](uint32_t other) {
      if (other != triangle) use(other);
    });
  }
  /// Whether there is one.
  bool meets_any(uint32_t triangle) const {
    return space_->meets_any(corners(triangles_[triangle]), [&](uint32_t other) { return other != triangle; });
  }

  /// Puts the other diagonal into two triangles of one patch. Whether the change was made, here and below.
  template <class Allow>
  bool flip(uint32_t triangle, size_t edge, MeshChange& change, Allow allow) {
    return list_flip(triangle, edge, change) && allow() &&
           !is_edge(change.made[1].corner[1], change.made[1].corner[2]) && commit_flip(change);
  }
  /// Takes a vertex into another one, along their edge: a free one, or one on a curve along that.
  template <class Allow>
  bool collapse(uint32_t gone, uint32_t into, MeshChange& change, Allow allow) {
    return list_collapse(gone, into, change) && allow() && commit(change);
  }
  /// Puts a vertex, the last one then, into an edge.
  template <class Allow>
  bool split(uint32_t u, uint32_t v, const RegionVertex& middle, MeshChange& change, Allow allow) {
    if (!list_split(u, v, change)) return false;
    add_vertex(middle);
    if (allow() && commit(change)) return true;
    drop_last_vertex();
    return false;
  }
  /// Along its curve, or in its patch; it is there already when allow() is asked.
  template <class Allow>
  bool move(uint32_t v, const RegionVertex& to, MeshChange& change, Allow allow) {
    const RegionVertex before = vertices_[v];
    if (before.kind == RegionVertex::Kind::corner || before.is_fixed) return false;
    list_around(v, change);
    place(v, to);
    if (allow() && commit(change)) return true;
    vertices_[v] = before;
    return false;
  }

 protected:
  /// The edge from corner `edge` of a triangle to the next.
  struct Side {
    uint32_t triangle;
    size_t edge;
  };
  template <class Visit>
  void for_each_side(uint32_t u, uint32_t v, Visit visit) const {
    for_each_around(u, [&](uint32_t t) {
      const auto& c = triangles_[t].corner;
      const size_t i = c[0] == u ? 0 : c[1] == u ? 1 : 2;
      if (c[(i + 1) % 3] == v) visit(Side{t, i});
      if (c[(i + 2) % 3] == v) visit(Side{t, (i + 2) % 3});
    });
  }
  void place(uint32_t v, const RegionVertex& to) {
    vertices_[v].home = to.home;
    vertices_[v].at = to.at;
    vertices_[v].position = to.position;
  }
  void add_vertex(const RegionVertex& v);
  void drop_last_vertex();
  void fix(uint32_t v) { vertices_[v].is_fixed = true; }
  /// Without a look at what a triangle meets.
  void add(const RegionTriangle& t);
  void remove(uint32_t triangle);
  /// Where nothing comes to meet.
  bool commit(MeshChange& change);

 private:
  /// By several threads at once.
  struct Count {
    std::atomic<int64_t> value{0};

    Count() = default;
    Count(const Count& o) : value(o.value.load()) {}
    Count& operator=(const Count& o) { return value = o.value.load(), *this; }
  };

  /// Of two vertices one with fewer triangles, where each has a list.
  uint32_t with_fewer(uint32_t u, uint32_t v) const {
    return around_.empty() || around_[u].size() < around_[v].size() ? u : v;
  }
  bool list_flip(uint32_t triangle, size_t edge, MeshChange& change) const;
  bool list_collapse(uint32_t gone, uint32_t into, MeshChange& change) const;
  bool list_split(uint32_t u, uint32_t v, MeshChange& change) const;
  void list_around(uint32_t v, MeshChange& change) const;
  bool may_meet_neighbours(uint32_t gone, uint32_t into, MeshChange& change) const;
  bool has_only_fixed(const RegionTriangle& t) const;
  bool are_free(MeshChange& change) const;
  bool is_in_plane(const MeshChange& flip) const;
  bool commit_flip(MeshChange& change);
  void make(MeshChange& change);
  void replace(uint32_t triangle, const RegionTriangle& by);

  std::vector<RegionVertex> vertices_;
  std::vector<RegionTriangle> triangles_;
  std::vector<std::vector<uint32_t>> around_;  ///< per vertex its triangles; empty: there are few
  std::shared_ptr<TriangleSpace> space_;       ///< once triangles are kept apart; copies are made before
  Count count_;
};

constexpr double kPoorSine = 0.5;          ///< of 30 degrees
constexpr double kMostCost = 1e6;          ///< of one triangle: a degenerate one
constexpr double kEnough = 1 - 1. / 1024;  ///< of the cost before, or a change is not worth it
/// On the lattice.
inline PointQ8 rounded_down(const WorldPoint& p) { return {int32_t(p.x), int32_t(p.y), int32_t(p.z)}; }

}  // namespace isoshell
