// Marching cubes block by block: count what each block owns, then write vertices, then triangles to their places.
#include "implicit/volumes/iso_surface.h"

#include <tbb/parallel_sort.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>

#include "core/parallel_ranges.h"
#include "geometry/make_one.h"
#include "geometry/world_vector.h"
#include "implicit/volumes/cell_blocks.h"
#include "implicit/volumes/crease_intersections.h"
#include "implicit/volumes/crease_vertices.h"
#include "implicit/volumes/field_sharpness.h"
#include "implicit/volumes/sharpened_field.h"
#include "implicit/volumes/tile_borders.h"
#include "io/faces/face_collector.h"
#include "isoshell/error.h"
#include "voxel/leaf.h"

namespace isoshell {
namespace {

constexpr double kMargin = 1e-4;  // voxels: sides along the lattice have values of both signs, by rounding
constexpr int kCentreLoop = 6;    // patches of as many corners get a vertex in their middle: they can meet
                                  // a face of the cell twice, where a diagonal might be the neighbour's too

void sort_unique(std::vector<Voxel>& voxels) {
  tbb::parallel_sort(voxels.begin(), voxels.end(), comes_before);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
}

class IsoSurface {
 public:
  IsoSurface(const ScalarField& field, double iso, int64_t memory_limit_bytes, VolumeCreases creases)
      : field_(field),
        wanted_(creases),
        memory_limit_bytes_(memory_limit_bytes > 0 ? memory_limit_bytes : INT64_MAX),
        inside_(inside_of(field, iso)) {}

  TriangleSoup extract(UnknownValues& unknown) {
    list_cell_blocks();
    const std::unique_ptr<ScalarField> continued = field_.continued();
    const ScalarField& sloping = continued ? *continued : field_;
    // Distances are not those of index coordinates where voxels are no cubes.
    if (wanted_ != VolumeCreases::none && cube_edge(field_.to_world) > 0) rise_ = usual_rise(sloping, inside_, origin_);
    count();
    unknown = unknown_values();
    if (rise_ > 0 && unknown.cells == 0 && (wanted_ == VolumeCreases::all || is_sharp(bent_))) {
      inside_.margin = kMargin * rise_;
      sharpened_.emplace(sloping, inside_, rise_, origin_);
      creases_.emplace(*sharpened_, inside_, rise_, origin_);
      count();
    }
    TriangleSoup soup = write();
    if (creases_) take_intersecting_back(soup);
    const auto same = same_at_sides(field_, origin_, cell_);
    const bool is_open = unknown.cells + unknown.values > 0 || (field_.sides && !field_.sides->are_closed);
    if (is_open || !same.empty()) make_one(soup, same);
    return soup;
  }

 private:
  void take_intersecting_back(TriangleSoup& soup) {
    for (std::optional<std::vector<Voxel>> moved; take_intersecting_back(soup, moved);) {
      count();
      soup = write();
    }
    for_each_index(size_t(0), soup.vertices.size(), [&](size_t v) { soup.vertices[v] = mapped(soup.vertices[v]); });
  }

  void count() {
    cell_.assign(origin_.size(), {});
    bent_.assign(rise_ > 0 && !creases_ ? origin_.size() : 0, {});
    each_block([&](size_t b, const float* window) { count(b, window); });
  }

  TriangleSoup write() {
    TriangleSoup soup;
    make_room(soup);
    each_block([&](size_t b, const float* window) { write_edges(b, window, soup); });
    each_block([&](size_t b, const float* window) { write_patches(b, window, soup); });
    return soup;
  }

  /// Whether vertices of creases were taken back because their triangles intersect. Each can be so twice, then cells
  /// are as without creases, where nothing intersects. Looks beside cells whose vertices moved, and at first anywhere.
  bool take_intersecting_back(const TriangleSoup& soup, std::optional<std::vector<Voxel>>& moved) {
    std::vector<uint8_t> is_crease(soup.vertices.size(), 0);
    for (size_t b = 0; b < cell_.size(); ++b)
      for (int64_t i = 0; i < crease_vertices(b); ++i) is_crease[size_t(first_crease_vertex(b) + i)] = 1;
    const std::vector<uint32_t> found = find_intersecting(soup, is_crease, moved ? &*moved : nullptr);
    std::vector<CreaseVertexId> ids;
    auto next = found.begin();
    for (size_t b = 0; b < cell_.size(); ++b)
      for (; next != found.end() && *next < first_crease_vertex(b) + crease_vertices(b); ++next)
        ids.push_back({uint32_t(b), uint32_t(*next - first_crease_vertex(b))});
    if (!ids.empty()) moved = creases_->take_back(ids);
    return !ids.empty();
  }

