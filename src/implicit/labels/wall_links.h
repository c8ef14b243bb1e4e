// Which vertices of walls are neighbours.
#pragma once

#include <vector>

#include "implicit/labels/label_walls.h"

namespace isoshell {

/// The faces at each vertex, ascending.
Buckets<uint32_t> faces_at_vertices(const LabelWalls& walls);

/// A vertex at the other end of an edge.
class WallLink {
 public:
  WallLink() = default;
  WallLink(uint32_t vertex, bool is_along_curve) : bits_(vertex | (is_along_curve ? kAlong : 0)) {}

  uint32_t vertex() const { return bits_ & ~(kAlong | kTo); }
  bool is_along_curve() const { return (bits_ & kAlong) != 0; }
  bool is_to_curve() const { return (bits_ & kTo) != 0; }  ///< whether that vertex is on a curve
  void mark_to_curve() { bits_ |= kTo; }

 private:
  static constexpr uint32_t kAlong = 1u << 31, kTo = 1u << 30;  // vertices are fewer, see find_label_walls
  uint32_t bits_;
};

/// The edges at each vertex. Those with other than two faces are along curves, and so are those at which walls leave a
/// side of the volume: the fold there is no bend.
class WallLinks {
 public:
  enum class Kind : uint8_t { in_wall, beside_curve, on_curve, corner };  ///< corners have other than two curves' edges

  WallLinks(const LabelWalls& walls, const Buckets<uint32_t>& faces_at);

  View<const WallLink> at(size_t vertex) const { return links_.in(int64_t(vertex)); }
  Kind kind(size_t vertex) const { return kind_[vertex]; }
  bool is_on_curve(size_t vertex) const { return kind_[vertex] >= Kind::on_curve; }
  /// How many neighbours a vertex has that is no corner; one on a curve has two along it.
  int followed(size_t vertex) const { return is_on_curve(vertex) ? 2 : int(at(vertex).size); }
  /// Whether these two corners of a face are on curves, and no curve runs from the one to the other
  /// around the face by a vertex that is no corner of curves.
  bool is_strip_between(uint32_t a, uint32_t b, const std::array<uint32_t, 4>& face) const;

 private:
  bool is_along_curve(uint32_t a, uint32_t b) const;

  Buckets<WallLink> links_;  ///< by vertex, ascending
  std::vector<Kind> kind_;
};

}  // namespace isoshell
