// Splitting one cell into two connected halves. Paper section 3.4.
#pragma once

#include "stages/dual/dual_cells_body.h"
#include "stages/dual/dual_faces_body.h"

namespace isoshell::dual {

/// What a split leaves for its second half.
struct Half {
  uint32_t seed_vertex;
  uint32_t size;
  int32_t euler;
};

/// Splits cell[i] between two sources that are far apart: the vertex farthest along edges from the one nearest to its
/// seed, and the vertex farthest from that; among those that touch the requested cell if one is, so that where two
/// cells meet twice, each half keeps one of the places. Of a fixed seed the first source are all its border vertices,
/// which are connected. Of equally far vertices the smallest is taken. A vertex goes to the source that is fewer edges
/// away within the cell, ties to the first; so both halves are connected. The one with the vertex nearest to the seed
/// keeps the seed, and the border. Writes marks only, so that all splits of a round read the same labels.
struct SplitCell {
  enum Mark : uint8_t { kClear, kSeen, kMeasured, kMeasuredAgain, kFirstHalf, kSecondHalf, kNewHalf };

  SheetGraph graph;
  View<const uint32_t> label, cell, request;
  View<const int64_t> first;  ///< offsets of the cells' places in queue
  View<const PointQ8> vertex_position, seed_position;
  CellsView cells;
  View<uint32_t> queue;
  View<uint8_t> mark;  ///< kClear outside the cells of the round, before and after
  View<Half> half;

  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t id = cell[i];
    const View<uint32_t> places = {queue.data + first[i], first[i + 1] - first[i]};
    const uint32_t kept = nearest_to_seed(id, places);
    int64_t sources = gather_sources(id, places, kept);
    uint8_t measured = kMeasured;
    if (!cells.is_fixed(id)) {
      places[0] = farthest(id, places, sources, request[id], measured);
      sources = 1;
      measured = kMeasuredAgain;
    }
    const uint32_t first_source = places[0];
    const uint32_t second_source = farthest(id, places, sources, request[id], measured);
    for (int64_t at = 0; at < sources; ++at) mark[places[at]] = kFirstHalf;
    places[sources] = second_source;
    mark[second_source] = kSecondHalf;
    // Within a level the queue holds the first half first, so ties go to it.
    spread(id, places, sources + 1, measured, [&](uint32_t from) { return mark[from]; });
    const bool keeps_first = mark[kept] == kFirstHalf;
    for (uint32_t v : places)
      if ((mark[v] == kFirstHalf) != keeps_first) mark[v] = kNewHalf;
    measure_halves(i, id, places);
    cells.root[id] = kept;
    half[i].seed_vertex = keeps_first ? second_source : first_source;
  }
  /// Of the half that stays.
  ISOSHELL_HD bool may_be_source(uint32_t id, uint32_t v) const { return !cells.is_fixed(id) || graph.is_on_border(v); }

 private:
  /// Breadth first over the vertices of the cell whose mark is `fresh`; each takes mark_from(its predecessor).
  /// Calls from the first `count` places; returns how many vertices the queue then holds.
  template <class MarkFrom>
  ISOSHELL_HD int64_t spread(uint32_t id, View<uint32_t> places, int64_t count, uint8_t fresh,
                             MarkFrom mark_from) const {
    for (int64_t at = 0; at < count; ++at) {
      const uint32_t v = places[at];
      graph.for_each_neighbour(v, [&](uint32_t w) {
        if (label[w] != id || mark[w] != fresh) return;
        mark[w] = mark_from(v);
        places[count++] = w;
      });
    }
    return count;
  }

  ISOSHELL_HD uint32_t nearest_to_seed(uint32_t id, View<uint32_t> places) const {
    places[0] = cells.root[id];
    mark[places[0]] = kSeen;
    spread(id, places, 1, kClear, [](uint32_t) { return uint8_t(kSeen); });
    int64_t nearest = INT64_MAX;
    uint32_t best = kNone;
    for (uint32_t v : places) {
      if (!may_be_source(id, v)) continue;
      const int64_t d = distance_sq_q16(vertex_position[v], seed_position[id]);
      if (d < nearest || (d == nearest && v < best)) nearest = d, best = v;
    }
    return best;
  }

  /// The first places become where distances begin; returns how many.
  ISOSHELL_HD int64_t gather_sources(uint32_t id, View<uint32_t> places, uint32_t kept) const {
    if (!cells.is_fixed(id)) {
      places[0] = kept;
      return 1;
    }
    int64_t count = 0;
    for (uint32_t v : places)
      if (graph.is_on_border(v)) places[count++] = v;
    return count;
  }

  ISOSHELL_HD bool touches(uint32_t v, uint32_t other) const {
    bool found = false;
    graph.for_each_neighbour(v, [&](uint32_t w) { found = found || label[w] == other; });
    return found;
  }

  /// From the first `sources` places; raises all marks by one, to `measured`.
  ISOSHELL_HD uint32_t farthest(uint32_t id, View<uint32_t> places, int64_t sources, uint32_t touching,
                                uint8_t measured) const {
    for (int64_t at = 0; at < sources; ++at) mark[places[at]] = measured;
    uint32_t anywhere = kNone, at_other = kNone;
    for (int64_t begin = 0, end = sources; begin < end;) {
      uint32_t level_anywhere = kNone, level_at_other = kNone;
      int64_t count = end;
      for (int64_t at = begin; at < end; ++at) {
        const uint32_t v = places[at];
        if (v < level_anywhere) level_anywhere = v;
        if (touching != kSplitAnywhere && at >= sources && v < level_at_other && touches(v, touching))
          level_at_other = v;
        graph.for_each_neighbour(v, [&](uint32_t w) {
          if (label[w] != id || mark[w] + 1 != measured) return;
          mark[w] = measured;
          places[count++] = w;
        });
      }
      anywhere = level_anywhere;
      if (level_at_other != kNone) at_other = level_at_other;
      begin = end;
      end = count;
    }
    return at_other != kNone ? at_other : anywhere;
  }

