// See mesh_patches.h.
#include "pipeline/patches/mesh_patches.h"

#include <algorithm>
#include <utility>

#include "core/buckets.h"
#include "core/copy_product.h"
#include "features/cutting/cut_piece.h"
#include "pipeline/defects/flat_patches.h"
#include "pipeline/defects/inverted_regions.h"
#include "pipeline/defects/patch_defects.h"
#include "pipeline/patches/new_crossings.h"
#include "pipeline/sheet/dual_of_seeds.h"
#include "pipeline/sheet/warm_start.h"

namespace isoshell {
namespace {

using PerPatch = std::vector<char>;

PerPatch inverse(const PerPatch& flags) {
  PerPatch out(flags.size());
  std::transform(flags.begin(), flags.end(), out.begin(), [](char flag) { return !flag; });
  return out;
}
bool any(const PerPatch& flags) {
  return std::any_of(flags.begin(), flags.end(), [](char flag) { return flag; });
}

uint32_t patch_of(const CutSurface& cut, const SeededMesh& made, uint32_t vertex) {
  return cut.surface.patch[made.seeds.home[vertex]];
}

/// Runs work on the mesh of some patches alone; the mesh of the others stays.
template <class Work>
void on_patches(const CutSurface& cut, const PerPatch& chosen, SeededMesh& made, Context& context, Work work) {
  if (!any(inverse(chosen))) return work(cut, made);
  if (!any(chosen)) return;
  const SeededMesh whole = std::move(made);
  const CutPiece piece = piece_of(cut, chosen, context);
  SeededMesh part = gather_patches(piece.cut, {{whole, in_piece(piece, cut)}});
  work(piece.cut, part);
  bring_to_host(part);
  made = gather_patches(cut, {{whole, vertices_in(cut, inverse(chosen))}, {part, piece.in_whole}});
}

/// Books no time where there is no room for it.
DualReport make_dual(const CutSurface& cut, SeededMesh& made, Run& run) {
  Run here{run.context};
  const DualReport dual = make_dual_of_seeds(cut.surface, {made.seeds.size()}, made, here);
  for (const StageTime& t : here.times) run.book_time(t.stage, t.ms);
  return dual;
}

void optimize(const CutSurface& cut, SeededMesh& made, const PatchOptions& options, OptimizeReport& sum, Run& run) {
  OptimizedMesh optimized = run.timed("post", [&] {
    return optimize_mesh(cut.surface, std::move(made),
                         options.previous ? for_warm_frame(options.optimize) : options.optimize, run.context);
  });
  sum.flips += optimized.report.flips;
  sum.undone_vertices += optimized.report.undone_vertices;
  made = std::move(optimized);
}

/// Patches in which the dual is a mesh.
PerPatch patches_to_optimize(const CutSurface& cut, SeededMesh& made, bool are_disks) {
  PerPatch chosen(patch_count(cut), 1);
  if (are_disks && !cut.regions) return chosen;
  bring_to_host(made);
  for (const uint32_t v : find_patch_defects(made)) chosen[patch_of(cut, made, v)] = 0;
  return chosen;
}

void add_corners(const DualMesh& mesh, const TrianglePairs& pairs, std::vector<uint32_t>& vertices) {
  for (const auto& pair : pairs)
    for (const uint32_t t : pair) {
      const TriangleIndices& i = mesh.triangles[t];
      vertices.insert(vertices.end(), {i.a, i.b, i.c});
    }
}

Buckets<uint32_t> vertices_by_patch(const CutSurface& cut, View<const uint32_t> home) {
  return sort_into_buckets<uint32_t>(int64_t(patch_count(cut)), home.size,
                                     [&](int64_t v, auto put) { put(cut.surface.patch[home[v]], uint32_t(v)); });
}

/// Replaces patches by those of another mesh. `number`: per vertex of that its own in `made`; kNone: it is in none of
/// them.
void replace_patches(const CutSurface& cut, const PerPatch& replaced, const SeededMesh& from,
                     const std::vector<uint32_t>& number, SeededMesh& made) {
  std::vector<TriangleIndices> triangles;
  for (const TriangleIndices& t : made.mesh.triangles)
    if (!replaced[patch_of(cut, made, t.a)]) triangles.push_back(t);
  for (uint32_t v = 0; v < number.size(); ++v) {
    if (number[v] == kNone) continue;
    made.mesh.position[number[v]] = from.mesh.position[v];
    made.seeds.position[number[v]] = from.seeds.position[v];
    made.seeds.normal[number[v]] = from.seeds.normal[v];
    made.seeds.home[number[v]] = from.seeds.home[v];
  }
  for (const TriangleIndices& t : from.mesh.triangles)
    if (number[t.a] != kNone) triangles.push_back({number[t.a], number[t.b], number[t.c]});
  made.mesh.triangles = Buffer<TriangleIndices>(int64_t(triangles.size()));
  std::copy(triangles.begin(), triangles.end(), made.mesh.triangles.begin());
}

/// Takes those of the chosen patches that have the same vertices as they were optimised. Result: the others of them.
PerPatch take_optimized(const CutSurface& cut, const OptimizedPatches& from, const PerPatch& chosen, SeededMesh& made) {
  const Buckets<uint32_t> here = vertices_by_patch(cut, made.seeds.home.view()),
                          there = vertices_by_patch(cut, from.made.seeds.home.view()),
                          before = vertices_by_patch(cut, from.seeds.home.view());
  PerPatch is_taken(chosen.size(), 0), others = chosen;
  std::vector<uint32_t> number(size_t(from.made.seeds.size()), kNone);
  for (size_t patch = 0; patch < chosen.size(); ++patch) {
    const View<const uint32_t> to = here.in(int64_t(patch)), was = before.in(int64_t(patch)),
                               is = there.in(int64_t(patch));
    const auto is_same = [&](uint32_t u, uint32_t v) { return made.seeds.home[u] == from.seeds.home[v]; };
    is_taken[patch] = chosen[patch] && from.is_optimized[patch] && is.size == to.size &&
                      std::equal(to.begin(), to.end(), was.begin(), was.end(), is_same);
    if (!is_taken[patch]) continue;
    others[patch] = 0;
    for (int64_t i = 0; i < to.size; ++i) number[is[i]] = to[i];
  }
  replace_patches(cut, is_taken, from.made, number, made);
  return others;
}

PatchFaults find_faults(const PreparedSurface& p, const CutSurface& cut, const SeededMesh& made, OptimizeReport& report,
                        Context& context) {
  PatchFaults faults{find_patch_defects(made), ""};
  if (!faults.vertices.empty())
    faults.what = std::to_string(faults.vertices.size()) + " cells beside them are no disks";
  NewCrossings crossings(p, cut, context);
  const TrianglePairs all = crossings.all(made.mesh, made.seeds.fixed.joined.view());
  const TrianglePairs wrong = crossings.wrong_of(made.mesh, all);
  report.self_intersections = int64_t(all.size());
  if (!wrong.empty()) faults.what = std::to_string(wrong.size()) + " pairs of triangles would intersect";
  add_corners(made.mesh, wrong, faults.vertices);
  if (cut.regions) {
    std::vector<uint32_t> patch;
    for (const TriangleIndices& t : made.mesh.triangles) patch.push_back(patch_of(cut, made, t.a));
    const std::vector<uint32_t> inverted = find_inverted_regions(cut, made.mesh, patch);
    if (!inverted.empty() && faults.what.empty()) faults.what = "a region would be inside out";
    faults.vertices.insert(faults.vertices.end(), inverted.begin(), inverted.end());
  }
  std::sort(faults.vertices.begin(), faults.vertices.end());
  faults.vertices.erase(std::unique(faults.vertices.begin(), faults.vertices.end()), faults.vertices.end());
  return faults;
}

/// Optimises the chosen patches of a mesh, whose vertices keep their numbers.
void optimize_in_place(const CutSurface& cut, const PerPatch& chosen, SeededMesh& made, const PatchOptions& options,
                       OptimizeReport& sum, Run& run) {
  if (!any(inverse(chosen))) return optimize(cut, made, options, sum, run);
  if (!any(chosen)) return;
  const CutPiece piece = piece_of(cut, chosen, run.context);
  SeededMesh part = gather_patches(piece.cut, {{made, in_piece(piece, cut)}});
  std::vector<uint32_t> number;  // per vertex of the part its own in the whole
  for (int64_t s = 0; s < part.seeds.fixed.count; ++s)
    number.push_back(made.seeds.fixed.of_vertex[piece.in_whole[part.seeds.home[s]]]);
  std::vector<char> is_used(size_t(made.seeds.size()), 0);
  for (const TriangleIndices& t : made.mesh.triangles) is_used[t.a] = is_used[t.b] = is_used[t.c] = 1;
  for (int64_t s = made.seeds.fixed.count; s < made.seeds.size(); ++s)
    if (is_used[size_t(s)] && chosen[patch_of(cut, made, uint32_t(s))]) number.push_back(uint32_t(s));
  optimize(piece.cut, part, options, sum, run);
  bring_to_host(part);
  for (uint32_t& home : part.seeds.home) home = piece.in_whole[home];
  replace_patches(cut, chosen, part, number, made);
}

/// Triangulates patches with faults anew that lie in a plane. Result: these.
PerPatch triangulate_flat_patches(const CutSurface& cut, const PatchFaults& faults, SeededMesh& made) {
  PerPatch has_faults(patch_count(cut), 0);
  for (const uint32_t v : faults.vertices) has_faults[patch_of(cut, made, v)] = 1;
  return triangulate_flat(cut, has_faults, made);
}

/// Takes free vertices out of a list that have no triangles as their patches were triangulated anew.
void forget_unused(const CutSurface& cut, const SeededMesh& made, const PerPatch& is_flat, PatchFaults& faults) {
  std::vector<char> is_used(size_t(made.seeds.size()), 0);
  for (const TriangleIndices& t : made.mesh.triangles) is_used[t.a] = is_used[t.b] = is_used[t.c] = 1;
  std::vector<uint32_t>& v = faults.vertices;
  v.erase(
      std::remove_if(v.begin(), v.end(), [&](uint32_t at) { return !is_used[at] && is_flat[patch_of(cut, made, at)]; }),
      v.end());
  if (v.empty()) faults.what.clear();
}

}  // namespace

PatchFaults mesh_patches(const PreparedSurface& p, const CutSurface& cut, SeededMesh& made, const PatchOptions& options,
                         Run& run) {
  Context& context = run.context;
  OptimizeReport sum;
  DualReport dual = make_dual(cut, made, run);
  const bool are_disks = std::exchange(dual.failed_cells, 0) == 0;  // the others are among the faults
  SeedSet seeds = host_copy(made.seeds);
  PerPatch chosen = patches_to_optimize(cut, made, are_disks);
  on_patches(cut, chosen, made, context,
             [&](const CutSurface& part, SeededMesh& mesh) { optimize(part, mesh, options, sum, run); });
  bring_to_host(made);
  PatchFaults faults = find_faults(p, cut, made, sum, context);
  if (!faults.what.empty()) {
    OptimizedPatches optimized{std::move(seeds), {host_copy(made.mesh), host_copy(made.seeds)}, std::move(chosen)};
    triangulate_flat_patches(cut, faults, made);
    made = gather_patches(cut, {{made, vertices_in(cut, PerPatch(patch_count(cut), 1))}});
    faults = find_faults(p, cut, made, sum, context);
    if (!faults.what.empty()) faults.optimized = std::move(optimized);
  }
  faults.dual = dual;
  faults.optimize = sum;
  return faults;
}

MeshWithCells mesh_with_cells(const PreparedSurface& p, const CutSurface& cut, const OptimizedPatches& optimized,
                              const PatchOptions& options, OptimizeReport& sum, Run& run) {
  Context& context = run.context;
  DualOptions keep_cells;
  keep_cells.keep_cells = true;
  Triangulation dual =
      run.timed("dual", [&] { return triangulate_dual(cut.surface, host_copy(optimized.seeds), keep_cells, context); });
  bring_to_host(dual);
  MeshWithCells out;
  out.dual.assign(dual.mesh.triangles.begin(), dual.mesh.triangles.end());
  const Buffer<uint32_t> cell = dual.cell.to_host();
  out.cell.assign(cell.begin(), cell.end());
  const bool are_disks = dual.report.failed_cells == 0;
  out.made = std::move(dual);
  out.is_optimized = patches_to_optimize(cut, out.made, are_disks);
  bring_to_host(out.made);
  const PerPatch others = take_optimized(cut, optimized, out.is_optimized, out.made);
  // Walls have no tips, which simplified cells would not get vertices for; without it fewer cells of theirs have
  // faults.
  if (!cut.regions) optimize_in_place(cut, others, out.made, options, sum, run);
  bring_to_host(out.made);
  out.faults = find_faults(p, cut, out.made, sum, context);
  const PerPatch is_flat = triangulate_flat_patches(cut, out.faults, out.made);
  if (!any(is_flat)) return out;
  out.faults = find_faults(p, cut, out.made, sum, context);
  forget_unused(cut, out.made, is_flat, out.faults);
  return out;
}

}  // namespace isoshell
