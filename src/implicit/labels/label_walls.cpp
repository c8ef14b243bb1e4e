// find_label_walls (see label_walls.h).
#include "implicit/labels/label_walls.h"

#include <algorithm>
#include <numeric>
#include <string>
#include <utility>

#include "core/watched.h"
#include "implicit/labels/label_rows.h"
#include "implicit/labels/tied_sides.h"
#include "implicit/labels/wall_corner.h"
#include "isoshell/advanced/voxel_set.h"
#include "isoshell/error.h"

namespace isoshell {
namespace {

Voxel stepped(Voxel v, int axis, int32_t by) {
  (axis == 0 ? v.x : axis == 1 ? v.y : v.z) += by;
  return v;
}

/// A corner that has vertices.
struct UsedCorner {
  uint32_t place;  ///< in its layer of corners: y (size_x + 1) + x
  uint32_t first;  ///< of its vertices, among those of the layer
  WallCorner walls;
};

/// The corners of one z.
class CornerLayer {
 public:
  std::vector<UsedCorner> used;  ///< ascending by place
  uint32_t vertices = 0;

  CornerLayer() = default;
  CornerLayer(const LabelRows& labels, int32_t z) {
    const int32_t width = labels.size(0) + 1, background = labels.background();
    for (int32_t y = 0; y <= labels.size(1); ++y) {
      first_of_row_.push_back(uint32_t(used.size()));
      const int32_t* const rows[4] = {labels.row(y - 1, z - 1), labels.row(y, z - 1), labels.row(y - 1, z),
                                      labels.row(y, z)};
      std::array<int32_t, 4> near{background, background, background, background}, far = near;
      for (int32_t x = 0; x < width; ++x) {
        bool is_inside_one = true;
        for (size_t k = 0; k < 4; ++k) {
          far[k] = x + 1 < width ? rows[k][x] : background;
          is_inside_one &= far[k] == near[0] && near[k] == near[0];
        }
        if (!is_inside_one) {
          used.push_back({uint32_t(y) * uint32_t(width) + uint32_t(x), vertices,
                          WallCorner({near[0], far[0], near[1], far[1], near[2], far[2], near[3], far[3]})});
          vertices += uint32_t(used.back().walls.sheets);
        }
        near = far;
      }
    }
    first_of_row_.push_back(uint32_t(used.size()));
  }
  const UsedCorner& at(int32_t y, uint32_t place) const {
    const auto row = used.begin() + first_of_row_[size_t(y)], end = used.begin() + first_of_row_[size_t(y) + 1];
    return *std::lower_bound(row, end, place, [](const UsedCorner& c, uint32_t p) { return c.place < p; });
  }

 private:
  std::vector<uint32_t> first_of_row_;  ///< into `used`, and one more
};

/// A pair of parted walls along a lattice edge: the vertex in its middle is of the layer of the edge's first corner.
struct Middle {
  uint32_t place;
  uint8_t axis, pair;
  bool operator==(const Middle& o) const { return place == o.place && axis == o.axis && pair == o.pair; }
  bool operator<(const Middle& o) const {
    return place != o.place ? place < o.place : axis != o.axis ? axis < o.axis : pair < o.pair;
  }
};

/// Makes the walls, layer by layer.
class WallMaker {
 public:
  WallMaker(const LabelVolume& volume, const Context& context)
      : labels_(volume), context_(context), corners_(size_t(volume.size_vox[2]) + 1), middles_(corners_.size()) {}

  LabelWalls make() {
    for_each_layer([&](size_t z) {
      corners_[z] = CornerLayer(labels_, int32_t(z));
      middles_[z] = middles_of(int32_t(z));
    });
    number_vertices();
    LabelWalls walls;
    walls.low_quarters = side_quarters(0);
    walls.high_quarters = side_quarters(2);
    walls.rest_quarters.resize(first_vertex_.back());
    walls.is_thin.assign(first_vertex_.back(), 0);
    std::vector<LabelWalls> layers(corners_.size());
    for_each_layer([&](size_t z) {
      place_vertices(z, walls.rest_quarters);
      mark_thin(z, walls.is_thin);
      layers[z] = faces_of(int32_t(z));
    });
    join_layers(std::move(layers), walls);
    return walls;
  }

