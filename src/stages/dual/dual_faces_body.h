// Output faces of the dual, the pairs of cells they join, and what is wrong with them: pairs that meet twice and
// components of too few cells. Paper section 3.4.
#pragma once

#include "stages/dual/dual_cells_body.h"
#include "stages/halfedge/labelled_triangles.h"

namespace isoshell::dual {

/// The labels of sheet triangle selected[i], smallest first.
struct MakeFace {
  View<const TriangleIndices> triangles;
  View<const uint32_t> label, selected;
  View<TriangleIndices> face;
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices t = triangles[selected[i]];
    face[i] = smallest_first({label[t.a], label[t.b], label[t.c]});
  }
};
template <class Exec>
Buffer<uint32_t> select_face_triangles(Exec& exec, const SurfaceMesh& surface, View<const uint32_t> label) {
  return exec.select(surface.triangles.size(), HasThreeLabels{surface.triangles.view(), label});
}
template <class Exec>
Buffer<TriangleIndices> make_faces(Exec& exec, const SurfaceMesh& surface, View<const uint32_t> label,
                                   View<const uint32_t> selected) {
  Buffer<TriangleIndices> faces = exec.template make<TriangleIndices>(selected.size);
  exec.for_each("make faces", selected.size, MakeFace{surface.triangles.view(), label, selected, faces.view()});
  return faces;
}

/// Both ends of the three edges of face i: smaller id << 32 | larger id.
struct MakePairs {
  View<const TriangleIndices> face;
  View<uint64_t> pair;
  ISOSHELL_HD static uint64_t key(uint32_t a, uint32_t b) {
    return a < b ? uint64_t(a) << 32 | b : uint64_t(b) << 32 | a;
  }
  ISOSHELL_HD void operator()(int64_t i) const {
    const TriangleIndices f = face[i];
    pair[3 * i] = key(f.a, f.b);
    pair[3 * i + 1] = key(f.b, f.c);
    pair[3 * i + 2] = key(f.c, f.a);
  }
};
/// Fixed seed s and the next one along its border.
struct MakeBorderPairs {
  View<const uint32_t> next;
  View<uint64_t> pair;
  ISOSHELL_HD void operator()(int64_t s) const { pair[s] = MakePairs::key(uint32_t(s), next[s]); }
};
/// Every pair of cells, sorted, as often as arcs between the two end: in a face each, or at the border.
template <class Exec>
Buffer<uint64_t> face_pairs(Exec& exec, View<const TriangleIndices> faces, View<const uint32_t> next_fixed) {
  Buffer<uint64_t> pairs = exec.template make<uint64_t>(3 * faces.size + next_fixed.size);
  exec.for_each("make pairs", faces.size, MakePairs{faces, pairs.view()});
  exec.for_each("make border pairs", next_fixed.size,
                MakeBorderPairs{next_fixed, pairs.view().part(3 * faces.size, next_fixed.size)});
  exec.sort(pairs.view());
  return pairs;
}

/// A request to split a cell: kNoSplit, kSplitAnywhere, or the cell that the new seed must touch.
constexpr uint32_t kNoSplit = kNone;
constexpr uint32_t kSplitAnywhere = kNone - 1;

/// A cell that is not a disk is split anywhere.
struct RequestNonDisks {
  CellsView cells;
  View<uint32_t> request;
  View<uint32_t> stuck;  ///< counts what no split can repair: cells that have only border vertices
  ISOSHELL_HD void operator()(int64_t s) const {
    const bool fails = cells.size[s] > 1 && cells.euler[s] != 1, can = cells.loose(s) > 0;
    request[s] = fails && can ? kSplitAnywhere : kNoSplit;
    if (fails && !can) atomic_add(stuck[0], 1u);
  }
};

/// Of two cells that meet where they should not, the one that has more to give is split where it touches the other,
/// ties by the smaller id; of several requests to one cell the smallest wins.
struct RequestParting {
  CellsView cells;
  View<uint32_t> request, stuck;
  ISOSHELL_HD void operator()(uint64_t pair) const {
    const uint32_t a = uint32_t(pair >> 32), b = uint32_t(pair);
    const uint32_t larger = cells.loose(b) > cells.loose(a) ? b : a;
    if (cells.loose(larger) > 0)
      atomic_min(request[larger], larger == a ? b : a);
    else
      atomic_add(stuck[0], 1u);
  }
};
/// A pair of more than one arc.
struct RequestDoublePairs {
  View<const uint64_t> pair;  ///< sorted
  RequestParting part;
  ISOSHELL_HD void operator()(int64_t i) const {
    const bool first = i == 0 || pair[i - 1] != pair[i];
    if (first && i + 2 < pair.size && pair[i + 2] == pair[i]) part(pair[i]);
  }
};