  /// Sizes and Euler numbers of both halves.
  ISOSHELL_HD void measure_halves(int64_t i, uint32_t id, View<uint32_t> places) const {
    uint32_t size[2] = {0, 0};
    int32_t euler[2] = {0, 0};
    for (uint32_t v : places) {
      const uint8_t side = mark[v];
      const int h = side == kNewHalf;
      ++size[h];
      ++euler[h];
      graph.for_each_corner(v, [&](uint32_t next, uint32_t last) {
        if (next < v || label[next] != id || mark[next] != side) return;
        --euler[h];
        if (last > v && label[last] == id && mark[last] == side) ++euler[h];
      });
      const uint32_t before = graph.is_on_border(v) ? graph.border_before[v] : 0;
      if (before > v && label[before] == id && mark[before] == side) --euler[h];
    }
    cells.size[id] = size[0];
    cells.euler[id] = euler[0];
    half[i].size = size[1];
    half[i].euler = euler[1];
  }
};

struct SizeOfRequested {
  View<const uint32_t> cell, size;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return size[cell[i]]; }
};

/// Gives the new half of split i to cell new_id[i].
struct ApplySplit {
  View<const uint32_t> new_id, queue;
  View<const int64_t> first;
  View<const Half> half;
  View<uint8_t> mark;
  View<uint32_t> label;
  CellsView cells;
  SeedWriter seeds;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t id = new_id[i];
    for (int64_t at = first[i]; at < first[i + 1]; ++at) {
      const uint32_t v = queue[at];
      if (mark[v] == SplitCell::kNewHalf) label[v] = id;
      mark[v] = SplitCell::kClear;
    }
    cells.root[id] = half[i].seed_vertex;
    cells.size[id] = half[i].size;
    cells.euler[id] = half[i].euler;
    seeds.put(id, half[i].seed_vertex);
  }
};

/// Sheet triangles that splits made to faces, found at the vertices of the cells that were split. Three labels stay
/// three, so no triangle ceases to be a face.
struct NewFaces {
  SheetGraph graph;
  View<const uint32_t> label, member, request;  ///< request: of the cells before the splits
  View<const uint32_t> origin;                  ///< of every cell: the one that it was split from, or itself

  template <class Visit>
  ISOSHELL_HD void for_each(int64_t at, Visit visit) const {
    const uint32_t v = member[at];
    for (int64_t n = graph.first[v]; n < graph.first[v + 1]; ++n) {
      const TriangleIndices t = graph.triangles[graph.incident[n]];
      const uint32_t a = label[t.a], b = label[t.b], c = label[t.c];
      if (a == b || b == c || c == a) continue;
      if ((t.a < v && is_split(a)) || (t.b < v && is_split(b)) || (t.c < v && is_split(c))) continue;  // found there
      const bool was_face = origin[a] != origin[b] && origin[b] != origin[c] && origin[c] != origin[a];
      if (!was_face) visit(graph.incident[n]);
    }
  }
  ISOSHELL_HD bool is_split(uint32_t id) const { return origin[id] < request.size && request[origin[id]] != kNoSplit; }
};
struct SetOrigin {
  View<const uint32_t> new_id, cell;
  View<uint32_t> origin;
  ISOSHELL_HD void operator()(int64_t i) const { origin[new_id[i]] = cell[i]; }
};
struct CountNewFaces {
  NewFaces faces;
  View<int64_t> count;
  ISOSHELL_HD void operator()(int64_t at) const {
    int64_t found = 0;
    faces.for_each(at, [&](uint32_t) { ++found; });
    count[at] = found;
  }
};
struct ListNewFaces {
  NewFaces faces;
  View<const int64_t> first;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t at) const {
    int64_t to = first[at];
    faces.for_each(at, [&](uint32_t triangle) { out[to++] = triangle; });
  }
};
/// Appends what the splits of `cell` into themselves and `new_id` made to faces.
template <class Exec>
void add_new_faces(Exec& exec, NewFaces faces, View<const uint32_t> new_id, View<const uint32_t> cell, int64_t cells,
                   Buffer<uint32_t>& face_triangle) {
  Buffer<uint32_t> origin = exec.template make<uint32_t>(cells);
  exec.for_each("start origins", cells, StartAlone{origin.view()});
  exec.for_each("set origins", cell.size, SetOrigin{new_id, cell, origin.view()});
  faces.origin = origin.view();
  Buffer<int64_t> first = exec.template make<int64_t>(faces.member.size);
  exec.for_each("count new faces", first.size(), CountNewFaces{faces, first.view()});
  const int64_t before = face_triangle.size(), more = exec.exclusive_scan(first.view());
  Buffer<uint32_t> all = exec.template make<uint32_t>(before + more);
  exec.copy(View<const uint32_t>(face_triangle.view()), all.view().part(0, before));
  exec.for_each("list new faces", first.size(), ListNewFaces{faces, first.view(), all.view().part(before, more)});
  face_triangle = std::move(all);
}

/// Splits cells in two, a thread a cell.
struct PlainSplitCells {
  template <class Exec>
  static void run(Exec& exec, int64_t count, const SplitCell& split, const ApplySplit& apply) {
    exec.for_each("split cells", count, split);
    exec.for_each("apply splits", count, apply);
  }
};

}  // namespace isoshell::dual
