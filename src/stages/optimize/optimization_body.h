// What optimize_mesh does to a mesh, operation by operation, with the scratch that they share. Their order is in
// optimize_body.h.
#pragma once

#include <algorithm>
#include <utility>

#include "isoshell/advanced/stages.h"
#include "stages/halfedge/intersections.h"
#include "stages/labels/label_body.h"
#include "stages/optimize/optimize_chords.h"
#include "stages/optimize/optimize_fit.h"
#include "stages/optimize/optimize_flips.h"
#include "stages/optimize/optimize_guard.h"
#include "stages/optimize/optimize_mesh_passes.h"
#include "stages/optimize/optimize_orientation.h"
#include "stages/optimize/optimize_relocate.h"
#include "stages/optimize/optimize_search.h"
#include "stages/optimize/optimize_smooth.h"
#include "stages/optimize/optimize_steps.h"

namespace isoshell::optimize {

constexpr int kStepsOffSheet = 8;           ///< of smoothing: a step leaves the surface by little, a walk takes long
constexpr double kMostSmoothingMove = 0.2;  ///< edges a step
constexpr double kMostFitMove = 0.1;        ///< edges a step: the samples slide along by a triangle or two
constexpr double kFarSample = 0.1;          ///< edges from the mesh; see PullOptions::far_q8
constexpr int kUndoRounds = 3;              ///< back to the surface
constexpr int kUndoRoundsInAll = 12;        ///< the others back to where vertices began
constexpr int kBlockedFlips = 8;            ///< tries to flip fewer edges before none is flipped
constexpr int kSamplesPerTriangle = 12;     ///< fewer miss tips, more change little
constexpr double kStiffness = 0.5;          ///< less is nearer to the surface, more has better triangles
constexpr double kFitMomentum = 0.7;
constexpr double kGoodQuality = 1;      ///< triangles below it are searched at, and may not get worse in the end
constexpr double kUniformEvenness = 6;  ///< weight of the size to aim at against a triangle's own: shapes want none

/// The mesh and its scratch while it is improved.
template <class Exec>
class Optimization {
  using Kernels = typename Exec::Kernels;

 public:
  Optimization(Exec& exec, const SurfaceMesh& surface, const OptimizeOptions& options, SeedSet& seeds, DualMesh& mesh)
      : exec_(exec),
        surface_(surface),
        evenness_(options.uniform_area ? kUniformEvenness : 0),
        seeds_(seeds),
        mesh_(mesh),
        vertices_(mesh.position.size()),
        half_edges_(3 * mesh.triangles.size()),
        spacing_(seed_spacing(exec, surface, vertices_)),
        walk_(walk_onto(surface)),
        connections_(exec, mesh),
        keep_apart_(options.keep_apart) {
    connections_.require_borders_of(exec, mesh.triangles.view(), seeds.fixed.count, "optimize");
    fixed_valence_ = even_valences(exec, seeds.fixed, view(), mesh.position.view());
    claim_ = exec.template make<uint64_t>(vertices_);
    moved_ = exec.template make<PointQ8>(vertices_);
    previous_ = exec.template make<PointQ8>(vertices_);
    on_sheet_ = exec.template make<PointQ8>(vertices_);
    begin_ = exec.template make<PointQ8>(vertices_);
    exec.copy(View<const PointQ8>(mesh.position.view()), begin_.view());
    moved_home_ = exec.template make<uint32_t>(vertices_);
    harmed_ = exec.template make<uint32_t>(vertices_);
    measure_size();
  }

  /// Flips until none is left or `rounds` are done. Returns how many were made.
  int64_t flip(int rounds, double least_quality) {
    return flip_by([&] { return FlipKey{view(), mesh_.position.view(), least_quality, fixed()}; }, rounds);
  }