/// On the graph of the cells: components as sets, their number of cells and their largest cell.
struct HookPairs {
  View<const uint64_t> pair;
  View<uint32_t> parent;
  ISOSHELL_HD void operator()(int64_t i) const {
    if (i == 0 || pair[i - 1] != pair[i]) join(parent, uint32_t(pair[i] >> 32), uint32_t(pair[i]));
  }
};
/// A run of cells of one component is added at once. Three fixed cells are enough for a component: each counts as many
/// as are asked for.
struct CountCellsOfComponent {
  static constexpr int64_t kRun = 64;
  View<const uint32_t> component;
  CellsView cells;
  View<uint32_t> count;
  View<uint64_t> largest;
  ISOSHELL_HD void operator()(int64_t run) const {
    const int64_t begin = run * kRun, end = begin + kRun < component.size ? begin + kRun : component.size;
    uint32_t current = component[begin], found = 0;
    uint64_t best = 0;
    for (int64_t s = begin; s < end; ++s) {
      if (component[s] != current) {
        add(current, found, best);
        current = component[s];
        found = 0;
        best = 0;
      }
      if (cells.size[s] == 0) continue;
      const uint64_t rank = piece_rank(cells.size[s], uint32_t(s));
      best = rank > best ? rank : best;
      found += cells.is_fixed(s) ? 4 : 1;
    }
    add(current, found, best);
  }

 private:
  ISOSHELL_HD void add(uint32_t of, uint32_t found, uint64_t best) const {
    if (found == 0) return;
    atomic_add(count[of], found);
    atomic_max(largest[of], best);
  }
};
struct RequestSmallComponents {
  View<const uint32_t> count;
  View<const uint64_t> largest;
  View<uint32_t> request;
  ISOSHELL_HD void operator()(int64_t s) const {
    if (count[s] == 0 || count[s] >= 4 || largest[s] >> 32 < 2) return;
    const uint32_t cell = ~uint32_t(largest[s]);
    if (request[cell] == kNoSplit) request[cell] = kSplitAnywhere;
  }
};
template <class Exec>
void request_small_components(Exec& exec, View<const uint64_t> pairs, Cells& cells, View<uint32_t> request) {
  const int64_t k = cells.count();
  Buffer<uint32_t> component = exec.template make<uint32_t>(k), count = exec.template make<uint32_t>(k);
  Buffer<uint64_t> largest = exec.template make<uint64_t>(k);
  exec.for_each("start components", k, StartAlone{component.view()});
  exec.for_each("hook components", pairs.size, HookPairs{pairs, component.view()});
  exec.for_each("root components", k, PointAtRoot{component.view()});
  exec.fill(count.view(), uint32_t(0));
  exec.fill(largest.view(), uint64_t(0));
  constexpr int64_t kRun = CountCellsOfComponent::kRun;
  exec.for_each("count cells of components", (k + kRun - 1) / kRun,
                CountCellsOfComponent{component.view(), cells.view(), count.view(), largest.view()});
  exec.for_each("split small components", k, RequestSmallComponents{count.view(), largest.view(), request});
}

/// Seeds that own nothing take half of the largest cells.
struct RankCell {
  CellsView cells;
  View<uint64_t> rank;
  ISOSHELL_HD void operator()(int64_t s) const { rank[s] = ~piece_rank(cells.loose(s), uint32_t(s)); }
};
struct RequestRanked {
  View<const uint64_t> rank;  ///< ascending, so larger cells first
  CellsView cells;
  View<uint32_t> request;
  ISOSHELL_HD void operator()(int64_t i) const {
    const uint32_t cell = uint32_t(rank[i]);
    if (cells.loose(cell) > 0) request[cell] = kSplitAnywhere;
  }
};
template <class Exec>
void request_largest(Exec& exec, Cells& cells, int64_t count, View<uint32_t> request) {
  Buffer<uint64_t> rank = exec.template make<uint64_t>(cells.count());
  exec.for_each("rank cells", cells.count(), RankCell{cells.view(), rank.view()});
  exec.sort(rank.view());
  exec.for_each("split largest cells", count, RequestRanked{rank.view(), cells.view(), request});
}

struct IsRequested {
  View<const uint32_t> request;
  ISOSHELL_HD bool operator()(int64_t s) const { return request[s] != kNoSplit; }
};

}  // namespace isoshell::dual
