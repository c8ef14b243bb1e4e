// The mesh that repair works on: vertices welded and numbered by position, faces sorted, and which faces meet at an
// edge.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "geometry/half_edges.h"
#include "isoshell/surface_source.h"

namespace isoshell::repair {

constexpr uint32_t kNoFace = 0xffffffffu;

using Corners = std::array<uint32_t, 3>;

/// Faces never move: dropped ones are dead. Half-edge 3 f + i runs from corner i of face f to the next one.
class RepairMesh {
 public:
  explicit RepairMesh(const TriangleSoup& soup);

  int64_t face_count() const { return int64_t(face.size()); }
  bool is_live(uint32_t f) const { return live_[f]; }
  void drop(uint32_t f);
  void turn(uint32_t f);
  bool is_turned(uint32_t f) const { return turned_[f]; }
  /// Faces with three distinct corners that repeat another one, whichever way round.
  int64_t repeats() const { return repeats_; }
  /// Vertices on boundaries that became others next to them.
  int64_t joined_vertices() const { return joined_; }

  uint32_t from(uint32_t half_edge) const { return face[half_edge / 3][half_edge % 3]; }
  uint32_t to(uint32_t half_edge) const { return from(next_in_triangle(half_edge)); }
  uint32_t edge_of(uint32_t half_edge) const { return edge_of_[half_edge]; }
  /// Number of live faces at an edge.
  uint32_t faces_at(uint32_t edge) const { return live_at_[edge]; }
  /// Counts a face without area at an edge, and no more.
  void add_flat_face(uint32_t edge) { ++live_at_[edge]; }
  void drop_flat_face(uint32_t edge) { --live_at_[edge]; }
  /// The other half-edge of an edge with two live faces.
  uint32_t twin(uint32_t half_edge) const;
  /// Whether the two faces of an edge pass it in opposite directions.
  bool agrees(uint32_t half_edge) const { return from(half_edge) == to(twin(half_edge)); }
  /// Whether a live face has this edge.
  bool has_edge(uint32_t a, uint32_t b) const;
  WorldPoint doubled_area(uint32_t f) const;
  double area(uint32_t f) const;

  std::vector<WorldPoint> position;  ///< distinct, in the order of x, y, z; some may belong to no face
  std::vector<Corners> face;         ///< three distinct corners, once each; begins sorted, smallest corner first
  std::vector<uint32_t> source;      ///< the soup's triangle, the smallest of its repeats

 private:
  void list_faces(const TriangleSoup& soup);
  void list_edges();
  bool join_cracks();
  std::vector<double> crack_widths() const;
  std::vector<uint32_t> first_within_cracks() const;

  std::vector<uint32_t> welded_;  ///< per vertex of the soup
  std::vector<uint8_t> live_, turned_;
  EdgeSides sides_;                   ///< turning a face keeps its edges' lists
  std::vector<uint32_t> edge_first_;  ///< where those of an edge start
  std::vector<uint32_t> edge_of_, live_at_;
  int64_t repeats_ = 0, joined_ = 0;
};

}  // namespace isoshell::repair