  /// Steps along the mesh, the last and every eighth one back onto the sheet: a step leaves it by little. Where eight
  /// did harm, vertices return to where they last were on the sheet.
  void smooth(int steps, double momentum, double hold, double least_quality) {
    SmoothOptions options = smooth_options(kMostSmoothingMove);
    options.momentum = momentum;
    options.hold = hold;
    exec_.copy(View<const PointQ8>(mesh_.position.view()), previous_.view());
    exec_.copy(View<const PointQ8>(mesh_.position.view()), on_sheet_.view());
    work_.begin(exec_, view());
    for (int left = steps - 1; left >= 0; --left) {
      options.onto_sheet = left % kStepsOffSheet == 0;
      if (options.onto_sheet) exec_.copy(View<const uint32_t>(seeds_.home.view()), moved_home_.view());
      const View<uint32_t> home = options.onto_sheet ? moved_home_.view() : seeds_.home.view();
      work_.smooth(exec_, {view(), walk_, options, mesh_.position.view(), previous_.view(), home, moved_.view()});
      if (options.onto_sheet) restore_harmed(least_quality, on_sheet_.view());
      take_positions();
      if (!options.onto_sheet) continue;
      std::swap(seeds_.home, moved_home_);
      exec_.copy(View<const PointQ8>(mesh_.position.view()), on_sheet_.view());
    }
  }

  /// Lloyd relaxation on the mesh; its vertices are on the sheet then.
  void relax_on_mesh(const MeshPassOptions& options) {
    Buffer<CellPart> part = exec_.template make<CellPart>(half_edges_);
    Buffer<double> cotangent = exec_.template make<double>(half_edges_);
    Buffer<Vector> normal = exec_.template make<Vector>(half_edges_ / 3);
    Kernels::MeshPasses::run(exec_, MeshPasses{view(),
                                               walk_,
                                               fixed(),
                                               size_,
                                               options,
                                               {mesh_.position.view(), moved_.view(), previous_.view()},
                                               seeds_.home.view(),
                                               claim_.view(),
                                               part.view(),
                                               cotangent.view(),
                                               normal.view()});
    if (options.passes % 3 == 1) std::swap(mesh_.position, moved_);
    if (options.passes % 3 == 2) std::swap(mesh_.position, previous_);
  }

  /// Attaches samples of the sheet, and what it misses, to the triangles around the vertices that they are nearest to.
  void attach_samples() {
    update_seeds();
    Buffer<uint32_t> label = exec_.template make<uint32_t>(surface_.vertex_count());
    Kernels::LabelSheet::run(exec_, surface_, seeds_, spacing_, label.view());
    const auto smallest = int64_t(smallest_fit_ * double(mesh_.triangles.size()));
    samples_of_sheet_ = std::min(surface_.vertex_count(), kSamplesPerTriangle * smallest);
    const int64_t count = samples_of_sheet_ + surface_.missed.size();
    sample_ = exec_.template make<FitSample>(count);
    exec_.for_each("attach samples", count,
                   AttachSample{view(), mesh_.position.view(), surface_.position.view(), surface_.normal.view(),
                                label.view(), surface_.missed.view(), surface_.missed_vertex.view(), sample_.view()});
  }

  /// Steps towards the samples.
  void fit(int steps, double damping, double least_quality) {
    FitOptions options;
    options.smooth = smooth_options(kMostFitMove);
    options.smooth.momentum = kFitMomentum;
    options.stiffness = kStiffness * double(samples_of_sheet_) / (smallest_fit_ * double(vertices_));
    options.damping = damping;
    exec_.copy(View<const PointQ8>(mesh_.position.view()), previous_.view());
    drop_pulls();
    work_.begin(exec_, view());
    sort_samples();
    for (int s = 0; s < steps; ++s) {
      exec_.fill(triangle_pull_.view(), TrianglePull{});
      exec_.fill(vertex_pull_.view(), VertexPull{});
      work_.pull(exec_, {view(),
                         mesh_.position.view(),
                         {rms_q8_, kFarSample * size_.edge_q8, size_.lengths.vary() ? kSizedTailOfRms : kTailOfRms,
                          size_.lengths.vary()},
                         sample_.view(),
                         triangle_pull_.view(),
                         vertex_pull_.view(),
                         rest_sq_.view()});
      options.rms_q8 = rms_q8_ =
          rounded_sqrt(double(exec_.sum(samples_of_sheet_, RestSq{rest_sq_.view()})) / double(samples_of_sheet_));
      exec_.copy(View<const uint32_t>(seeds_.home.view()), moved_home_.view());
      work_.fit(exec_, {view(), walk_, options, mesh_.position.view(), previous_.view(), triangle_pull_.view(),
                        vertex_pull_.view(), moved_home_.view(), moved_.view()});
      restore_harmed(least_quality, mesh_.position.view());
      take_positions();
      std::swap(seeds_.home, moved_home_);
    }
  }

