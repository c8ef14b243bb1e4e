// Disconnected pieces of cells: large ones become cells of their own, small ones join a neighbour (paper section 3.4);
// those of fixed seeds join a copy of these that is beside them, however large they are.
//
// Main pieces never change here, and in every round all disconnected pieces that touch a main piece are resolved; where
// disconnected pieces touch none, the largest of the neighbourhood becomes a cell. So the rounds end, with every cell
// in one piece.
#pragma once

#include "stages/dual/dual_cells_body.h"

namespace isoshell::dual {

constexpr uint32_t kNewCell = kNone - 1;       ///< becomes a cell of its own
constexpr uint32_t kLocalLargest = kNone - 2;  ///< touches no main piece and no larger disconnected piece
constexpr uint32_t kWait = kNone;

struct IsDisconnectedRoot {
  View<const uint32_t> piece, label, main_root;
  ISOSHELL_HD bool operator()(int64_t v) const { return piece[v] == v && main_root[label[v]] != v; }
};
struct IsDisconnectedVertex {
  View<const uint32_t> piece, label, main_root;
  ISOSHELL_HD bool operator()(int64_t v) const { return main_root[label[v]] != piece[v]; }
};

/// The disconnected pieces in ascending order of their roots, and their vertices, ascending within each.
struct DisconnectedPiecesView {
  View<const uint32_t> root;
  View<const int64_t> first;    ///< count + 1 offsets into member
  View<const uint64_t> member;  ///< root << 32 | vertex
  ISOSHELL_HD uint32_t vertex(int64_t m) const { return uint32_t(member[m]); }
};
struct DisconnectedPieces {
  Buffer<uint32_t> root;
  Buffer<int64_t> first;
  Buffer<uint64_t> member;
  int64_t count() const { return root.size(); }
  DisconnectedPiecesView view() const { return {root.view(), first.view(), member.view()}; }
};

struct KeyOfDisconnectedVertex {
  View<const uint32_t> piece, vertex;
  View<uint64_t> key;
  ISOSHELL_HD void operator()(int64_t i) const { key[i] = uint64_t(piece[vertex[i]]) << 32 | vertex[i]; }
};
struct SizeOfDisconnectedPiece {
  View<const uint32_t> root, size;
  ISOSHELL_HD int64_t operator()(int64_t i) const { return size[root[i]]; }
};

template <class Exec>
DisconnectedPieces list_disconnected_pieces(Exec& exec, const Pieces& pieces, View<const uint32_t> label,
                                            Cells& cells) {
  DisconnectedPieces disconnected_pieces;
  const int64_t n = label.size;
  disconnected_pieces.root = exec.select(n, IsDisconnectedRoot{pieces.piece.view(), label, cells.root.view()});
  if (disconnected_pieces.count() == 0) return disconnected_pieces;
  const Buffer<uint32_t> vertex = exec.select(n, IsDisconnectedVertex{pieces.piece.view(), label, cells.root.view()});
  disconnected_pieces.member = exec.template make<uint64_t>(vertex.size());
  exec.for_each("key stray vertices", vertex.size(),
                KeyOfDisconnectedVertex{pieces.piece.view(), vertex.view(), disconnected_pieces.member.view()});
  exec.sort(disconnected_pieces.member.view());
  disconnected_pieces.first = exec.template make<int64_t>(disconnected_pieces.count() + 1);
  exec.exclusive_scan_of(disconnected_pieces.count(),
                         SizeOfDisconnectedPiece{disconnected_pieces.root.view(), pieces.size.view()},
                         disconnected_pieces.first.view());
  return disconnected_pieces;
}

/// Where a disconnected piece's vertices lie on average.
ISOSHELL_HD inline PointQ8 middle_of_disconnected_piece(const DisconnectedPiecesView& disconnected_pieces, int64_t i,
                                                        View<const PointQ8> position) {
  Vec64 sum = {0, 0, 0};
  for (int64_t m = disconnected_pieces.first[i]; m < disconnected_pieces.first[i + 1]; ++m) {
    const PointQ8 p = position[disconnected_pieces.vertex(m)];
    sum = sum + Vec64{p.x, p.y, p.z};
  }
  const int64_t count = disconnected_pieces.first[i + 1] - disconnected_pieces.first[i];
  return {int32_t(round_div(sum.x, count)), int32_t(round_div(sum.y, count)), int32_t(round_div(sum.z, count))};
}

/// Decides for disconnected piece waiting[i]: a label to join, kNewCell, kLocalLargest or kWait. Reads the state before
/// the round. What lies across a curve whose both sides are in one patch is as near to a fixed seed there as to its
/// copy on its own side, which it joins.
struct DecideDisconnectedPiece {
  DisconnectedPiecesView disconnected_pieces;
  View<const uint32_t> waiting;
  SheetGraph graph;
  View<const uint32_t> piece, piece_size, label, main_root;
  View<const PointQ8> vertex_position, seed_position;
  View<const uint32_t> joined;        ///< of fixed seeds
  int64_t mean_vertices, mean_cells;  ///< mean cell = mean_vertices / mean_cells
  View<uint32_t> decision;

  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[i];
    const int64_t size = disconnected_pieces.first[s + 1] - disconnected_pieces.first[s];
    const uint32_t copy = copy_beside(s);
    decision[i] = copy != kNone ? copy : 4 * size * mean_cells > mean_vertices ? kNewCell : neighbour(s);
  }