 private:
  template <class Work>
  void for_each_layer(Work work) const {
    for_each_index(size_t(0), corners_.size(), [&](size_t z) {
      check_cancel(context_, "read");
      work(z);
    });
  }
  /// Corners are not needed any more, and each layer only until it is copied.
  void join_layers(std::vector<LabelWalls> layers, LabelWalls& walls) {
    corners_ = {};
    middles_ = {};
    size_t faces = 0;
    for (const LabelWalls& layer : layers) faces += layer.faces.size();
    walls.faces.reserve(faces);
    walls.labels.reserve(faces);
    for (LabelWalls& layer : layers) {
      walls.faces.insert(walls.faces.end(), layer.faces.begin(), layer.faces.end());
      walls.labels.insert(walls.labels.end(), layer.labels.begin(), layer.labels.end());
      walls.crossed.insert(walls.crossed.end(), layer.crossed.begin(), layer.crossed.end());
      layer = {};
    }
  }

  uint32_t width() const { return uint32_t(labels_.size(0)) + 1; }
  uint32_t place_of(Voxel corner) const { return uint32_t(corner.y) * width() + uint32_t(corner.x); }
  Voxel corner_at(uint32_t place, size_t z) const {
    return {int32_t(place % width()), int32_t(place / width()), int32_t(z)};
  }

  /// Around the lattice edge that leaves a corner along an axis, in turn from the octant nearest to the origin.
  WallEdge edge_from(Voxel corner, int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    return WallEdge({labels_.at(stepped(stepped(corner, u, -1), v, -1)), labels_.at(stepped(corner, v, -1)),
                     labels_.at(corner), labels_.at(stepped(corner, u, -1))});
  }

  std::vector<Middle> middles_of(int32_t z) const {
    std::vector<Middle> found;
    for (const UsedCorner& c : corners_[size_t(z)].used)
      for (int axis = 0; axis < 3; ++axis)
        if (edge_from(corner_at(c.place, size_t(z)), axis).is_parted)
          for (uint8_t pair = 0; pair < 2; ++pair) found.push_back({c.place, uint8_t(axis), pair});
    return found;
  }

  /// Of each layer those at corners, then those in the middles of edges.
  void number_vertices() {
    first_vertex_.assign(1, 0);
    for (size_t z = 0; z < corners_.size(); ++z)
      first_vertex_.push_back(first_vertex_.back() + corners_[z].vertices + middles_[z].size());
    if (first_vertex_.back() >= kNone / 4)
      throw Error(ErrorCode::out_of_memory, "read",
                  "the walls between labels have " + std::to_string(first_vertex_.back()) + " corners; at most " +
                      std::to_string(kNone / 4) + " can be numbered: make the volume coarser");
  }

  bool is_thin_at(Voxel corner) const {
    for (int o = 0; o < 8; ++o) {
      const Voxel v{corner.x - 1 + (o & 1), corner.y - 1 + (o >> 1 & 1), corner.z - 1 + (o >> 2 & 1)};
      const int32_t own = labels_.at(v);
      for (int axis = 0; axis < 3; ++axis) {
        const std::array<int32_t, 2> sides{labels_.at(stepped(v, axis, -1)), labels_.at(stepped(v, axis, 1))};
        if (sides[0] != own && sides[1] != own && !is_end_of_wedge(v, axis, sides)) return true;
      }
    }
    return false;
  }
  /// Whether the regions on the two sides of a voxel meet beside it.
  bool is_end_of_wedge(Voxel v, int axis, const std::array<int32_t, 2>& sides) const {
    if (sides[0] == sides[1]) return false;
    for (int across = 1; across < 3; ++across)
      for (const int step : {-1, 1}) {
        const int32_t beside = labels_.at(stepped(v, (axis + across) % 3, step));
        if (beside == sides[0] || beside == sides[1]) return true;
      }
    return false;
  }
  void mark_thin(size_t z, std::vector<uint8_t>& is_thin) const {
    size_t next = first_vertex_[z];
    for (const UsedCorner& c : corners_[z].used) {
      const bool thin = is_thin_at(corner_at(c.place, z));
      for (int s = 0; s < c.walls.sheets; ++s) is_thin[next++] = thin;
    }
    for (size_t m = 0; m < middles_[z].size(); ++m) is_thin[next++] = 1;
  }

