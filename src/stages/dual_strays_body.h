// Stray pieces of cells: large ones become cells of their own, small ones join a neighbour. Paper section 3.4.
//
// Main pieces never change here, and in every round all strays that touch a main piece are resolved; where strays touch
// none, the largest of the neighbourhood becomes a cell. So the rounds end, with every cell in one piece.
#pragma once

#include "stages/dual_cells_body.h"

namespace isoshell::dual {

constexpr uint32_t kNewCell = kNone - 1;       ///< becomes a cell of its own
constexpr uint32_t kLocalLargest = kNone - 2;  ///< touches no main piece and no larger stray
constexpr uint32_t kWait = kNone;

struct IsStrayRoot {
  View<const uint32_t> piece, label, main_root;
  ISOSHELL_HD bool operator()(int64_t v) const { return piece[v] == v && main_root[label[v]] != v; }
};
struct IsStrayVertex {
  View<const uint32_t> piece, label, main_root;
  ISOSHELL_HD bool operator()(int64_t v) const { return main_root[label[v]] != piece[v]; }
};

/// The strays in ascending order of their roots, and their vertices, ascending within each.
struct StraysView {
  View<const uint32_t> root;
  View<const int64_t> first;    ///< count + 1 offsets into member
  View<const uint64_t> member;  ///< root << 32 | vertex
  ISOSHELL_HD uint32_t vertex(int64_t m) const { return uint32_t(member[m]); }
};
struct Strays {
  Buffer<uint32_t> root;
  Buffer<int64_t> first;
  Buffer<uint64_t> member;
  int64_t count() const { return root.size(); }
  StraysView view() const { return {root.view(), first.view(), member.view()}; }
};

struct KeyOfStrayVertex {
  View<const uint32_t> piece, vertex;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const { key[i] = uint64_t(piece[vertex[i]]) << 32 | vertex[i]; }
};
struct SizeOfStray {
  View<const uint32_t> root, size;
  View<int64_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = i < root.size ? size[root[i]] : 0; }
};

template <class Exec>
Strays list_strays(Exec& exec, const Pieces& pieces, View<const uint32_t> label, Cells& cells) {
  Strays strays;
  const int64_t n = label.size;
  strays.root = exec.select(n, IsStrayRoot{pieces.piece.view(), label, cells.root.view()});
  if (strays.count() == 0) return strays;
  const Buffer<uint32_t> vertex = exec.select(n, IsStrayVertex{pieces.piece.view(), label, cells.root.view()});
  strays.member = exec.template make<uint64_t>(vertex.size());
  exec.for_each("key stray vertices", vertex.size(),
                KeyOfStrayVertex{pieces.piece.view(), vertex.view(), strays.member.view()});
  exec.sort(strays.member.view());
  strays.first = exec.template make<int64_t>(strays.count() + 1);
  exec.for_each("size strays", strays.count() + 1,
                SizeOfStray{strays.root.view(), pieces.size.view(), strays.first.view()});
  exec.exclusive_scan(strays.first.view());
  return strays;
}

/// Where a stray's vertices lie on average.
ISOSHELL_HD inline PointQ8 middle_of_stray(const StraysView& strays, int64_t i, View<const PointQ8> position) {
  Vec64 sum = {0, 0, 0};
  for (int64_t m = strays.first[i]; m < strays.first[i + 1]; ++m) {
    const PointQ8 p = position[strays.vertex(m)];
    sum = sum + Vec64{p.x, p.y, p.z};
  }
  const int64_t count = strays.first[i + 1] - strays.first[i];
  return {int32_t(round_div(sum.x, count)), int32_t(round_div(sum.y, count)), int32_t(round_div(sum.z, count))};
}