  /// Blocks whose cells touch a voxel with a value of its own, or lie where tiles of the two sides meet.
  void list_cell_blocks() {
    std::vector<Voxel> held = field_.blocks();
    for (const Voxel& block : held) check_reach(field_, block);
    for (const FieldTile& tile : field_.tiles()) check_reach(field_, tile.origin);
    sort_unique(held);
    const int64_t most = memory_limit_bytes_ / int64_t(8 * sizeof(Voxel));
    const std::vector<Voxel> beside = blocks_beside_tiles(field_, inside_, held, most);
    held.insert(held.end(), beside.begin(), beside.end());
    sort_unique(held);
    origin_.resize(8 * held.size());
    for_each_index(size_t(0), held.size(), [&](size_t i) {
      for (int n = 0; n < 8; ++n) origin_[8 * i + size_t(n)] = block_beside(held[i], n, -kFieldBlock);
    });
    sort_unique(origin_);
    check_memory(int64_t(origin_.size() * (sizeof(Voxel) + sizeof(CellBlock))));
  }

  void check_memory(int64_t bytes) const {
    if (bytes > memory_limit_bytes_)
      throw Error(ErrorCode::out_of_memory, "memory",
                  field_.title() + ": extracting its surface takes " + std::to_string(bytes >> 20) +
                      " MiB, more than the limit of " + std::to_string(memory_limit_bytes_ >> 20) +
                      " MiB; resample it coarser or raise --max-memory");
  }

  template <class Work>
  void each_block(Work work) {
    for_each_index(size_t(0), origin_.size(), [&](size_t b) {
      float window[kWindow * kWindow * kWindow];
      read_cell_window(sharpened_ ? *sharpened_ : field_, origin_[b], window);
      if (sharpened_ && field_.sides) end_at_sides(origin_[b], window);
      work(b, window);
    });
  }

  void end_at_sides(Voxel origin, float* window) const {
    for (int x = 0; x < kWindow; ++x)
      for (int y = 0; y < kWindow; ++y)
        for (int z = 0; z < kWindow; ++z)
          if (!field_.sides->hold(plus(origin, x, y, z)))
            window[x * kWindowStride[0] + y * kWindowStride[1] + z] = float(field_.background);
  }

  bool jumps(const float* corner) const {
    return field_.most_rise > 0 && jumps_in_cell(corner, field_.most_rise, field_.background);
  }
  /// Whether a cell has triangles, whose smallest corner is given.
  bool is_known(Voxel cell, const float* corner) const {
    const bool is_at_side = field_.sides && !field_.sides->hold_cell(cell);
    if (is_at_side && !field_.sides->are_closed) return false;
    return !has_unknown(corner) && (is_at_side || !field_.opens_at_jumps || !jumps(corner));
  }
  /// Calls visit as each_cut_cell does, for cells in which the surface is known.
  template <class Points, class Visit>
  void each_known_cell(size_t b, const float* window, const Points& points, Visit visit) const {
    each_cut_cell(window, points, [&](int offset, const float* corner, int inside) {
      if (is_known(cell_at(b, offset), corner)) visit(offset, corner, inside);
    });
  }
  Voxel cell_at(size_t b, int offset) const { return plus(origin_[b], offset >> 6, offset >> 3 & 7, offset & 7); }

