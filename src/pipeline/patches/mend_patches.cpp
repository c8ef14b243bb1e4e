// See mend_patches.h.
#include "pipeline/patches/mend_patches.h"

#include <algorithm>
#include <utility>

#include "core/watched.h"
#include "features/walls/coarsen_walls.h"
#include "features/walls/fine_cells.h"
#include "features/walls/mesh_faults.h"
#include "isoshell/readable.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/grid/attempt.h"
#include "pipeline/grid/memory_estimate.h"
#include "pipeline/patches/simplify_patches.h"

namespace isoshell {
namespace {

bool memory_allows(const CutSurface& cut, const Context& context) {
  const double bytes = kBytesPerFinePoint * double(cut.fine->position.size());
  return context.memory_limit_bytes <= 0 || bytes <= double(context.memory_limit_bytes);
}

std::string words_of_coarse(int64_t cells, int64_t all, const std::string& why) {
  return "around " + std::to_string(cells) + " of " + counted(all, "vertex", "vertices") +
         " edges were collapsed, as relaxed cells make no mesh there, and triangles are less even" +
         (why.empty() ? "" : ": " + why);
}

/// Finds what keeps a mesh from being valid.
class FaultFinder {
 public:
  FaultFinder(const CutSurface& cut, NewCrossings& crossings) : cut_(cut), crossings_(crossings) {}

  /// The seeds of vertices at which a mesh with fine cells has faults; ascending.
  std::vector<uint32_t> seeds_of(const FineCells::Mesh& made) {
    const DualMesh mesh = dual_of(made.mesh);
    std::vector<uint32_t> vertices = find_mesh_faults(made.mesh);
    for (const auto& pair : crossings_.wrong_of(mesh, pairs_with_seeds(made)))
      for (const uint32_t t : pair) {
        const TriangleIndices& i = mesh.triangles[t];
        vertices.insert(vertices.end(), {i.a, i.b, i.c});
      }
    if (cut_.regions) {
      std::vector<uint32_t> patch;
      for (const RegionTriangle& t : made.mesh.triangles()) patch.push_back(t.patch);
      const std::vector<uint32_t> inverted = find_inverted_regions(cut_, mesh, patch);
      vertices.insert(vertices.end(), inverted.begin(), inverted.end());
    }
    std::vector<uint32_t> seeds;
    for (const uint32_t v : vertices)
      if (made.seed[v] != kNone) seeds.push_back(made.seed[v]);
    std::sort(seeds.begin(), seeds.end());
    seeds.erase(std::unique(seeds.begin(), seeds.end()), seeds.end());
    return seeds;
  }

 private:
  /// The pairs of triangles that meet, one of which has a seed at a corner; ascending.
  static TrianglePairs pairs_with_seeds(const FineCells::Mesh& made) {
    const std::vector<RegionTriangle>& triangles = made.mesh.triangles();
    const auto is_fine = [&](const RegionTriangle& t) {
      return std::all_of(t.corner.begin(), t.corner.end(), [&](uint32_t v) { return made.seed[v] == kNone; });
    };
    TrianglePairs pairs;
    for (uint32_t t = 0; t < triangles.size(); ++t)
      if (!is_fine(triangles[t]))
        made.mesh.for_each_met(t, [&](uint32_t other) { pairs.push_back({std::min(t, other), std::max(t, other)}); });
    std::sort(pairs.begin(), pairs.end());
    pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
    return pairs;
  }

  static DualMesh dual_of(const WallMesh& mesh) {
    DualMesh out;
    out.position = Buffer<PointQ8>(int64_t(mesh.vertices().size()));
    for (uint32_t v = 0; v < mesh.vertices().size(); ++v) out.position[v] = rounded_down(mesh.at(v));
    out.triangles = Buffer<TriangleIndices>(int64_t(mesh.triangles().size()));
    for (size_t t = 0; t < mesh.triangles().size(); ++t) {
      const auto& [a, b, c] = mesh.triangles()[t].corner;
      out.triangles[int64_t(t)] = {a, b, c};
    }
    return out;
  }

  const CutSurface& cut_;
  NewCrossings& crossings_;
};

/// The mesh in which as many cells are fine as it takes.
WallMesh with_fine_cells(FineCells& cells, FaultFinder& faults, Context& context) {
  for (;;) {
    check_cancel(context, "features");
    FineCells::Mesh made = run_with_threads(context, [&] { return cells.mesh(); });
    const std::vector<uint32_t> seeds = faults.seeds_of(made);
    if (seeds.empty()) return std::move(made.mesh);
    cells.add(seeds);
  }
}

}  // namespace

std::optional<MendedPatches> mend_patches(const PreparedSurface& p, const CutSurface& cut, const PatchFaults& found,
                                          const PatchOptions& in_patches, Run& run) {
  Context& context = run.context;
  if (!memory_allows(cut, context)) return {};
  MendedPatches out;
  out.optimize = found.optimize;  // the first time; patches that are optimised again are added
  const MeshWithCells with_cells = mesh_with_cells(p, cut, found.optimized, in_patches, out.optimize, run);
  const SeededMesh& made = with_cells.made;
  const PatchMesh relaxed = run_with_threads(context, [&] { return PatchMesh(cut, made, join_options(in_patches)); });
  FineCells cells(cut, made, relaxed, with_cells.dual, with_cells.cell, with_cells.is_optimized);
  std::vector<uint32_t> seeds;
  for (const uint32_t v : with_cells.faults.vertices) seeds.push_back(cells.seed_of(v));
  cells.add(seeds);
  JoinedCheck check(p, cut, context);
  FaultFinder faults(cut, check.crossings());
  WallMesh mesh = run.timed("coarsen", [&] { return with_fine_cells(cells, faults, context); });
  auto joined = simplify_patches(std::move(mesh), in_patches, check, out.optimize, run);
  if (!joined) return {};
  out.joined = std::move(*joined);
  if (cells.count() > 0)
    run.warn(words_of_coarse(cells.count(), int64_t(relaxed.vertices().size()), with_cells.faults.what));
  return out;
}

MeshedPatches join_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made,
                           const PatchOptions& options, Run& run) {
  MeshedPatches out;
  out.why_not = failure_reason([&]() -> std::string {
    const PatchFaults faults = mesh_patches(p, cut, made, options, run);
    out.dual = faults.dual;
    out.optimize = faults.optimize;
    if (faults.what.empty()) {
      out.joined = run.timed("angles", [&] { return widened_to_count(cut, made, join_options(options), run.context); });
      return "";
    }
    std::optional<MendedPatches> mended;
    if (!options.previous) mended = mend_patches(p, cut, faults, options, run);
    if (!mended) return faults.what;
    out.joined = std::move(mended->joined);
    out.optimize = mended->optimize;
    return "";
  });
  return out;
}

}  // namespace isoshell