  /// A periodic volume ends at the centres of its first and last layers, so vertices at their outer corners, and in the
  /// middles of their edges, are squeezed into their inner halves.
  int32_t quarters(int axis, int32_t halves) const {
    const int32_t end = 2 * labels_.size(axis);
    if (!labels_.is_periodic(axis)) return 2 * halves;
    return std::clamp(2 * halves, halves + 2, halves + end - 2);
  }
  Voxel quarters(Voxel halves) const { return {quarters(0, halves.x), quarters(1, halves.y), quarters(2, halves.z)}; }
  /// `halves` of voxels times the size of the volume.
  Voxel side_quarters(int32_t halves) const {
    return quarters(Voxel{halves * labels_.size(0), halves * labels_.size(1), halves * labels_.size(2)});
  }
  void place_vertices(size_t z, std::vector<Voxel>& rest_quarters) const {
    size_t next = first_vertex_[z];
    for (const UsedCorner& c : corners_[z].used) {
      const Voxel at = corner_at(c.place, z);
      for (int s = 0; s < c.walls.sheets; ++s) rest_quarters[next++] = quarters({2 * at.x, 2 * at.y, 2 * at.z});
    }
    for (const Middle& m : middles_[z]) {
      const Voxel at = corner_at(m.place, z);
      rest_quarters[next++] = quarters(stepped({2 * at.x, 2 * at.y, 2 * at.z}, m.axis, 1));
    }
  }

  /// The vertex of a face at its corner that lies so on it: `octant` is that of the face's nearer voxel there.
  uint32_t vertex_at(Voxel corner, int octant, int axis) const {
    const UsedCorner& used = corners_[size_t(corner.z)].at(corner.y, place_of(corner));
    return uint32_t(first_vertex_[size_t(corner.z)]) + used.first +
           used.walls.sheet_of_arc[size_t(arc_of(octant, axis))];
  }
  uint32_t middle_at(Voxel corner, int axis, int pair) const {
    const size_t z = size_t(corner.z);
    const Middle middle{place_of(corner), uint8_t(axis), uint8_t(pair)};
    const auto at = std::lower_bound(middles_[z].begin(), middles_[z].end(), middle) - middles_[z].begin();
    return uint32_t(first_vertex_[z] + corners_[z].vertices + size_t(at));
  }

  /// The face at the near side of a voxel along an axis, from its corner nearest to the origin around the axis.
  std::vector<uint32_t> polygon_of(Voxel voxel, int axis) const {
    const int u = (axis + 1) % 3, v = (axis + 2) % 3;
    const Voxel corner[4] = {voxel, stepped(voxel, u, 1), stepped(stepped(voxel, u, 1), v, 1), stepped(voxel, v, 1)};
    const int octant[4] = {1 << u | 1 << v, 1 << v, 0, 1 << u};
    // Which wall of its lattice edges the face is: those run along u from corners 0 and 3, along v from 1 and 0.
    const struct {
      int from, along, wall;
    } edge[4] = {{0, u, wall_beside(axis, u, true)},
                 {1, v, wall_beside(axis, v, false)},
                 {3, u, wall_beside(axis, u, false)},
                 {0, v, wall_beside(axis, v, true)}};
    std::vector<uint32_t> polygon;
    polygon.reserve(8);
    for (int i = 0; i < 4; ++i) {
      polygon.push_back(vertex_at(corner[i], octant[i], axis));
      const Voxel from = corner[edge[i].from];
      const WallEdge walls = edge_from(from, edge[i].along);
      if (walls.is_parted) polygon.push_back(middle_at(from, edge[i].along, walls.pair_of(edge[i].wall)));
    }
    return polygon;
  }

  /// Which wall around a lattice edge is the face that stands on `axis` and lies beside the edge along its third axis,
  /// on the far side of it or on the near one. Voxels around the edge are, in turn, (0, 0), (1, 0), (1, 1) and (0, 1)
  /// along the two axes that follow the edge's.
  static int wall_beside(int axis, int edge_axis, bool is_far) {
    if (axis == (edge_axis + 1) % 3) return is_far ? 2 : 0;  // between voxels that differ along the first of the two
    return is_far ? 1 : 3;
  }