  void count(size_t b, const float* window) {
    CellBlock& cell = cell_[b];
    const InsidePoints inside(window, inside_);
    for (int offset = 0; offset < 512; ++offset) {
      const int at = window_index(offset);
      cell.unknown_values += std::isnan(window[at]) ? 1 : 0;
      for (int axis = 0; axis < 3; ++axis)
        cell.cut[axis][offset >> 6] |= uint64_t(inside.at[at] != inside.at[at + kWindowStride[axis]]) << (offset & 63);
    }
    for (const auto& axis : cell.cut)
      for (const uint64_t word : axis) cell.cuts += uint32_t(popcount64(word));
    each_cut_cell(window, inside, [&](int offset, const float* corner, int corners_inside) {
      const bool is_at_side = field_.sides && !field_.sides->hold_cell(cell_at(b, offset));
      ++cell.cells;
      cell.jumps += !is_at_side && jumps(corner) ? 1 : 0;
      if (!is_known(cell_at(b, offset), corner)) {
        if (!is_at_side && has_both_sides(corner, inside_) && cell.unknown_cells++ == 0) cell.first_unknown = offset;
        return;
      }
      if (rise_ > 0 && !creases_ && !is_at_side) bent_[b].add(corner, rise_);
      const IsoCase& loops = kIsoCases.of[corners_inside];
      for (int l = 0; l < loops.loops; ++l) {
        const bool crease = creases_ && creases_->vertex(b, offset, l), middle = loops.size[l] >= kCentreLoop;
        cell.middles += middle && !crease;
        cell.triangles += uint32_t(loops.size[l] - (middle || crease ? 0 : 2));
      }
    });
  }

  UnknownValues unknown_values() const {
    UnknownValues unknown;
    int64_t jumps = 0, cells = 0;
    for (size_t b = 0; b < cell_.size(); ++b) {
      unknown.values += cell_[b].unknown_values;
      if (unknown.cells == 0 && cell_[b].unknown_cells > 0) {
        const Voxel v = cell_at(b, cell_[b].first_unknown);
        unknown.first_world = mapped({v.x + .5, v.y + .5, v.z + .5});
      }
      unknown.cells += cell_[b].unknown_cells;
      jumps += cell_[b].jumps;
      cells += cell_[b].cells;
    }
    unknown.jumping_part = cells > 0 ? double(jumps) / double(cells) : 0;
    return unknown;
  }

  void make_room(TriangleSoup& soup) {
    int64_t vertices = 0, triangles = 0;
    for (size_t b = 0; b < cell_.size(); ++b) {
      CellBlock& cell = cell_[b];
      cell.first_vertex = vertices;
      cell.first_triangle = triangles;
      vertices += cell.cuts + crease_vertices(b) + cell.middles;
      triangles += cell.triangles;
    }
    if (triangles == 0) refuse_empty();
    if (vertices > kMaxSoupVertices || triangles > kMaxSoupVertices)
      throw Error(ErrorCode::out_of_memory, "read",
                  field_.title() + " has a surface of " + std::to_string(triangles) +
                      " triangles, more than 32-bit indices can name; resample it coarser");
    check_memory(int64_t(origin_.size() * (sizeof(Voxel) + sizeof(CellBlock))) +
                 vertices * int64_t(sizeof(WorldPoint)) + triangles * int64_t(sizeof(soup.triangles[0])));
    soup.vertices.resize(size_t(vertices));
    soup.triangles.resize(size_t(triangles));
    soup.faces_in_file = triangles;
  }

  [[noreturn]] void refuse_empty() const {
    const ValueRange range = value_range(field_);
    std::ostringstream text;
    text << field_.title() << " has no surface at the value " << inside_.iso << ": ";
    if (range.low == range.high)
      text << "all its values are " << range.low;
    else
      text << "its values are " << range.low << " to " << range.high << "; name one between them by --iso";
    throw Error(ErrorCode::nothing_to_mesh, "read", text.str());
  }