/// Decides for stray waiting[i]: a label to join, kNewCell, kLocalLargest or kWait. Reads the state before the round.
struct DecideStray {
  StraysView strays;
  View<const uint32_t> waiting;
  SheetGraph graph;
  View<const uint32_t> piece, piece_size, label, main_root;
  View<const PointQ8> vertex_position, seed_position;
  int64_t mean_vertices, mean_cells;  ///< mean cell = mean_vertices / mean_cells
  View<uint32_t> decision;

  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[i];
    const int64_t size = strays.first[s + 1] - strays.first[s];
    decision[i] = 4 * size * mean_cells > mean_vertices ? kNewCell : neighbour(s);
  }

 private:
  /// The label of the adjacent main piece whose seed is nearest to the stray's middle.
  ISOSHELL_HD uint32_t neighbour(int64_t s) const {
    const uint32_t root = strays.root[s];
    const uint64_t rank = piece_rank(piece_size[root], root);
    const PointQ8 middle = middle_of_stray(strays, s, vertex_position);
    int64_t nearest = INT64_MAX;
    uint32_t best = kNone;
    bool largest = true;
    for (int64_t m = strays.first[s]; m < strays.first[s + 1]; ++m)
      graph.for_each_corner(strays.vertex(m), [&](uint32_t w, uint32_t) {
        const uint32_t other = piece[w];
        if (other == root) return;
        const uint32_t owner = label[w];
        if (main_root[owner] != other) {
          largest = largest && piece_rank(piece_size[other], other) < rank;
        } else if (owner != best) {
          const int64_t d = distance_sq_q16(middle, seed_position[owner]);
          if (d < nearest || (d == nearest && owner < best)) nearest = d, best = owner;
        }
      });
    return best != kNone ? best : (largest ? kLocalLargest : kWait);
  }
};

struct DecisionIs {
  View<const uint32_t> decision;
  uint32_t value;
  ISOSHELL_HD bool operator()(int64_t i) const { return decision[i] == value; }
};
struct IsJoining {
  View<const uint32_t> decision;
  ISOSHELL_HD bool operator()(int64_t i) const { return decision[i] < kLocalLargest; }
};
/// Not joining, and not founding in this round.
struct StillWaits {
  View<const uint32_t> decision;
  uint32_t founding;
  ISOSHELL_HD bool operator()(int64_t i) const { return decision[i] >= kLocalLargest && decision[i] != founding; }
};
struct SizeOfJoining {
  StraysView strays;
  View<const uint32_t> waiting, index;
  ISOSHELL_HD int64_t operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    return strays.first[s + 1] - strays.first[s];
  }
};
struct GatherWaiting {
  View<const uint32_t> waiting, index;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = waiting[index[i]]; }
};

/// Gives joining stray index[i] to the cell that was decided.
struct JoinStray {
  StraysView strays;
  View<const uint32_t> waiting, index, decision;
  View<uint32_t> piece, label;
  CellsView cells;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    const uint32_t owner = decision[index[i]];
    for (int64_t m = strays.first[s]; m < strays.first[s + 1]; ++m) {
      label[strays.vertex(m)] = owner;
      piece[strays.vertex(m)] = cells.root[owner];
    }
    atomic_add(cells.size[owner], uint32_t(strays.first[s + 1] - strays.first[s]));
  }
};

/// Makes stray index[i] the cell new_id[i], with its seed at the vertex nearest to its middle.
struct FoundCell {
  StraysView strays;
  View<const uint32_t> waiting, index, new_id;
  View<uint32_t> label;
  CellsView cells;
  SeedWriter seeds;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    const PointQ8 middle = middle_of_stray(strays, s, seeds.vertex_position);
    const uint32_t id = new_id[i];
    int64_t nearest = INT64_MAX;
    uint32_t at = kNone;
    for (int64_t m = strays.first[s]; m < strays.first[s + 1]; ++m) {
      const uint32_t v = strays.vertex(m);
      const int64_t d = distance_sq_q16(middle, seeds.vertex_position[v]);
      if (d < nearest) nearest = d, at = v;
      label[v] = id;
    }
    cells.root[id] = strays.root[s];
    cells.size[id] = uint32_t(strays.first[s + 1] - strays.first[s]);
    seeds.put(id, at);
  }
};

}  // namespace isoshell::dual