  /// Flips edges that cross what they should follow, as the samples of the last step of the fit show it.
  int64_t flip_chords() {
    Buffer<uint32_t> far = exec_.template make<uint32_t>(mesh_.triangles.size());
    Buffer<uint32_t> now = exec_.template make<uint32_t>(half_edges_),
                     flipped = exec_.template make<uint32_t>(half_edges_);
    exec_.fill(far.view(), 0u);
    exec_.fill(now.view(), 0u);
    exec_.fill(flipped.view(), 0u);
    const ChordGaps gaps{now.view(), flipped.view()};
    exec_.for_each("mark far triangles", sample_.size(),
                   MarkFarTriangles{sample_.view(), rest_sq_.view(), kFarTriangle * size_.edge_q8, far.view()});
    exec_.for_each("measure samples", sample_.size(),
                   MeasureSamples{view(), mesh_.position.view(), sample_.view(), far.view(), gaps});
    exec_.for_each("measure middles", half_edges_,
                   MeasureMiddles{view(), walk_, mesh_.position.view(), seeds_.home.view(), gaps});
    return flip_by([&] { return ChordKey{view(), mesh_.position.view(), gaps, fixed()}; }, 1);
  }

  /// Takes vertices from flat places to triangles that the samples of the last step of the fit are far from, by edges.
  /// Returns how many.
  int64_t relocate(double least_edges) {
    const int64_t triangles = mesh_.triangles.size();
    Buffer<uint32_t> distance = exec_.template make<uint32_t>(triangles);
    Buffer<uint64_t> offset = exec_.template make<uint64_t>(triangles);
    exec_.fill(distance.view(), 0u);
    exec_.fill(offset.view(), uint64_t(0));
    exec_.fill(claim_.view(), uint64_t(0));
    const FarSamples far_samples{distance.view(), offset.view()};
    exec_.for_each("find distances", sample_.size(), FindDistances{sample_.view(), rest_sq_.view(), far_samples});
    exec_.for_each("find farthest", sample_.size(),
                   FindFarthest{view(), mesh_.position.view(), sample_.view(), rest_sq_.view(),
                                least_edges * size_.edge_q8, far_samples});
    const FarPlace places{view(), mesh_.position.view(), seeds_.home.view(), size_, far_samples, least_edges};
    const Buffer<uint64_t> far = choose_apart(exec_, places, triangles, claim_.view());
    if (far.empty()) return 0;
    const int64_t most = std::min(far.size(), 1 + vertices_ / kVerticesPerMove);
    exec_.fill(claim_.view(), uint64_t(0));
    exec_.for_each("block far places", most, BlockPlaces{places, far.view(), claim_.view()});
    const SpareEdge edges{
        {view(), mesh_.position.view(), seeds_.home.view(), size_.lengths, fixed()}, distance.view(), size_};
    const Buffer<uint64_t> spare = choose_apart(exec_, edges, half_edges_, claim_.view());
    const int64_t moves = std::min(most, spare.size());
    Buffer<uint32_t> heir = exec_.template make<uint32_t>(triangles);
    exec_.fill(heir.view(), kNone);
    exec_.for_each("relocate vertices", moves,
                   RelocateVertex{places, walk_, far.view(), spare.view(), mesh_.position.view(), on_sheet_.view(),
                                  begin_.view(), seeds_.home.view(), heir.view()});
    exec_.for_each("inherit samples", sample_.size(), InheritSamples{heir.view(), sample_.view()});
    return moves;
  }

