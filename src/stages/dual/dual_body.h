// triangulate_dual (see stages.h), written once over an executor. Paper section 3.4.
//
// The labels of the sheet's vertices cut the sheet into cells; a sheet triangle with three labels is a face of the
// dual. When every cell is a disk in one piece, two cells meet in at most one arc, and every component of the sheet has
// four cells or more, the dual is a triangulation of the sheet. DisconnectedPieces are resolved first, then cells that
// are not disks are split, then pairs that meet twice; a split keeps both halves connected, so no disconnected pieces
// come back, and since the finest partition is the sheet itself, the rounds end.
//
// On a border every vertex has the label of its fixed seed, and keeps it: the cells of fixed seeds are one run of
// border vertices each and what is inside of it. The edge between two runs is where the arc between two cells ends. A
// component with a border needs no four cells, since it has three on every border.
#pragma once

#include "isoshell/advanced/stages.h"
#include "stages/dual/dual_border_body.h"
#include "stages/dual/dual_cells_body.h"
#include "stages/dual/dual_faces_body.h"
#include "stages/dual/dual_pieces_body.h"
#include "stages/dual/dual_split_body.h"
#include "stages/labels/label_body.h"

namespace isoshell {
namespace dual {

/// Seeds that own nothing are used up first, in order; then ids are appended.
struct TakeIds {
  View<const uint32_t> unused;
  uint32_t next;
  View<uint32_t> out;
  ISOSHELL_HD void operator()(int64_t i) const {
    out[i] = i < unused.size ? unused[i] : next + uint32_t(i - unused.size);
  }
};

/// The labels of one sheet and their repair.
template <class Exec>
class Partition {
 public:
  Partition(Exec& exec, const SurfaceMesh& surface, SeedSet& seeds, const DualOptions& options, DualReport& report)
      : exec_(exec),
        surface_(surface),
        seeds_(seeds),
        report_(report),
        rounds_left_(options.max_repair_rounds),
        first_count_(seeds.size()),
        spacing_(seed_spacing(exec, surface, seeds.size())),
        label_(exec.template make<uint32_t>(surface.vertex_count())) {
    report_ = {};
    Exec::Kernels::LabelSheet::run(exec_, surface_, seeds_, spacing_, label_.view());
    grow(exec_, cells_, seeds_.size());
    if (seeds_.fixed.count == 0) return;
    border_ = follow_borders(exec_, surface_, seeds_.fixed);
    cells_.held = std::move(border_.held);
  }

  /// Repairs as far as the rounds allow; returns the faces, not sorted.
  Buffer<TriangleIndices> repair() {
    const int64_t disconnected_pieces = resolve_disconnected_pieces();
    measure_euler(exec_, surface_, label_.view(), border_.vertex.view(), cells_);
    Buffer<TriangleIndices> faces;
    for (;;) {
      Buffer<uint32_t> failing = find_failing(faces);
      const Buffer<uint32_t> unused = unused_seeds();
      report_.failed_cells = disconnected_pieces + failing.size() + unused.size() + stuck();
      if (failing.empty() && !unused.empty()) failing = largest_cells(unused.size());
      if (failing.empty() || disconnected_pieces > 0 || !take_round()) break;
      split(failing, unused);
    }
    if (faces.empty()) faces = faces_now();
    return faces;
  }

  View<const uint32_t> label() const { return label_.view(); }
  Buffer<uint32_t> take_labels() && { return std::move(label_); }

 private:
  bool take_round() {
    if (rounds_left_ == 0) return false;
    --rounds_left_;
    ++report_.repair_rounds;
    return true;
  }

  Buffer<uint32_t> unused_seeds() { return exec_.select(cells_.count(), OwnsNothing{cells_.size.view()}); }

  /// Ids for `count` new cells; makes room for them in seeds and cells. `unused`: see unused_seeds().
  Buffer<uint32_t> new_ids(int64_t count, const Buffer<uint32_t>& unused) {
    const int64_t before = seeds_.size();
    Buffer<uint32_t> ids = exec_.template make<uint32_t>(count);
    exec_.for_each("take ids", count, TakeIds{unused.view(), uint32_t(before), ids.view()});
    if (count > unused.size()) {
      grow(exec_, seeds_, before + count - unused.size());
      grow(exec_, cells_, before + count - unused.size());
      report_.inserted_seeds += count - unused.size();
    }
    return ids;
  }

