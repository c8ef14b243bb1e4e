#include "implicit/volumes/crease_vertices.h"

#include <algorithm>

#include "core/index_sets.h"
#include "core/parallel_ranges.h"
#include "geometry/world_vector.h"
#include "implicit/volumes/least_squares_point.h"
#include "implicit/volumes/tile_borders.h"

namespace isoshell {
namespace {

constexpr double kLeastTurn = 0.94;        // cosine: sides that turn by less than 20 degrees have no crease
constexpr double kSameSide = 0.98;         // cosine: planes of one side count as one, however many crossings it has
constexpr double kLeastEigenvalue = 0.02;  // of the largest: two sides that turn by 20 degrees have .03
constexpr double kMostOutside = 1;         // voxels from the cell
constexpr double kFarthestSlide = 1;       // voxels
constexpr double kLeastUpright = 0.1;      // cosine between a triangle and the sides of its crossings
constexpr double kNarrow = 0.03;           // voxels: triangles this low may lean, which no one sees
constexpr int kEvenRounds = 4;
constexpr uint32_t kShortest = 8;  // vertices that follow each other

struct Loop {
  const int8_t* edge;
  int size;
  int8_t at(int i) const { return edge[i % size]; }
};
Loop loop_of(const CreaseVertex& v) {
  const IsoCase& loops = kIsoCases.of[v.inside];
  const int8_t* edge = loops.edge;
  for (int l = 0; l < v.loop; ++l) edge += loops.size[l];
  return {edge, loops.size[v.loop]};
}

/// Coordinate of a corner of a cell along an axis.
int corner_at(int corner, int axis) { return corner >> (2 - axis) & 1; }

/// The face that two edges of a cell have in common.
struct CellFace {
  int axis, side;
};
CellFace common_face(int a, int b) {
  for (int axis = 0; axis < 3; ++axis) {
    if (axis == a >> 2 || axis == b >> 2) continue;
    const int side = corner_at(edge_corner(a), axis);
    if (side == corner_at(edge_corner(b), axis)) return {axis, side};
  }
  return {-1, 0};  // no two edges of a loop that follow each other
}

/// An edge of a cell's face as one of the cell beyond it.
int edge_beyond(int edge, int axis) {
  const int corner = edge_corner(edge) ^ 4 >> axis;
  return edge_between(corner, corner | 4 >> (edge >> 2));
}

/// How often a loop passes a face of its cell: twice at most, where corners alternate.
int passes(Loop loop, CellFace face) {
  int count = 0;
  for (int i = 0; i < loop.size; ++i) {
    const CellFace f = common_face(loop.at(i), loop.at(i + 1));
    count += f.axis == face.axis && f.side == face.side;
  }
  return count;
}

double outside_of_cell(int offset, const WorldPoint& p) {
  const double x = p.x - (offset >> 6), y = p.y - (offset >> 3 & 7), z = p.z - (offset & 7);
  return std::max({0., -x, -y, -z, x - 1, y - 1, z - 1});
}

/// How far a vertex may slide along its crease, `slide` at best, to be no more than `outside` out of its cell; 0 where
/// it is that nowhere.
double near_cell(const CreaseVertex& v, double slide, double outside) {
  const double low[3] = {double(v.offset >> 6), double(v.offset >> 3 & 7), double(v.offset & 7)};
  const double at[3] = {v.choice[0].x, v.choice[0].y, v.choice[0].z}, along[3] = {v.along.x, v.along.y, v.along.z};
  double least = -kFarthestSlide, most = kFarthestSlide;
  for (int a = 0; a < 3; ++a) {
    const double to_low = low[a] - outside - at[a], to_high = low[a] + 1 + outside - at[a];
    if (along[a] == 0) {
      if (to_low > 0 || to_high < 0) return 0;
      continue;
    }
    least = std::max(least, std::min(to_low / along[a], to_high / along[a]));
    most = std::min(most, std::max(to_low / along[a], to_high / along[a]));
  }
  return least <= most ? std::clamp(slide, least, most) : 0;
}

WorldPoint from_origin(Voxel from, Voxel to) {
  return {double(to.x) - from.x, double(to.y) - from.y, double(to.z) - from.z};
}

}  // namespace

Creases::Creases(const ScalarField& field, Inside inside, double rise, const std::vector<Voxel>& blocks)
    : blocks_(blocks), crossings_(blocks.size()), vertices_(blocks.size()) {
  for_each_index(size_t(0), blocks.size(),
                 [&](size_t b) { crossings_[b] = find_crease_crossings(field, inside, rise, blocks[b]); });
  for_each_index(size_t(0), blocks.size(), [&](size_t b) { vertices_[b] = find_vertices(field, inside, b); });
  even_out();
  undo_inversions();
  drop_short();
  undo_inversions();
  forget_given_up();
}

void Creases::forget_given_up() {
  for (std::vector<CreaseVertex>& of_block : vertices_) {
    const auto is_given_up = [](const CreaseVertex& v) { return v.place == CreaseVertex::none; };
    of_block.erase(std::remove_if(of_block.begin(), of_block.end(), is_given_up), of_block.end());
  }
}

size_t Creases::block_at(Voxel origin) const {
  const auto found = std::lower_bound(blocks_.begin(), blocks_.end(), origin, comes_before);
  return found != blocks_.end() && *found == origin ? size_t(found - blocks_.begin()) : blocks_.size();
}

const CreaseCrossing* Creases::crossing(size_t block, int axis, int offset) const {
  const auto edge = uint16_t(axis << 9 | offset);
  const auto found = std::lower_bound(crossings_[block].begin(), crossings_[block].end(), edge,
                                      [](const CreaseCrossing& c, uint16_t e) { return c.edge < e; });
  return found != crossings_[block].end() && found->edge == edge ? &*found : nullptr;
}

CreaseVertexId Creases::vertex(size_t block, int offset, int loop) const {
  const auto found = std::lower_bound(vertices_[block].begin(), vertices_[block].end(), offset << 2 | loop,
                                      [](const CreaseVertex& v, int key) { return (v.offset << 2 | v.loop) < key; });
  if (found == vertices_[block].end() || found->offset != offset || found->loop != loop) return {};
  if (found->place == CreaseVertex::none) return {};
  return {uint32_t(block), uint32_t(found - vertices_[block].begin())};
}

Creases::LocalCrossing Creases::local_crossing(size_t block, int offset, int edge) const {
  const int corner = edge_corner(edge), axis = edge >> 2;
  const int p[3] = {(offset >> 6) + corner_at(corner, 0), (offset >> 3 & 7) + corner_at(corner, 1),
                    (offset & 7) + corner_at(corner, 2)};
  const int beside = (p[0] >> 3) << 2 | (p[1] >> 3) << 1 | p[2] >> 3;
  const Voxel step = block_beside({0, 0, 0}, beside, kFieldBlock);
  const Voxel origin = blocks_[block];
  const size_t owner = beside == 0 ? block : block_at(plus(origin, step.x, step.y, step.z));
  const CreaseCrossing* c = crossing(owner, axis, (p[0] & 7) << 6 | (p[1] & 7) << 3 | (p[2] & 7));
  if (!c) return {nullptr, {}, 0};
  const WorldPoint at{p[0] + (axis == 0 ? c->place : 0), p[1] + (axis == 1 ? c->place : 0),
                      p[2] + (axis == 2 ? c->place : 0)};
  return {c, at, c->height + dot(c->normal, {double(step.x), double(step.y), double(step.z)})};
}

std::vector<CreaseVertex> Creases::find_vertices(const ScalarField& field, Inside inside, size_t block) const {
  std::vector<CreaseVertex> found;
  if (!is_near_crease(block)) return found;
  float window[kWindow * kWindow * kWindow];
  read_cell_window(field, blocks_[block], window);
  each_cut_cell(window, inside, [&](int offset, const float*, int corners_inside) {
    const Voxel cell = plus(blocks_[block], offset >> 6, offset >> 3 & 7, offset & 7);
    if (field.sides && !field.sides->hold_cell(cell)) return;
    for (int l = 0; l < kIsoCases.of[corners_inside].loops; ++l) {
      CreaseVertex v{uint16_t(offset), uint8_t(l), uint8_t(corners_inside), CreaseVertex::best, {}, {}};
      if (place_vertex(block, v)) found.push_back(v);
    }
  });
  return found;
}

/// Whether a cell of the block may have an edge that is.
bool Creases::is_near_crease(size_t block) const {
  for (int n = 0; n < 8; ++n) {
    const size_t owner = block_at(block_beside(blocks_[block], n, kFieldBlock));
    if (owner < blocks_.size() && !crossings_[owner].empty()) return true;
  }
  return false;
}

/// Where the sides of a patch meet; false for one without a crease.
bool Creases::place_vertex(size_t block, CreaseVertex& vertex) const {
  const Loop loop = loop_of(vertex);
  std::vector<WeightedPlane> planes;
  WorldPoint sum{0, 0, 0};
  for (int i = 0; i < loop.size; ++i) {
    const LocalCrossing c = local_crossing(block, vertex.offset, loop.edge[i]);
    if (!c.crossing) return false;
    sum = sum + c.at;
    if (c.crossing->has_plane) planes.push_back({c.crossing->normal, c.height, 0});
  }
  double most_turned = 1;
  for (WeightedPlane& p : planes) {
    int same = 0;
    for (const WeightedPlane& q : planes) {
      const double cosine = dot(p.normal, q.normal);
      most_turned = std::min(most_turned, cosine);
      same += cosine > kSameSide;
    }
    p.weight = 1. / same;
  }
  if (most_turned > kLeastTurn) return false;
  const WorldPoint middle = (1. / loop.size) * sum;
  const auto [best, along] = least_squares_point(planes, middle, kLeastEigenvalue);
  vertex.along = along;
  vertex.choice[0] = best;
  const WorldPoint at = best + near_cell(vertex, 0, 0) * along;
  const double low[3] = {double(vertex.offset >> 6), double(vertex.offset >> 3 & 7), double(vertex.offset & 7)};
  const double place[3] = {at.x, at.y, at.z};
  double nearest[3];
  for (int a = 0; a < 3; ++a) {
    nearest[a] = std::clamp(place[a], low[a] + kEdgeEnd, low[a] + 1 - kEdgeEnd);
  }
  vertex.choice[0] = at;
  vertex.choice[1] = {nearest[0], nearest[1], nearest[2]};
  if (!(outside_of_cell(vertex.offset, at) <= kMostOutside)) vertex.place = CreaseVertex::in_cell;
  return true;
}

CreaseVertexId Creases::beyond(CreaseVertexId id, int i) const {
  const CreaseVertex& v = (*this)[id];
  const Loop loop = loop_of(v);
  const int a = loop.at(i), b = loop.at(i + 1);
  const CellFace face = common_face(a, b);
  const CreaseCrossing *first = local_crossing(id.block, v.offset, a).crossing,
                       *second = local_crossing(id.block, v.offset, b).crossing;
  if (!first->has_plane || !second->has_plane || dot(first->normal, second->normal) > kLeastTurn) return {};
  int p[3] = {v.offset >> 6, v.offset >> 3 & 7, v.offset & 7};
  p[face.axis] += face.side ? 1 : -1;
  size_t block = id.block;
  if (p[face.axis] < 0 || p[face.axis] > 7) {
    int32_t step[3] = {};
    step[face.axis] = face.side ? kFieldBlock : -kFieldBlock;
    block = block_at(plus(blocks_[block], step[0], step[1], step[2]));
    if (block == blocks_.size()) return {};
  }
  const int offset = (p[0] & 7) << 6 | (p[1] & 7) << 3 | (p[2] & 7);
  const int a_there = edge_beyond(a, face.axis), b_there = edge_beyond(b, face.axis);
  for (int l = 0; l < 4; ++l) {
    const CreaseVertexId other = vertex(block, offset, l);
    if (!other) continue;
    const Loop there = loop_of((*this)[other]);
    for (int j = 0; j < there.size; ++j)
      if (there.at(j) == b_there && there.at(j + 1) == a_there) {
        const bool is_twice = passes(loop, face) == 2 && passes(there, {face.axis, 1 - face.side}) == 2;
        return is_twice ? CreaseVertexId{} : other;  // an edge of four triangles
      }
  }
  return {};
}

bool Creases::turns_over(CreaseVertexId id) const {
  const CreaseVertex& v = (*this)[id];
  const Loop loop = loop_of(v);
  for (int i = 0; i < loop.size; ++i) {
    const LocalCrossing a = local_crossing(id.block, v.offset, loop.at(i));
    const LocalCrossing b = local_crossing(id.block, v.offset, loop.at(i + 1));
    const CreaseVertexId other = beyond(id, i);
    const WorldPoint third = other ? (*this)[other].at() + from_origin(blocks_[id.block], blocks_[other.block]) : b.at;
    const WorldPoint area = doubled_area(v.at(), a.at, third);
    const WorldPoint side = other ? a.crossing->normal : a.crossing->normal + b.crossing->normal;
    const double longest_sq =
        std::max({distance_sq(v.at(), a.at), distance_sq(a.at, third), distance_sq(third, v.at())});
    const bool is_narrow = length_sq(area) <= kNarrow * kNarrow * longest_sq;
    if (!is_narrow && dot(area, side) < kLeastUpright * length(area) * length(side)) return true;
  }
  return false;
}

template <class Visit>
void Creases::each_vertex(Visit visit) const {
  for_each_index(size_t(0), vertices_.size(), [&](size_t b) {
    for (size_t i = 0; i < vertices_[b].size(); ++i)
      if (vertices_[b][i].place != CreaseVertex::none) visit(CreaseVertexId{uint32_t(b), uint32_t(i)});
  });
}

/// Vertices slide along their crease to the middle of their neighbours on it: where a crease just leaves a cell, those
/// of the cells around may lie on it in another order than their cells.
void Creases::even_out() {
  std::vector<std::vector<WorldPoint>> to(vertices_.size());
  for (int round = 0; round < kEvenRounds; ++round) {
    for_each_index(size_t(0), vertices_.size(), [&](size_t b) {
      to[b].resize(vertices_[b].size());
      for (size_t i = 0; i < to[b].size(); ++i) to[b][i] = evened({uint32_t(b), uint32_t(i)});
    });
    for_each_index(size_t(0), vertices_.size(), [&](size_t b) {
      for (size_t i = 0; i < to[b].size(); ++i) vertices_[b][i].choice[0] = to[b][i];
    });
  }
}

WorldPoint Creases::evened(CreaseVertexId id) const {
  const CreaseVertex& v = (*this)[id];
  WorldPoint sum{0, 0, 0};
  int neighbours = 0;
  for (int i = 0; i < loop_of(v).size; ++i) {
    const CreaseVertexId other = beyond(id, i);
    if (!other) continue;
    sum = sum + (*this)[other].choice[0] + from_origin(blocks_[id.block], blocks_[other.block]) - v.choice[0];
    ++neighbours;
  }
  if (neighbours != 2) return v.choice[0];
  const double outside = outside_of_cell(v.offset, v.choice[0]);
  return v.choice[0] + near_cell(v, dot(sum, v.along) / 2, outside) * v.along;
}

/// Takes vertices back until no triangle turns over: each has two steps, so that ends. Returns their cells.
std::vector<Voxel> Creases::undo_inversions() {
  std::vector<Voxel> cells;
  for (;;) {
    std::vector<std::vector<uint32_t>> turned(vertices_.size());
    each_vertex([&](CreaseVertexId id) {
      if (turns_over(id)) turned[id.block].push_back(id.number);
    });
    keep_nearer(turned);
    const size_t before = cells.size();
    for (size_t b = 0; b < turned.size(); ++b)
      for (const uint32_t i : turned[b]) cells.push_back(take_back({uint32_t(b), i}));
    if (cells.size() == before) return cells;
  }
}

/// Returns the vertex's cell.
Voxel Creases::take_back(CreaseVertexId id) {
  CreaseVertex& v = vertices_[id.block][id.number];
  v.place = CreaseVertex::Place(v.place + 1);
  return plus(blocks_[id.block], v.offset >> 6, v.offset >> 3 & 7, v.offset & 7);
}

/// Of two that share an edge only the one goes that is farther from where it would be otherwise: the other may do then.
void Creases::keep_nearer(std::vector<std::vector<uint32_t>>& turned) const {
  std::vector<std::vector<uint32_t>> farther(turned.size());
  for_each_index(size_t(0), turned.size(), [&](size_t b) {
    for (const uint32_t i : turned[b])
      if (is_farthest({uint32_t(b), i}, turned)) farther[b].push_back(i);
  });
  turned = std::move(farther);
}

bool Creases::is_farthest(CreaseVertexId id, const std::vector<std::vector<uint32_t>>& turned) const {
  const CreaseVertex& v = (*this)[id];
  const double far = distance_sq(v.at(), v.choice[1]);
  for (int i = 0; i < loop_of(v).size; ++i) {
    const CreaseVertexId other = beyond(id, i);
    if (!other || !std::binary_search(turned[other.block].begin(), turned[other.block].end(), other.number)) continue;
    const CreaseVertex& w = (*this)[other];
    const double far_there = distance_sq(w.at(), w.choice[1]);
    if (far_there > far || (far_there == far && std::pair(other.block, other.number) < std::pair(id.block, id.number)))
      return false;
  }
  return true;
}

std::vector<Voxel> Creases::take_back(const std::vector<CreaseVertexId>& which) {
  std::vector<Voxel> cells;
  for (const CreaseVertexId id : which) cells.push_back(take_back(id));
  const std::vector<Voxel> then = undo_inversions();
  cells.insert(cells.end(), then.begin(), then.end());
  forget_given_up();
  return cells;
}

void Creases::drop_short() {
  std::vector<uint32_t> first(vertices_.size() + 1, 0);
  for (size_t b = 0; b < vertices_.size(); ++b) first[b + 1] = first[b] + uint32_t(vertices_[b].size());
  IndexSets sets(int64_t(first.back()));
  each_vertex([&](CreaseVertexId id) {
    for (int i = 0; i < loop_of((*this)[id]).size; ++i)
      if (const CreaseVertexId other = beyond(id, i))
        sets.unite(first[id.block] + id.number, first[other.block] + other.number);
  });
  std::vector<uint32_t> members(first.back(), 0);
  for (uint32_t i = 0; i < first.back(); ++i) ++members[sets.root(i)];
  for (size_t b = 0; b < vertices_.size(); ++b)
    for (size_t i = 0; i < vertices_[b].size(); ++i)
      if (members[sets.root(first[b] + uint32_t(i))] < kShortest) vertices_[b][i].place = CreaseVertex::none;
}

}  // namespace isoshell