  /// The label of vertex w, where that is in a main piece of a copy of the seed `own`; kNone elsewhere.
  ISOSHELL_HD uint32_t copy_at(uint32_t w, uint32_t own) const {
    const uint32_t owner = label[w];
    const bool is_copy = owner < joined.size && owner != own && joined[owner] == joined[own];
    return is_copy && main_root[owner] == piece[w] ? owner : kNone;
  }

 private:
  /// The first copy of the disconnected piece's seed of which an adjacent main piece is; kNone where there is none.
  ISOSHELL_HD uint32_t copy_beside(int64_t s) const {
    const uint32_t own = label[disconnected_pieces.root[s]];
    uint32_t found = kNone;
    if (own >= joined.size) return found;
    for (int64_t m = disconnected_pieces.first[s]; m < disconnected_pieces.first[s + 1]; ++m)
      graph.for_each_neighbour(disconnected_pieces.vertex(m), [&](uint32_t w) {
        const uint32_t copy = copy_at(w, own);
        if (copy < found) found = copy;
      });
    return found;
  }

  /// The label of the adjacent main piece whose seed is nearest to the disconnected piece's middle.
  ISOSHELL_HD uint32_t neighbour(int64_t s) const {
    const uint32_t root = disconnected_pieces.root[s];
    const uint64_t rank = piece_rank(piece_size[root], root);
    const PointQ8 middle = middle_of_disconnected_piece(disconnected_pieces, s, vertex_position);
    int64_t nearest = INT64_MAX;
    uint32_t best = kNone;
    bool largest = true;
    for (int64_t m = disconnected_pieces.first[s]; m < disconnected_pieces.first[s + 1]; ++m)
      graph.for_each_neighbour(disconnected_pieces.vertex(m), [&](uint32_t w) {
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
  DisconnectedPiecesView disconnected_pieces;
  View<const uint32_t> waiting, index;
  ISOSHELL_HD int64_t operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    return disconnected_pieces.first[s + 1] - disconnected_pieces.first[s];
  }
};
struct GatherWaiting {
  View<const uint32_t> waiting, index;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t i) const { out[i] = waiting[index[i]]; }
};

/// Gives joining disconnected piece index[i] to the cell that was decided.
struct JoinDisconnectedPiece {
  DisconnectedPiecesView disconnected_pieces;
  View<const uint32_t> waiting, index, decision;
  View<uint32_t> piece, label;
  CellsView cells;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    const uint32_t owner = decision[index[i]];
    for (int64_t m = disconnected_pieces.first[s]; m < disconnected_pieces.first[s + 1]; ++m) {
      label[disconnected_pieces.vertex(m)] = owner;
      piece[disconnected_pieces.vertex(m)] = cells.root[owner];
    }
    atomic_add(cells.size[owner], uint32_t(disconnected_pieces.first[s + 1] - disconnected_pieces.first[s]));
  }
};

/// Makes disconnected piece index[i] the cell new_id[i], with its seed at the vertex nearest to its middle.
struct FoundCell {
  DisconnectedPiecesView disconnected_pieces;
  View<const uint32_t> waiting, index, new_id;
  View<uint32_t> label;
  CellsView cells;
  SeedWriter seeds;
  ISOSHELL_HD void operator()(int64_t i) const {
    const int64_t s = waiting[index[i]];
    const PointQ8 middle = middle_of_disconnected_piece(disconnected_pieces, s, seeds.vertex_position);
    const uint32_t id = new_id[i];
    int64_t nearest = INT64_MAX;
    uint32_t at = kNone;
    for (int64_t m = disconnected_pieces.first[s]; m < disconnected_pieces.first[s + 1]; ++m) {
      const uint32_t v = disconnected_pieces.vertex(m);
      const int64_t d = distance_sq_q16(middle, seeds.vertex_position[v]);
      if (d < nearest) nearest = d, at = v;
      label[v] = id;
    }
    cells.root[id] = disconnected_pieces.root[s];
    cells.size[id] = uint32_t(disconnected_pieces.first[s + 1] - disconnected_pieces.first[s]);
    seeds.put(id, at);
  }
};

}  // namespace isoshell::dual