  /// Most of the memory, which the test for intersections needs.
  void drop_samples() {
    sample_ = {};
    drop_pulls();
  }

  /// Looks for better places for the corners of triangles below kGoodQuality.
  void search(int rounds, double hold, bool onto_sheet) {
    Kernels::SearchPositions::run(exec_, view(), walk_,
                                  {rounds, kGoodQuality, size_, hold, onto_sheet, seeds_.fixed.count},
                                  mesh_.position.view(), seeds_.home.view(), harmed_.view());
  }

  /// Where triangles intersect, takes their corners and the neighbours of these back, until none does or the rounds are
  /// done: first to the sheet, then to where they began. A round that does not help takes more vertices in the next;
  /// when none did in the end, or all that intersect are where they began, the best one counts.
  void undo_intersections(OptimizeReport& report) {
    Buffer<uint32_t> spread = exec_.template make<uint32_t>(vertices_);
    Buffer<PointQ8> best = exec_.template make<PointQ8>(vertices_);
    int64_t fewest = INT64_MAX;
    for (int round = 0;; ++round) {
      report.self_intersections = intersections_at(mesh_.position);
      if (report.self_intersections == 0) return;
      if (report.self_intersections < fewest) {
        fewest = report.self_intersections;
        exec_.copy(View<const PointQ8>(mesh_.position.view()), best.view());
      }
      const IsAway is_away{harmed_.view(), begin_.view(), mesh_.position.view()};
      if (round == kUndoRoundsInAll || (round >= kUndoRounds && exec_.sum(vertices_, is_away) == 0)) break;
      for (int rings = round % kUndoRounds; rings >= 0; --rings) {
        exec_.for_each("spread marks", vertices_, SpreadMarks{view(), harmed_.view(), spread.view()});
        std::swap(harmed_, spread);
      }
      report.undone_vertices += exec_.sum(vertices_, IsMarked{harmed_.view()});
      exec_.for_each(
          "return marked", vertices_,
          ReturnMarked{harmed_.view(), round < kUndoRounds ? on_sheet_.view() : begin_.view(), mesh_.position.view()});
    }
    report.self_intersections = fewest;
    std::swap(mesh_.position, best);
  }

  /// See optimize_orientation.h.
  void turn_inside_out() { turn_small_components(exec_, surface_, seeds_, mesh_); }

  void finish() {
    exec_.for_each("rotate triangles", mesh_.triangles.size(), RotateTriangle{mesh_.triangles.view()});
    exec_.sort(mesh_.triangles.view(), ByIndices{});
    update_seeds();
  }

 private:
  /// Before what the next step finds anew, which is large too.
  void sort_samples() {
    work_.sort(exec_, mesh_.triangles.size(), samples_of_sheet_, sample_);
    rest_sq_ = exec_.template make<int64_t>(sample_.size());
    triangle_pull_ = exec_.template make<TrianglePull>(mesh_.triangles.size());
    vertex_pull_ = exec_.template make<VertexPull>(vertices_);
  }
  void drop_pulls() {
    rest_sq_ = {};
    triangle_pull_ = {};
    vertex_pull_ = {};
  }

  MeshView view() { return connections_.view(mesh_); }
  FixedView fixed() const { return {seeds_.fixed.joined.view(), fixed_valence_.view()}; }