  void add_face(Voxel voxel, int axis, LabelWalls& out) const {
    const int32_t near = labels_.at(stepped(voxel, axis, -1)), far = labels_.at(voxel),
                  background = labels_.background();
    std::vector<uint32_t> polygon = polygon_of(voxel, axis);  // as seen from the far side
    std::array<int32_t, 2> label{near, far};
    if (near == background || (far != background && far < near)) {
      std::reverse(polygon.begin(), polygon.end());
      label = {far, near};
    }
    add_polygon(std::move(polygon), out.faces);
    out.labels.resize(out.faces.size(), label);
    if (labels_.has_crossings()) out.crossed.resize(out.faces.size(), 3 * labels_.number_of(voxel) + axis);
  }
  void add_polygon(std::vector<uint32_t> polygon, std::vector<std::array<uint32_t, 4>>& faces) const {
    if (polygon.size() == 4) {
      faces.push_back({polygon[0], polygon[1], polygon[2], polygon[3]});
      return;
    }
    // Around a vertex in the middle of an edge: no triangle then has that edge's two ends, which the other pair has.
    const auto is_middle = [&](uint32_t v) { return is_middle_vertex(v); };
    std::rotate(polygon.begin(), std::find_if(polygon.begin(), polygon.end(), is_middle), polygon.end());
    for (size_t i = 1; i + 1 < polygon.size(); ++i) faces.push_back({polygon[0], polygon[i], polygon[i + 1], kNone});
  }
  bool is_middle_vertex(uint32_t vertex) const {
    const size_t z =
        size_t(std::upper_bound(first_vertex_.begin(), first_vertex_.end(), size_t(vertex)) - first_vertex_.begin()) -
        1;
    return vertex >= first_vertex_[z] + corners_[z].vertices;
  }

  /// Of the voxels of one z, and of those beyond the array.
  LabelWalls faces_of(int32_t z) const {
    LabelWalls out;
    for (int32_t y = 0; y <= labels_.size(1); ++y) {
      const int32_t* const row = labels_.row(y, z);
      const int32_t* const beside[2] = {labels_.row(y - 1, z), labels_.row(y, z - 1)};
      const bool is_beyond[2] = {y == labels_.size(1), z == labels_.size(2)};
      int32_t near = labels_.background();
      for (int32_t x = 0; x < labels_.size(0); ++x) {
        const int32_t far = row[x];
        if (near != far) add_face({x, y, z}, 0, out);
        if (beside[0][x] != far && !is_beyond[1]) add_face({x, y, z}, 1, out);
        if (beside[1][x] != far && !is_beyond[0]) add_face({x, y, z}, 2, out);
        near = far;
      }
      if (near != labels_.background()) add_face({labels_.size(0), y, z}, 0, out);
    }
    return out;
  }

  LabelRows labels_;
  const Context& context_;
  std::vector<CornerLayer> corners_;
  std::vector<std::vector<Middle>> middles_;  ///< per layer of corners, ascending
  std::vector<size_t> first_vertex_;          ///< per layer, and one more
};

}  // namespace

std::vector<PointQ8> LabelWalls::at_rest() const {
  constexpr int32_t kQuarter = kOneVoxelQ8 / 4;
  std::vector<PointQ8> out(rest_quarters.size());
  for_each_index(size_t(0), out.size(), [&](size_t v) {
    const Voxel& q = rest_quarters[v];
    out[v] = {q.x * kQuarter, q.y * kQuarter, q.z * kQuarter};
  });
  return out;
}

uint8_t LabelWalls::side_of(size_t face) const {
  const auto are_all = [&](int32_t Voxel::*axis, int32_t at) {
    return std::all_of(faces[face].begin(), faces[face].end(),
                       [&](uint32_t v) { return v == kNone || rest_quarters[v].*axis == at; });
  };
  uint8_t side = 1;
  for (const auto axis : {&Voxel::x, &Voxel::y, &Voxel::z})
    for (const int32_t at : {low_quarters.*axis, high_quarters.*axis}) {
      if (are_all(axis, at)) return side;
      ++side;
    }
  return 0;
}

LabelWalls find_label_walls(const LabelVolume& volume, const Context& context) {
  LabelWalls walls = WallMaker(volume, context).make();
  tie_sides(volume.is_periodic, walls);
  return walls;
}

}  // namespace isoshell