  /// Leaves every cell in one piece. Returns the number of disconnected pieces that are left.
  int64_t resolve_disconnected_pieces() {
    Pieces pieces = find_pieces(exec_, surface_, label_.view(), border_.vertex.view(), cells_);
    const DisconnectedPieces disconnected_pieces = list_disconnected_pieces(exec_, pieces, label_.view(), cells_);
    Buffer<uint32_t> waiting = exec_.template make<uint32_t>(disconnected_pieces.count());
    exec_.for_each("all strays wait", disconnected_pieces.count(), StartAlone{waiting.view()});
    while (!waiting.empty() && take_round())
      waiting = resolve_disconnected_pieces_once(pieces, disconnected_pieces, waiting.view());
    return waiting.size();
  }

  /// One round; returns the disconnected pieces that still wait.
  Buffer<uint32_t> resolve_disconnected_pieces_once(Pieces& pieces, const DisconnectedPieces& disconnected_pieces,
                                                    View<const uint32_t> waiting) {
    Buffer<uint32_t> decision = exec_.template make<uint32_t>(waiting.size);
    exec_.for_each("decide strays", waiting.size,
                   DecideDisconnectedPiece{disconnected_pieces.view(), waiting, graph_of(surface_), pieces.piece.view(),
                                           pieces.size.view(), label_.view(), cells_.root.view(),
                                           surface_.position.view(), seeds_.position.view(), seeds_.fixed.joined.view(),
                                           surface_.vertex_count(), first_count_, decision.view()});
    const Buffer<uint32_t> joining = exec_.select(waiting.size, IsJoining{decision.view()});
    Buffer<uint32_t> founding = exec_.select(waiting.size, DecisionIs{decision.view(), kNewCell});
    uint32_t resolved = kNewCell;
    if (joining.empty() && founding.empty()) {
      founding = exec_.select(waiting.size, DecisionIs{decision.view(), kLocalLargest});
      resolved = kLocalLargest;
    }
    exec_.for_each("join strays", joining.size(),
                   JoinDisconnectedPiece{disconnected_pieces.view(), waiting, joining.view(), decision.view(),
                                         pieces.piece.view(), label_.view(), cells_.view()});
    report_.relabelled_vertices +=
        exec_.sum(joining.size(), SizeOfJoining{disconnected_pieces.view(), waiting, joining.view()});
    const Buffer<uint32_t> ids = founding.empty() ? Buffer<uint32_t>() : new_ids(founding.size(), unused_seeds());
    exec_.for_each("found cells", founding.size(),
                   FoundCell{disconnected_pieces.view(), waiting, founding.view(), ids.view(), label_.view(),
                             cells_.view(), writer_of(surface_, seeds_)});
    const Buffer<uint32_t> rest = exec_.select(waiting.size, StillWaits{decision.view(), resolved});
    Buffer<uint32_t> out = exec_.template make<uint32_t>(rest.size());
    exec_.for_each("gather waiting", rest.size(), GatherWaiting{waiting, rest.view(), out.view()});
    return out;
  }

  /// Cells to split. Faces are made, and pairs looked at, only when all cells are disks.
  Buffer<uint32_t> find_failing(Buffer<TriangleIndices>& faces) {
    request_ = exec_.template make<uint32_t>(cells_.count());
    stuck_ = exec_.template make<uint32_t>(1);
    exec_.fill(stuck_.view(), 0u);
    exec_.for_each("check disks", cells_.count(), RequestNonDisks{cells_.view(), request_.view(), stuck_.view()});
    Buffer<uint32_t> failing = requested();
    faces = {};
    if (!failing.empty()) return failing;
    faces = faces_now();
    const Buffer<uint64_t> pairs = face_pairs(exec_, faces.view(), border_.next.view());
    const RequestParting part{cells_.view(), request_.view(), stuck_.view()};
    exec_.for_each("check pairs", pairs.size(), RequestDoublePairs{pairs.view(), part});
    if (seeds_.fixed.count > 0)
      request_double_positions(exec_, pairs.view(), seeds_.fixed.joined.view(), border_.next.view(), part);
    request_small_components(exec_, pairs.view(), cells_, request_.view());
    return requested();
  }