  /// Of flips that would keep vertices from going back to where they began, none is made that is near to one.
  template <class MakeKey>
  int64_t flip_by(MakeKey make_key, int rounds) {
    if (!keep_apart_) return Kernels::FlipEdges::run(exec_, make_key(), claim_.view(), rounds);
    Buffer<TriangleIndices> before = exec_.template make<TriangleIndices>(mesh_.triangles.size());
    exec_.copy(View<const TriangleIndices>(mesh_.triangles.view()), before.view());
    Buffer<uint32_t> blocked = exec_.template make<uint32_t>(vertices_);
    exec_.fill(blocked.view(), 0u);
    const int64_t pairs = intersections_at(begin_);
    for (int tries = kBlockedFlips;; --tries) {
      const int64_t flips =
          Kernels::FlipEdges::run(exec_, UnblockedFlip{make_key(), blocked.view()}, claim_.view(), rounds);
      if (flips == 0 || intersections_at(begin_) <= pairs) return flips;
      exec_.copy(View<const TriangleIndices>(before.view()), mesh_.triangles.view());
      connections_ = Connections(exec_, mesh_);
      if (tries == 0) return 0;
      exec_.for_each("block flips", vertices_, BlockMarked{harmed_.view(), blocked.view()});
    }
  }

  /// Pairs of triangles; their corners are marked as harmed.
  int64_t intersections_at(const Buffer<PointQ8>& position) {
    return find_intersections(exec_, {mesh_.triangles.view(), position.view(), seeds_.fixed.joined.view()},
                              surface_.extent_vox, int64_t(size_.edge_q8) / kOneVoxelQ8 + 1, harmed_.view());
  }

  SmoothOptions smooth_options(double most_edges) const {
    SmoothOptions options;
    options.evenness = evenness_;
    options.size = size_;
    options.most_edges = most_edges;
    options.locked = seeds_.fixed.count;
    return options;
  }

  /// Where lengths vary, edges are those of equilateral triangles around the vertices' cells.
  void measure_size() {
    constexpr double kEdgeSqOfCell = 1.1547005383792515;
    size_.lengths = spacing_.lengths;
    if (spacing_.lengths.vary()) {
      size_.edge_q8 = rounded_sqrt(kEdgeSqOfCell * double(spacing_.h_sq_q16));
      smallest_fit_ = double(spacing_.area2_q16 / 2) / (double(spacing_.h_sq_q16) * double(vertices_));
    } else {
      size_.edge_q8 = double(exec_.sum(half_edges_, EdgeLength{view(), mesh_.position.view()})) / double(half_edges_);
    }
  }

  void update_seeds() {
    Kernels::Walks::for_each(exec_, "update seeds", walk_, seeds_.home.view(),
                             UpdateSeed{walk_, mesh_.position.view(), seeds_.position.view(), seeds_.normal.view(),
                                        seeds_.home.view(), seeds_.fixed.count});
  }

  /// Where what was moved would harm, `before` takes its place.
  void restore_harmed(double least_quality, View<const PointQ8> before) {
    Kernels::UndoHarm::run(
        exec_, mesh_.triangles.view(), least_quality,
        RestoreHarmed{before, seeds_.home.view(), harmed_.view(), moved_.view(), moved_home_.view()});
  }

  void take_positions() {
    std::swap(previous_, mesh_.position);
    std::swap(mesh_.position, moved_);
  }

  Exec& exec_;
  const SurfaceMesh& surface_;
  double evenness_;
  SeedSet& seeds_;
  DualMesh& mesh_;
  int64_t vertices_, half_edges_;
  SeedSpacing spacing_;
  WalkOntoSheet walk_;
  Connections connections_;
  Buffer<uint32_t> fixed_valence_;  ///< see FixedView
  bool keep_apart_;
  typename Kernels::StepWork work_;
  EdgeSize size_;
  double smallest_fit_ = 1;  ///< how many times the mesh's triangles fit onto the sheet when they are all smallest
  double rms_q8_ = 0;        ///< of the samples' residuals, 0 before they were first looked at
  Buffer<uint32_t> moved_home_, harmed_;
  Buffer<uint64_t> claim_;
  Buffer<PointQ8> moved_, previous_, on_sheet_, begin_;
  int64_t samples_of_sheet_ = 0;  ///< off-surface points come after them
  Buffer<FitSample> sample_;
  Buffer<int64_t> rest_sq_;
  Buffer<TrianglePull> triangle_pull_;
  Buffer<VertexPull> vertex_pull_;
};

}  // namespace isoshell::optimize