  void write_patches(size_t b, const float* window, TriangleSoup& soup) const {
    uint32_t owners[8];
    for (int n = 0; n < 8; ++n) {
      const auto found =
          std::lower_bound(origin_.begin(), origin_.end(), block_beside(origin_[b], n, kFieldBlock), comes_before);
      owners[n] = uint32_t(found - origin_.begin());  // only looked at where an edge begins there: then it is listed
    }
    int64_t middle = first_crease_vertex(b) + crease_vertices(b), triangle = cell_[b].first_triangle;
    each_known_cell(b, window, inside_, [&](int offset, const float*, int inside) {
      const IsoCase& loops = kIsoCases.of[inside];
      const int8_t* edge = loops.edge;
      for (int l = 0; l < loops.loops; edge += loops.size[l++]) {
        uint32_t vertex[12];
        for (int i = 0; i < loops.size[l]; ++i) vertex[i] = vertex_on(owners, offset, edge[i]);
        if (const CreaseVertexId crease = creases_ ? creases_->vertex(b, offset, l) : CreaseVertexId{}) {
          triangle += write_crease_patch(crease, vertex, loops.size[l], &soup.triangles[size_t(triangle)]);
          continue;
        }
        triangle += write_patch(vertex, loops.size[l], middle, &soup.triangles[size_t(triangle)]);
        if (loops.size[l] >= kCentreLoop) soup.vertices[size_t(middle++)] = middle_of(soup, vertex, loops.size[l]);
      }
    });
  }

  /// A fan around the first corner or around the middle. Returns its triangles.
  int write_patch(const uint32_t* vertex, int size, int64_t middle, std::array<uint32_t, 3>* to) const {
    if (size < kCentreLoop) {
      for (int i = 2; i < size; ++i) to[i - 2] = oriented(vertex[0], vertex[i - 1], vertex[i]);
      return size - 2;
    }
    for (int i = 0; i < size; ++i) to[i] = oriented(uint32_t(middle), vertex[i], vertex[(i + 1) % size]);
    return size;
  }
  /// A fan whose triangles share the crease's edges with the next patches, where there are some.
  int write_crease_patch(CreaseVertexId crease, const uint32_t* vertex, int size, std::array<uint32_t, 3>* to) const {
    for (int i = 0; i < size; ++i) {
      const CreaseVertexId next = creases_->beyond(crease, i);
      to[i] = oriented(index_of(crease), vertex[i], next ? index_of(next) : vertex[(i + 1) % size]);
    }
    return size;
  }
  int64_t first_crease_vertex(size_t b) const { return cell_[b].first_vertex + cell_[b].cuts; }
  int64_t crease_vertices(size_t b) const { return creases_ ? int64_t(creases_->vertices(b).size()) : 0; }
  uint32_t index_of(CreaseVertexId v) const { return uint32_t(first_crease_vertex(v.block) + v.number); }

  std::array<uint32_t, 3> oriented(uint32_t a, uint32_t b, uint32_t c) const {
    return mirrored_ ? std::array<uint32_t, 3>{a, c, b} : std::array<uint32_t, 3>{a, b, c};
  }

  uint32_t vertex_on(const uint32_t* owners, int offset, int edge) const {
    const int corner = edge_corner(edge);
    int x = (offset >> 6) + (corner >> 2), y = (offset >> 3 & 7) + (corner >> 1 & 1), z = (offset & 7) + (corner & 1);
    const CellBlock& owner = cell_[owners[(x >> 3) << 2 | (y >> 3) << 1 | z >> 3]];
    return uint32_t(owner.first_vertex) + owner.rank(edge >> 2, (x & 7) << 6 | (y & 7) << 3 | (z & 7));
  }

  void write_edges(size_t b, const float* window, TriangleSoup& soup) const {
    int64_t vertex = cell_[b].first_vertex;
    for (int axis = 0; axis < 3; ++axis)
      for (int word = 0; word < 8; ++word)
        for (uint64_t bits = cell_[b].cut[axis][word]; bits; bits &= bits - 1)
          soup.vertices[size_t(vertex++)] = to_world(crossing(b, window, word * 64 + lowest_bit(bits), axis));
    if (!creases_) return;
    for (const CreaseVertex& v : creases_->vertices(b)) {
      const WorldPoint& p = v.at();
      const Voxel& o = origin_[b];
      soup.vertices[size_t(vertex++)] = to_world({o.x + p.x, o.y + p.y, o.z + p.z});
    }
  }