  /// Splits keep the list of the faces' triangles up to date: the sheet is searched for them only once.
  Buffer<TriangleIndices> faces_now() {
    if (face_triangle_.empty()) face_triangle_ = select_face_triangles(exec_, surface_, label_.view());
    return make_faces(exec_, surface_, label_.view(), face_triangle_.view());
  }

  Buffer<uint32_t> largest_cells(int64_t count) {
    request_largest(exec_, cells_, count, request_.view());
    return requested();
  }
  /// What no split can repair, of the last look.
  int64_t stuck() { return seeds_.fixed.count > 0 ? exec_.value(View<const uint32_t>(stuck_.view()), 0) : 0; }
  Buffer<uint32_t> requested() { return exec_.select(cells_.count(), IsRequested{request_.view()}); }

  void split(const Buffer<uint32_t>& cell, const Buffer<uint32_t>& unused) {
    const int64_t count = cell.size();
    Buffer<int64_t> first = exec_.template make<int64_t>(count + 1);
    Buffer<uint32_t> queue = exec_.template make<uint32_t>(
        exec_.exclusive_scan_of(count, SizeOfRequested{cell.view(), cells_.size.view()}, first.view()));
    Buffer<Half> half = exec_.template make<Half>(count);
    if (mark_.empty()) {
      mark_ = exec_.template make<uint8_t>(surface_.vertex_count());
      exec_.fill(mark_.view(), uint8_t(SplitCell::kClear));
    }
    const Buffer<uint32_t> ids = new_ids(count, unused);
    Exec::Kernels::SplitCells::run(exec_, count,
                                   SplitCell{graph_of(surface_), label_.view(), cell.view(), request_.view(),
                                             first.view(), surface_.position.view(), seeds_.position.view(),
                                             cells_.view(), queue.view(), mark_.view(), half.view()},
                                   ApplySplit{ids.view(), queue.view(), first.view(), half.view(), mark_.view(),
                                              label_.view(), cells_.view(), writer_of(surface_, seeds_)});
    if (!face_triangle_.empty())
      add_new_faces(exec_, {graph_of(surface_), label_.view(), queue.view(), request_.view(), {}}, ids.view(),
                    cell.view(), cells_.count(), face_triangle_);
  }

  Exec& exec_;
  const SurfaceMesh& surface_;
  SeedSet& seeds_;
  DualReport& report_;
  int64_t rounds_left_;
  int64_t first_count_;
  SeedSpacing spacing_;
  Buffer<uint32_t> label_;
  Cells cells_;
  FixedBorder border_;  ///< empty without fixed seeds
  Buffer<uint32_t> request_;
  Buffer<uint32_t> stuck_;  ///< one element
  Buffer<uint8_t> mark_;
  Buffer<uint32_t> face_triangle_;  ///< sheet triangles with three labels, in any order; empty while not known
};

}  // namespace dual

template <class Exec>
Triangulation triangulate_dual_body(Exec& exec, const SurfaceMesh& surface, SeedSet&& seeds,
                                    const DualOptions& options) {
  Triangulation out;
  dual::Partition<Exec> partition(exec, surface, seeds, options, out.report);
  DualMesh& mesh = out.mesh;
  mesh.triangles = partition.repair();
  if (options.keep_cells) out.cell = std::move(partition).take_labels();
  exec.sort(mesh.triangles.view(), ByIndices{});
  dual::grow(exec, mesh.position, seeds.size(), PointQ8{0, 0, 0});
  exec.for_each("place vertices", seeds.size(),
                dual::CopyOrFill<PointQ8>{seeds.position.view(), mesh.position.view(), PointQ8{0, 0, 0}});
  out.seeds = std::move(seeds);
  return out;
}

}  // namespace isoshell