  /// Where the edge from a corner along an axis crosses the surface, in index coordinates.
  WorldPoint crossing(size_t b, const float* window, int offset, int axis) const {
    const float* at = window + window_index(offset);
    const CreaseCrossing* beside_crease = creases_ ? creases_->crossing(b, axis, offset) : nullptr;
    double t = beside_crease ? beside_crease->place : crossing_on_edge(at[0], at[kWindowStride[axis]], inside_.iso);
    if (creases_) t = std::clamp(t, kCreaseEdgeEnd, 1 - kCreaseEdgeEnd);
    const Voxel o = cell_at(b, offset);
    if (field_.sides) t = field_.sides->kept_off_points(o, axis, t);
    if (const auto end = end_at_side(field_, o, axis)) t = *end == o ? 0 : 1;
    return {o.x + (axis == 0 ? t : 0), o.y + (axis == 1 ? t : 0), o.z + (axis == 2 ? t : 0)};
  }

  static WorldPoint middle_of(const TriangleSoup& soup, const uint32_t* vertex, int size) {
    WorldPoint sum{0, 0, 0};
    for (int i = 0; i < size; ++i) sum = sum + soup.vertices[vertex[i]];
    return {sum.x / size, sum.y / size, sum.z / size};
  }

  /// With creases, vertices are mapped when all are in their places.
  WorldPoint to_world(WorldPoint p) const { return creases_ ? p : mapped(p); }
  WorldPoint mapped(WorldPoint p) const {
    if (field_.sides) p = field_.sides->halved(p);
    const auto& m = field_.to_world.at;
    return {m[0][0] * p.x + m[0][1] * p.y + m[0][2] * p.z + m[0][3],
            m[1][0] * p.x + m[1][1] * p.y + m[1][2] * p.z + m[1][3],
            m[2][0] * p.x + m[2][1] * p.y + m[2][2] * p.z + m[2][3]};
  }
  static bool is_mirror(const AffineMap& map) {
    const auto& m = map.at;
    return m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) - m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
               m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
           0;
  }

  const ScalarField& field_;
  const VolumeCreases wanted_;
  const int64_t memory_limit_bytes_;
  Inside inside_;
  const bool mirrored_ = is_mirror(field_.to_world);
  std::vector<Voxel> origin_;    // of the blocks of cells, sorted
  std::vector<CellBlock> cell_;  // per block
  double rise_ = 0;              // of the field a voxel, where it may have creases
  std::vector<BentCells> bent_;  // per block, until creases are found
  std::optional<SharpenedField> sharpened_;
  std::optional<Creases> creases_;
};

}  // namespace

void check_reach(const ScalarField& field, Voxel v) {
  if (std::max({std::abs(int64_t(v.x)), std::abs(int64_t(v.y)), std::abs(int64_t(v.z))}) > kFieldReach)
    throw Error(ErrorCode::unreadable_input, "read",
                field.title() + " has values at (" + std::to_string(v.x) + ", " + std::to_string(v.y) + ", " +
                    std::to_string(v.z) + "), farther out than " + std::to_string(kFieldReach) + " voxels");
}

ValueRange value_range(const ScalarField& field) {
  ValueRange range{float(field.background), float(field.background), {}};
  const auto include = [&](float value) {
    if (value < range.low) range.low = value;
    if (value > range.high) range.high = value;
  };
  std::vector<float> window(size_t(kWindow) * kWindow * kWindow, range.low);
  const int all[3] = {kFieldBlock, kFieldBlock, kFieldBlock};
  for (const Voxel& block : field.blocks()) {
    field.copy(block, all, window.data());
    for (int i = 0; i < 512; ++i) {
      const float value = window[size_t(window_index(i))];
      if (std::isnan(value) && !range.unknown) range.unknown = plus(block, i >> 6, i >> 3 & 7, i & 7);
      include(value);
    }
  }
  for (const FieldTile& tile : field.tiles()) include(tile.value);
  return range;
}

TriangleSoup extract_iso_surface(const ScalarField& field, double iso, int64_t memory_limit_bytes,
                                 VolumeCreases creases, UnknownValues* unknown) {
  UnknownValues found;
  TriangleSoup soup = IsoSurface(field, iso, memory_limit_bytes, creases).extract(found);
  if (unknown) *unknown = found;
  return soup;
}

}  // namespace isoshell
